#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>

#include "finding/discovered_servers.hpp"
#include "kinds/kinds.hpp"
#include "kinds/look_times.hpp"
#include "kinds/robot_moves.hpp"
#include "metier/base/clock.hpp"
#include "metier/server/skill_survey.hpp"

namespace metier::server {
namespace {

using namespace std::chrono_literals;

constexpr const char* kStream = "PositionStreamSkillType";

bool hasStreamFor(const SurveyedServer& server, const ArmFigures& least) {
    return server.skills &&
           std::any_of(server.skills->begin(), server.skills->end(), [&](const auto& skill) {
               return isA(skill, kStream) && isAtLeast(least, skill.arm);
           });
}

Error noneFound(const cell::MoveComponent& move) {
    return {Errc::not_found, fmt::format("no server with a PositionStreamSkill{} is found",
                                         textOf({move.reach, move.payload}))};
}

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

/// A robot that was found by discovery and stays away is exchanged for another one; a server that
/// comes back with another arm, or other limits, is taken as a new one. As each robot has axes,
/// ranges and limits of its own, the OPC UA server ends then and starts again at the same address.
/// Threading: one thread starts and ends it; it waits some seconds for a thread that exchanges.
class MoveServer final : public Server {
public:
    MoveServer(cell::ServerConfig config, RobotSearch search, std::unique_ptr<RobotMoves> moves);
    ~MoveServer() override;

    /// Stays the same.
    std::string url() const override { return url_; }

private:
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

std::vector<std::string> RobotSearch::find(const std::vector<std::string>& but) const {
    std::vector<std::string> urls;
    for (const auto& server : survey(announcedServers(discovery, but), identity)) {
        if (hasStreamFor(server, {move.reach, move.payload})) {
            urls.push_back(server.server.url);
        }
    }
    return urls;
}

Result<ConnectedRobot> RobotSearch::connectAny() const {
    Result<ConnectedRobot> robot = fail(noneFound(move));
    for (const auto& url : find({})) {
        robot = connectRobot(url, move, identity);
        if (robot) {
            break;
        }
    }
    return robot;
}

Result<ConnectedRobot> RobotSearch::first(const link::StopSignal& stop) const {
    const auto deadline = std::chrono::steady_clock::now() + kLongestSearch;
    while (true) {
        auto robot = connectAny();
        if (robot || std::chrono::steady_clock::now() > deadline) {
            return robot;
        }
        if (stop.waitUntil(std::chrono::steady_clock::now() + kLookEvery)) {
            return fail(Errc::cancelled, "stopped before a robot was found");
        }
    }
}

MoveServer::MoveServer(cell::ServerConfig config, RobotSearch search,
                       std::unique_ptr<RobotMoves> moves)
    : config_(std::move(config)),
      search_(std::move(search)),
      url_(moves->host().url()),
      announced_url_(moves->host().announcedUrl()),
      moves_(std::move(moves)),
      names_(moves_->host().names()),
      robot_url_(moves_->robot().url) {
    config_.port = moves_->host().port();
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

MoveServer::~MoveServer() {
    thread_.request_stop();
    thread_ = {};
}

void MoveServer::run(const std::stop_token& stop) {
    while (awaitNext(stop)) {
        if (std::chrono::steady_clock::now() < next_try_) {
            continue;
        }
        for (const auto& url : candidates()) {
            const auto exchanged = exchange(url);
            if (exchanged || stop.stop_requested()) {
                break;
            }
            tell(exchanged.error());
            next_try_ = std::chrono::steady_clock::now() + kPause;
        }
    }
}

bool MoveServer::awaitNext(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    wake_.wait_for(lock, stop, kLookEvery, [] { return false; });
    return !stop.stop_requested();
}

std::vector<std::string> MoveServer::candidates() const {
    if (moves_ == nullptr) {
        return search_.move.discover ? search_.find({announced_url_}) : std::vector{robot_url_};
    }
    const auto absence = moves_->robot().arm->absence();
    if (!absence) {
        return {};
    }
    if (absence->replaced) {
        return {robot_url_};
    }
    const std::chrono::duration<double> away = std::chrono::steady_clock::now() - absence->since;
    return search_.move.discover && away.count() > search_.move.rebind_after
               ? search_.find({announced_url_, robot_url_})
               : std::vector<std::string>();
}

/// Nothing moves now: what ran when the robot was lost is Halted.
Result<void> MoveServer::exchange(const std::string& robot_url) {
    METIER_ASSIGN(auto robot, connectRobot(robot_url, search_.move, search_.identity));
    const auto name = robot.arm->info().name;
    moves_.reset();  // lets go of the port
    METIER_ASSIGN(moves_, RobotMoves::serve(config_, search_.identity, std::move(robot), names_));
    spdlog::warn("{} moves {} ({}) from now on: {}", config_.name, name, robot_url,
                 robot_url == robot_url_ ? "another arm, or other limits, at the same address"
                                         : robot_url_ + " is away");
    robot_url_ = robot_url;
    reported_.clear();
    return {};
}

void MoveServer::tell(const Error& error) {
    if (error.message != reported_) {
        spdlog::warn("{}: {} cannot be exchanged: {}", config_.name, robot_url_, error.message);
        reported_ = error.message;
    }
}

/// Logs which robot is moved, and what its motions cannot have.
void tellOf(const std::string& name, const ConnectedRobot& robot) {
    spdlog::info("{} moves {} ({})", name, robot.arm->info().name, robot.url);
    if (const auto& lacks = robot.arm->lacks(); !lacks.empty()) {
        spdlog::warn("{}: {} has {}", robot.url, robot.arm->info().name, explanationOf(lacks));
    }
}

}  // namespace

Result<std::unique_ptr<Server>> serve(const cell::ServerConfig& config,
                                      const cell::MoveComponent& move, const Context& context) {
    RobotSearch search{config.discovery, move, context.identity};
    if (move.discover) {
        spdlog::info("{} seeks a robot", config.name);
    }
    METIER_ASSIGN(auto robot, move.discover ? search.first(context.stop)
                                            : connectRobot(move.robot, move, context.identity));
    tellOf(config.name, robot);
    METIER_ASSIGN(auto moves,
                  RobotMoves::serve(config, context.identity, std::move(robot), nullptr));
    return std::make_unique<MoveServer>(config, std::move(search), std::move(moves));
}

}  // namespace metier::server
