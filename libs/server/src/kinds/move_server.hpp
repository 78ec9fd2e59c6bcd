#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "kinds/robot_moves.hpp"
#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/cell/cell.hpp"
#include "metier/server/server.hpp"

namespace metier::server {

/// The move skills over the position stream of another server, whatever its robot is.
///
/// A robot that was found by discovery and stays away is exchanged for another one; a server that
/// comes back with another arm, or other limits, is taken as a new one. As each robot has axes,
/// ranges and limits of its own, the OPC UA server ends then and starts again at the same address.
/// Threading: one thread starts and ends it; it waits some seconds for a thread that exchanges.
class MoveServer final : public Server {
public:
    /// Starts the server. If a robot is to be found, it waits for one, 20 s at most.
    /// \param move of `config`
    /// Errors: the robot's server cannot be reached or does not publish enough; the port is taken;
    /// cancelled (a stop was asked for).
    static Result<std::unique_ptr<MoveServer>> start(const cell::ServerConfig& config,
                                                     const cell::MoveComponent& move,
                                                     const Context& context);
    ~MoveServer() override;

    /// Stays the same.
    std::string url() const override { return url_; }

private:
    /// Source of robots that a move component may move.
    struct RobotSearch {
        cell::Discovery discovery;
        cell::MoveComponent move;
        const Identity& identity;

        /// Addresses of servers with a position stream, and reach and payload enough.
        std::vector<std::string> find(const std::vector<std::string>& but) const;
        /// One of them, when there is one; waits 20 s at most.
        Result<ConnectedRobot> first(const link::StopSignal& stop) const;

    private:
        Result<ConnectedRobot> connectAny() const;
    };

    MoveServer(cell::ServerConfig config, RobotSearch search, std::unique_ptr<RobotMoves> moves);

    void run(const std::stop_token& stop);
    bool awaitNext(const std::stop_token& stop);
    /// Addresses at which another robot may be; empty while the present one stays.
    std::vector<std::string> candidates() const;
    Result<void> exchange(const std::string& robot_url);
    void tell(const Error& error);

    cell::ServerConfig config_;  // with the server's real port
    const RobotSearch search_;
    const std::string url_;
    const std::string announced_url_;
    // Used by the thread only, once it runs.
    std::unique_ptr<RobotMoves> moves_;             // null after an exchange that failed
    std::shared_ptr<skill::ExecutionNames> names_;  // shared with the Programs of each robot
    std::string robot_url_;                         // of the present robot, or the last one
    SteadyTime next_try_{};
    std::string reported_;  // the last complaint, which is not repeated

    std::mutex mutex_;  // for the wait
    std::condition_variable_any wake_;
    std::jthread thread_;
};

}  // namespace metier::server
