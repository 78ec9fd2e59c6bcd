#pragma once

#include <chrono>
#include <optional>

#include "metier/base/clock.hpp"
#include "metier/opcua/answer.hpp"

namespace metier::opcua {

/// How a Client comes back when its connection breaks.
struct ReconnectOptions {
    std::chrono::milliseconds shortest_pause{200};   ///< before the first attempt
    std::chrono::milliseconds longest_pause{2'000};  ///< the pauses double up to it
    /// Each pause is shorter by up to this part of itself, by chance, so that many clients of one
    /// server do not come back in step. 0 to 1.
    double jitter = 0.25;
    /// Given up after so long without a connection; none: tried until close().
    std::optional<std::chrono::milliseconds> give_up_after{};
};

/// What has become of a Client's connection.
struct ConnectionChange {
    enum class Kind {
        lost,      ///< broken, or silent for too long; `why`. Attempts to reconnect follow
        back,      ///< connected again, Subscriptions included
        given_up,  ///< there is no connection and there will be none; `why`
    };

    Kind kind = Kind::lost;
    UtcTime time{};  ///< by this machine's clock
    Failure why{};
    bool server_restarted = false;  ///< back: all that the server knew is gone, NodeIds may differ
    /// back: the session is the one from before, and whatever it owned with it. If not, the server
    /// treats the former session as gone, at the latest when it times out.
    bool same_session = false;
};

}  // namespace metier::opcua
