#pragma once

#include <chrono>
#include <optional>

#include "metier/base/clock.hpp"
#include "metier/opcua/answer.hpp"

namespace metier::opcua {

/// Reconnection of a Client whose connection broke.
struct ReconnectOptions {
    /// Pause before the first attempt, > 0.
    std::chrono::milliseconds shortest_pause{200};
    /// Longest pause; the pauses double up to this value.
    std::chrono::milliseconds longest_pause{2'000};
    /// Random part, 0 to 1, by which each pause is shortened at most, so that many clients of one
    /// server do not come back at the same time.
    double jitter = 0.25;
    /// Longest time without a connection, after which the client gives up; none: it tries until
    /// close().
    std::optional<std::chrono::milliseconds> give_up_after{};
};

/// Change of a Client's connection.
struct ConnectionChange {
    enum class Kind {
        /// Broken, or silent for too long; `why` has the reason. Attempts to reconnect follow.
        lost,
        /// Connected again, Subscriptions included.
        back,
        /// There is no connection and there will be none; `why` has the reason.
        given_up,
    };

    /// Kind of the change.
    Kind kind = Kind::lost;
    /// Time of the change, by this machine's wall clock.
    UtcTime time{};
    /// Reason, for lost and given_up.
    Failure why{};
    /// With `back`: the server has forgotten all; NodeIds may differ, see Client::boot().
    bool server_restarted = false;
    /// With `back`: the session is the former one, with all that it owned. If not, the server
    /// treats the former session as gone, at the latest when it times out.
    bool same_session = false;
};

}  // namespace metier::opcua
