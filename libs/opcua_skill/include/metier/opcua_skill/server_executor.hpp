#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>

#include "metier/opcua/server.hpp"
#include "metier/skill/executor.hpp"

namespace metier::opcua_skill {

/// The thread of an OPC UA server as the owner of Programs.
///
/// Shared with Executions, which may outlive the server: after close() it drops what it is given.
class ServerExecutor final : public skill::Executor {
public:
    /// `server` must live until close().
    explicit ServerExecutor(opcua::Server& server) : server_(&server) {}

    void post(std::function<void()> work) override;
    skill::Timer after(std::chrono::nanoseconds delay, std::function<void()> work) override;

    /// From now on the server may go. Any thread.
    void close();

private:
    std::mutex mutex_;
    opcua::Server* server_;  // null once closed; guarded by mutex_
};

}  // namespace metier::opcua_skill
