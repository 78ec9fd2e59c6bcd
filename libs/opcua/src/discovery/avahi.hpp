#pragma once

#include <avahi-client/client.h>
#include <avahi-common/simple-watch.h>

#include <functional>
#include <memory>
#include <string>

namespace metier::opcua {

inline constexpr const char* kServiceType = "_opcua-tcp._tcp";
inline constexpr const char* kAddressScheme = "opc.tcp://";

/// A connection to the Avahi daemon, and the loop that serves it.
///
/// Threading: one thread.
class AvahiSession {
public:
    /// \param on_running the daemon is there; called for each time
    explicit AvahiSession(std::function<void()> on_running = {});
    ~AvahiSession();
    AvahiSession(const AvahiSession&) = delete;
    AvahiSession& operator=(const AvahiSession&) = delete;

    /// Why there is none; empty while it works or waits for the daemon.
    const std::string& problem() const noexcept { return problem_; }
    AvahiClient* client() noexcept { return client_; }
    /// Handles what comes within `longest_ms`.
    void iterate(int longest_ms);

private:
    static void changed(AvahiClient* client, AvahiClientState state, void* context) noexcept;
    void took(AvahiClient* client, AvahiClientState state);

    struct FreePoll {
        void operator()(AvahiSimplePoll* poll) const noexcept { avahi_simple_poll_free(poll); }
    };
    std::unique_ptr<AvahiSimplePoll, FreePoll> poll_;
    AvahiClient* client_ = nullptr;
    std::function<void()> on_running_;
    std::string problem_;
};

}  // namespace metier::opcua
