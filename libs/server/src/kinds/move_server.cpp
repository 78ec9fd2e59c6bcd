#include "kinds/move_server.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "finding/discovered_servers.hpp"
#include "kinds/look_times.hpp"
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

}  // namespace

std::vector<std::string> MoveServer::RobotSearch::find(const std::vector<std::string>& but) const {
    std::vector<std::string> urls;
    for (const auto& server : survey(announcedServers(discovery, but), identity)) {
        if (hasStreamFor(server, {move.reach, move.payload})) {
            urls.push_back(server.server.url);
        }
    }
    return urls;
}

Result<ConnectedRobot> MoveServer::RobotSearch::connectAny() const {
    Result<ConnectedRobot> robot = fail(noneFound(move));
    for (const auto& url : find({})) {
        robot = connectRobot(url, identity);
        if (robot) {
            break;
        }
    }
    return robot;
}

Result<ConnectedRobot> MoveServer::RobotSearch::first(const link::StopSignal& stop) const {
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

Result<std::unique_ptr<MoveServer>> MoveServer::start(const cell::ServerConfig& config,
                                                      const cell::MoveComponent& move,
                                                      const Context& context) {
    RobotSearch search{config.discovery, move, context.identity};
    if (move.discover) {
        spdlog::info("{} seeks a robot", config.name);
    }
    METIER_ASSIGN(auto robot, move.discover ? search.first(context.stop)
                                            : connectRobot(move.robot, context.identity));
    spdlog::info("{} moves {} ({})", config.name, robot.arm->info().name, robot.url);
    METIER_ASSIGN(auto moves,
                  RobotMoves::serve(config, context.identity, std::move(robot), nullptr));
    return std::unique_ptr<MoveServer>(new MoveServer(config, std::move(search), std::move(moves)));
}

MoveServer::MoveServer(cell::ServerConfig config, RobotSearch search,
                       std::unique_ptr<RobotMoves> moves)
    : config_(std::move(config)),
      search_(std::move(search)),
      url_(moves->url()),
      announced_url_(moves->announcedUrl()),
      moves_(std::move(moves)),
      names_(moves_->names()),
      robot_url_(moves_->robot().url) {
    config_.port = moves_->port();
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
    METIER_ASSIGN(auto robot, connectRobot(robot_url, search_.identity));
    const auto name = robot.arm->info().name;
    moves_.reset();  // lets go of the port
    METIER_ASSIGN(auto moves,
                  RobotMoves::serve(config_, search_.identity, std::move(robot), names_));
    moves_ = std::move(moves);
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

}  // namespace metier::server
