#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>

#include "metier/base/clock.hpp"

namespace metier::records {

/// Cuts the connection of a call that knows no deadline of its own, so that it returns.
///
/// Threading: one thread arms it; one of its own looks, twice a second.
class SocketDeadline {
public:
    /// As long as it lives the socket is watched, which must stay open meanwhile.
    class Armed {
    public:
        explicit Armed(SocketDeadline& owner) : owner_(owner) {}
        ~Armed() { owner_.disarm(); }
        Armed(const Armed&) = delete;
        Armed& operator=(const Armed&) = delete;

    private:
        SocketDeadline& owner_;
    };

    SocketDeadline();
    /// \param socket -1: there is none
    Armed arm(int socket, std::chrono::milliseconds longest);

private:
    void disarm();
    void watch(const std::stop_token& stop);

    std::mutex mutex_;
    std::condition_variable_any nothing_;
    int socket_ = -1;
    std::optional<SteadyTime> deadline_;
    std::jthread thread_;  // last: it uses everything above
};

}  // namespace metier::records
