#pragma once

#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/opcua/connection.hpp"

namespace metier::opcua {

/// When to try to connect again.
///
/// Threading: one thread.
class ReconnectSchedule {
public:
    explicit ReconnectSchedule(const ReconnectOptions& options);

    /// The connection was lost: the first attempt is due after the shortest pause.
    void begin(SteadyTime now);
    /// An attempt failed: the next pause is twice as long.
    void failed(SteadyTime now);
    /// What failed says nothing about the server: try again without a pause.
    void retry(SteadyTime now) { next_ = now; }
    /// When the next attempt is due.
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

/// One run of a server, told from others.
struct ServerIdentity {
    UtcTime start_time{};  ///< the epoch: the server does not tell
    std::vector<std::string> namespaces{};
};

/// Where the namespaces of a server are found after it was started again.
class NamespaceMove {
public:
    NamespaceMove() = default;
    NamespaceMove(const std::vector<std::string>& before, const std::vector<std::string>& after);

    /// The index now of what had `before` as its index; none: the namespace is gone.
    std::optional<std::uint16_t> operator()(std::uint16_t before) const;

private:
    std::vector<std::optional<std::uint16_t>> now_;  // by former index; beyond: as it was
};

}  // namespace metier::opcua
