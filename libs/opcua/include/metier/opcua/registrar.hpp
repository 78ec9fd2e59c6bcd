#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "metier/opcua/answer.hpp"
#include "metier/opcua/discovery.hpp"

namespace metier::opcua {

/// Settings of a Registrar.
struct RegistrarOptions {
    /// Address of the discovery server: "opc.tcp://host:4840".
    std::string discovery_url;
    /// Server to register.
    opcua::ServerRegistration server;
    /// Pause from one success to the next attempt, > 0; well below the time after which the
    /// discovery server forgets a server.
    std::chrono::milliseconds period{30'000};
    /// Pause from a failure to the next attempt, > 0.
    std::chrono::milliseconds pause{5'000};
    /// Longest time that one registration may take.
    std::chrono::milliseconds timeout{2'000};
    /// Longest time that the final removal may take.
    std::chrono::milliseconds farewell{500};
    /// Certificate and trusted discovery servers, as opcua::registerServer(); none: no security.
    std::optional<opcua::Credentials> security{};
};

/// Keeps a server registered at one discovery server, and removes the registration at its end:
///
///     Registrar registrar({.discovery_url = "opc.tcp://lds:4840",
///                          .server = {.application_uri = uri, .discovery_urls = {url}}});
///
/// A failed registration is repeated for as long as this lives; only the registrar's own thread
/// waits for it. A change between success and failure is logged once.
/// Threading: a thread of its own registers. The destructor waits for it: at most `timeout` and
/// `farewell`, and about a second for each to close its connection.
class Registrar {
public:
    /// Registers at a discovery server; as opcua::registerServer().
    using Register = std::function<opcua::Answer<>(const std::string& url,
                                                   const opcua::ServerRegistration& server,
                                                   std::chrono::milliseconds timeout)>;

    /// Begins to register at once, on its own thread.
    /// Nothing can fail here: errors of a registration are logged.
    /// \param use empty: opcua::registerServer(), with the security of the options
    explicit Registrar(RegistrarOptions options, Register use = {});
    /// Removes the registration if there is one.
    /// A discovery server that did not answer last time is not asked: it forgets the server by
    /// itself.
    ~Registrar();
    Registrar(const Registrar&) = delete;
    Registrar& operator=(const Registrar&) = delete;

private:
    // Body of the thread, with one attempt, and with the removal at the end.
    void run(const std::stop_token& stop);
    void registerNow();
    void leave();

    const RegistrarOptions options_;
    const Register register_;
    bool registered_ = false;  // the last attempt succeeded; used by the thread only
    bool complained_ = false;  // the present series of failures was logged; used by the thread only
    std::mutex mutex_;         // for the wait
    std::condition_variable_any wake_;
    std::jthread thread_;
};

}  // namespace metier::opcua
