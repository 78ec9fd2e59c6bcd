#pragma once

#include <open62541/server.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <unordered_map>

#include "metier/opcua/server.hpp"

namespace metier::opcua {

/// One-shot timers of the stack that run closures.
///
/// Threading: the server's thread.
class PendingTimers {
public:
    using Run = std::function<void(const std::function<void()>&)>;

    /// \param run calls a closure; must not throw
    PendingTimers(UA_Server* server, Run run) : server_(server), run_(std::move(run)) {}
    PendingTimers(const PendingTimers&) = delete;
    PendingTimers& operator=(const PendingTimers&) = delete;
    ~PendingTimers();

    /// The handle cancels it as long as these timers live.
    static TimerHandle start(const std::shared_ptr<PendingTimers>& timers,
                             std::chrono::nanoseconds delay, std::function<void()> work);

private:
    struct Pending {
        PendingTimers* owner = nullptr;
        std::uint64_t key = 0;
        UA_UInt64 callback = 0;
        std::function<void()> work;
    };

    static void due(UA_Server* server, void* pending) noexcept;
    void cancel(std::uint64_t key) noexcept;

    UA_Server* server_;
    Run run_;
    std::unordered_map<std::uint64_t, std::unique_ptr<Pending>> pending_;
    std::uint64_t last_key_ = 0;
};

}  // namespace metier::opcua
