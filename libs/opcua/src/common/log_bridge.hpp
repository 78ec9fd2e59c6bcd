#pragma once

#include <open62541/plugin/log.h>
#include <spdlog/logger.h>

#include <memory>

namespace metier::opcua {

/// Writes the stack's log to ours. Its text may come from the network: it is made printable and
/// never used as a format.
///
/// Threading: any. Must outlive what logs through it.
class LogBridge {
public:
    explicit LogBridge(std::shared_ptr<spdlog::logger> target);
    LogBridge(const LogBridge&) = delete;
    LogBridge& operator=(const LogBridge&) = delete;

    UA_Logger* handle() noexcept { return &handle_; }
    spdlog::logger& target() noexcept { return *target_; }

private:
    UA_Logger handle_{};
    std::shared_ptr<spdlog::logger> target_;  ///< shared with its other users, as spdlog does
};

}  // namespace metier::opcua
