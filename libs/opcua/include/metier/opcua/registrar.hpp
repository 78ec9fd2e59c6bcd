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

struct RegistrarOptions {
    std::string discovery_url;                 ///< of the discovery server: "opc.tcp://host:4840"
    opcua::ServerRegistration server;          ///< who registers
    std::chrono::milliseconds period{30'000};  ///< between registrations that went well, > 0
    std::chrono::milliseconds pause{5'000};    ///< after one that did not, > 0
    std::chrono::milliseconds timeout{2'000};  ///< of each
    std::chrono::milliseconds farewell{500};   ///< timeout of the last one, which takes it out
    std::optional<opcua::Credentials> security{};  ///< as opcua::registerServer()
};

/// Keeps a server registered at one discovery server, and takes it out at its end.
///
/// Whatever the discovery server does, or does not, it is asked again, and nobody else waits.
/// What changes is logged, once.
/// Threading: a thread of its own registers. The destructor waits for it: at most a `timeout` and
/// `farewell`, and about a second for each to close its connection.
class Registrar {
public:
    /// Registers at a discovery server; as opcua::registerServer().
    using Register = std::function<opcua::Answer<>(const std::string& url,
                                                   const opcua::ServerRegistration& server,
                                                   std::chrono::milliseconds timeout)>;

    /// \param use empty: opcua::registerServer(), with the security of the options
    explicit Registrar(RegistrarOptions options, Register use = {});
    ~Registrar();
    Registrar(const Registrar&) = delete;
    Registrar& operator=(const Registrar&) = delete;

private:
    void run(const std::stop_token& stop);
    void registerNow();
    void leave();

    const RegistrarOptions options_;
    const Register register_;
    bool registered_ = false;  // the last attempt went well; the thread's
    bool complained_ = false;  // of the present series of failures; the thread's
    std::mutex mutex_;         // for the wait
    std::condition_variable_any wake_;
    std::jthread thread_;
};

}  // namespace metier::opcua
