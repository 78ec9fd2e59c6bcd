#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>

#include "metier/opcua/server.hpp"
#include "metier/skill/executor.hpp"

namespace metier::opcua_skill {

/// Executor on the thread of an OPC UA server, for the Programs of that server.
///
/// Shared with Executions, which may outlive the server: after close() it drops posted work, and
/// after() gives an empty Timer.
/// Threading: as skill::Executor; a short lock guards the server.
///
///     auto executor = std::make_shared<ServerExecutor>(server);
///     Program program({}, std::move(skill), executor, clock);
///     ...
///     executor->close();  // before the server ends
class ServerExecutor final : public skill::Executor {
public:
    /// `server` must live until close().
    explicit ServerExecutor(opcua::Server& server) : server_(&server) {}

    /// Any thread. Order as Server::post(); dropped after close().
    void post(std::function<void()> work) override;
    /// Server's thread. The Timer may outlive the server.
    skill::Timer after(std::chrono::nanoseconds delay, std::function<void()> work) override;

    /// Detaches the server, which may end from now on. Any thread.
    void close();

private:
    std::mutex mutex_;
    opcua::Server* server_;  // null once closed; guarded by mutex_
};

}  // namespace metier::opcua_skill
