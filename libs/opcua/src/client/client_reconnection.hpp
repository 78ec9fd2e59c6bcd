#pragma once

#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/opcua/connection.hpp"

namespace metier::opcua {

/// Times of the attempts to connect again.
///
/// Threading: one thread.
class ReconnectSchedule {
public:
    explicit ReconnectSchedule(const ReconnectOptions& options);

    /// The connection was lost: the first attempt is due after the shortest pause.
    void begin(SteadyTime now);
    /// An attempt failed: the next pause is twice as long.
    void failed(SteadyTime now);
    /// The last failure was not the server's: try again without a pause.
    void retry(SteadyTime now) { next_ = now; }
    /// Time of the next attempt.
    SteadyTime next() const noexcept { return next_; }
    /// Whether it has been tried for too long.
    bool expired(SteadyTime now) const;

private:
    void schedule(SteadyTime now);

    const ReconnectOptions options_;
    std::chrono::milliseconds pause_{};
    SteadyTime began_{};
    SteadyTime next_{};
    std::minstd_rand random_{std::random_device{}()};
};

/// Identity of one run of a server.
struct ServerIdentity {
    UtcTime start_time{};  ///< the epoch: the server does not publish it
    std::vector<std::string> namespaces{};
};

/// Mapping of a server's namespace indices after it was started again.
class NamespaceMove {
public:
    NamespaceMove() = default;
    NamespaceMove(const std::vector<std::string>& before, const std::vector<std::string>& after);

    /// Present index of the namespace that had index `before`; none: the namespace does not exist
    /// any more.
    std::optional<std::uint16_t> operator()(std::uint16_t before) const;

private:
    std::vector<std::optional<std::uint16_t>> now_;  // by former index; beyond: unchanged
};

}  // namespace metier::opcua
