// The virtual UR as `metier virtual` and cells start it: the robot with its ports.

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "dashboard.hpp"
#include "metier/urscript/script_splitter.hpp"
#include "metier/virtual_controller/controller.hpp"
#include "metier/virtual_controller/standing_time.hpp"
#include "metier/virtual_controller/tcp_server.hpp"
#include "pacer.hpp"
#include "robot.hpp"

namespace metier::virtual_ur {
namespace {

using namespace virtual_controller;

// A client that leaves more than this unread gets no further packages of a stream [bytes].
constexpr std::size_t kMostUnread = 64'000;
constexpr std::size_t kLongestLine = 4096;
constexpr double kPrimaryRate = 10.0;  // [Hz]
constexpr std::array kRuntimeStates{"stopping", "stopped", "playing",
                                    "pausing",  "paused",  "resuming"};

void stream(TcpServer& server, const Bytes& package) {
    server.forEach([&](TcpPeer& peer) {
        if (peer.queued() <= kMostUnread) {
            peer.send(package);
        }
    });
}

bool hasPeers(TcpServer& server) {
    bool any = false;
    server.forEach([&](TcpPeer&) { any = true; });
    return any;
}

class UrController final : public Controller {
public:
    UrController(const ControllerRequest& request, const RobotOptions& options)
        : request_(request),
          robot_(options, {request.context, request.faults, request.world,
                           [this](const Bytes& message) { tell(message); }}),
          dashboard_(robot_, [this](const std::string& text) { robot_.tellText(text); }),
          rtde_{options.description.version,
                robot_.rate(),
                robot_.rtdeInputs(),
                [this](const auto& names) { robot_.inputsWritten(names); },
                {}} {}

    /// Opens the ports and begins to count cycles. Errors: those of TcpServer::listen.
    Result<void> start();

    std::vector<InjectionHelp> injections() const override { return injections_; }
    nlohmann::ordered_json state() const override;
    void restart() override;

private:
    struct Port {
        std::string_view name;
        std::unique_ptr<TcpServer> server;
    };

    TcpServer::Handlers handlersOf(std::string_view service);
    TcpServer::Handlers rtdeHandlers();
    TcpServer::Handlers dashboardHandlers();
    void takeScript(TcpPeer& peer, std::span<const std::byte> bytes);
    void takeLines(TcpPeer& peer, std::span<const std::byte> bytes);
    void tell(const Bytes& message);
    void cycle();

    ControllerRequest request_;
    Robot robot_;
    const std::vector<InjectionHelp> injections_ = accidentsOf(robot_);
    Dashboard dashboard_;
    RtdeShared rtde_;
    std::map<TcpPeer*, std::unique_ptr<RtdeSession>> sessions_;
    std::map<TcpPeer*, urscript::ScriptSplitter> splitters_;
    std::map<TcpPeer*, std::string> lines_;  // bytes since the last line feed
    std::vector<Port> ports_;
    std::optional<Pacer> pacer_;
    StandingTime standing_;
};

Result<void> UrController::start() {
    for (std::size_t i = 0; i < kServices.size(); ++i) {
        const auto name = kServices[i].name;
        METIER_ASSIGN(auto server, TcpServer::listen(request_.context,
                                                     {request_.address, robot_.options().ports[i]},
                                                     request_.faults, handlersOf(name)));
        ports_.push_back({name, std::move(server)});
    }
    const auto period = std::chrono::duration<double>(robot_.options().arm.cycle);
    pacer_.emplace(request_.context, std::chrono::round<std::chrono::nanoseconds>(period),
                   [this] { cycle(); });
    return {};
}

TcpServer::Handlers UrController::handlersOf(std::string_view service) {
    if (service == "dashboard") {
        return dashboardHandlers();
    }
    if (service == "rtde") {
        return rtdeHandlers();
    }
    TcpServer::Handlers handlers;
    if (!service.starts_with("realtime")) {
        handlers.on_connected = [this](TcpPeer& peer) {
            peer.send(versionMessage(robot_.options().description));
            peer.send(robotStatePackage(robot_.state(), robot_.options().description));
        };
    }
    if (!service.ends_with("read_only")) {
        handlers.on_data = [this](TcpPeer& peer, auto bytes) { takeScript(peer, bytes); };
        handlers.on_closed = [this](TcpPeer& peer) { splitters_.erase(&peer); };
    }
    return handlers;
}

TcpServer::Handlers UrController::rtdeHandlers() {
    TcpServer::Handlers handlers;
    handlers.on_connected = [this](TcpPeer& peer) {
        sessions_[&peer] = std::make_unique<RtdeSession>(rtde_, peer);
    };
    handlers.on_data = [this](TcpPeer& peer, std::span<const std::byte> bytes) {
        const auto session = sessions_.find(&peer);
        if (session != sessions_.end() && !session->second->receive(bytes)) {
            sessions_.erase(session);
            peer.close();
        }
    };
    handlers.on_closed = [this](TcpPeer& peer) { sessions_.erase(&peer); };
    return handlers;
}

TcpServer::Handlers UrController::dashboardHandlers() {
    TcpServer::Handlers handlers;
    handlers.on_connected = [](TcpPeer& peer) {
        peer.send(std::string(Dashboard::kGreeting) + "\n");
    };
    handlers.on_data = [this](TcpPeer& peer, auto bytes) { takeLines(peer, bytes); };
    handlers.on_closed = [this](TcpPeer& peer) { lines_.erase(&peer); };
    return handlers;
}

void UrController::takeScript(TcpPeer& peer, std::span<const std::byte> bytes) {
    std::vector<std::string> programs;
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()),  // NOLINT: text
                                bytes.size());
    if (const auto taken = splitters_[&peer].push(text, programs); !taken) {
        robot_.tellText(taken.error().message);
    }
    for (const auto& program : programs) {
        robot_.takeScript(program);
    }
}

void UrController::takeLines(TcpPeer& peer, std::span<const std::byte> bytes) {
    auto& line = lines_[&peer];
    for (const auto byte : bytes) {
        const auto c = static_cast<char>(byte);
        if (c != '\n') {
            line += c;
            if (line.size() > kLongestLine) {
                return peer.close();
            }
            continue;
        }
        const auto answer = dashboard_.answer(std::exchange(line, {}));
        peer.send(answer.line + "\n");
        if (answer.then == Dashboard::Answer::Then::disconnect) {
            return peer.close();
        }
    }
}

void UrController::tell(const Bytes& message) {
    for (const auto& one : ports_) {
        if (one.name.starts_with("primary")) {
            stream(*one.server, message);
        }
    }
}

void UrController::cycle() {
    robot_.cycle();
    const auto& state = robot_.state();
    standing_.take(state.actual_q, std::chrono::steady_clock::now());
    for (const auto& [peer, session] : sessions_) {
        session->cycle(state);
    }
    const auto& description = robot_.options().description;
    const auto tenth = [&](std::uint64_t cycle) {
        return static_cast<std::uint64_t>(static_cast<double>(cycle) * kPrimaryRate /
                                          robot_.rate());
    };
    const bool state_due = tenth(state.cycle) != tenth(state.cycle - 1);
    for (const auto& [name, server] : ports_) {
        if (!hasPeers(*server)) {
            continue;
        }
        if (name.starts_with("realtime")) {
            stream(*server, realtimePackage(state, description.series));
        } else if (state_due && (name.starts_with("primary") || name.starts_with("secondary"))) {
            stream(*server, robotStatePackage(state, description));
        }
    }
}

nlohmann::ordered_json UrController::state() const {
    const auto& state = robot_.state();
    nlohmann::ordered_json ports;
    for (const auto& one : ports_) {
        ports[std::string(one.name)] = one.server->port();
    }
    nlohmann::ordered_json shown{
        {"robot_mode", toText(state.robot_mode)},
        {"safety_mode", toText(state.safety_mode)},
        {"runtime_state", kRuntimeStates.at(static_cast<std::size_t>(state.runtime_state))},
        {"remote_control", robot_.control() == Control::remote},
        {"joint_position", state.actual_q},
        {"tool_pose", state.actual_tcp_pose},
        {"speed_slider", state.speed_slider},
        {"speed_scaling", state.speed_scaling},
        {"timestamp", state.timestamp},
        {"ports", std::move(ports)}};
    standing_.show(shown, std::chrono::steady_clock::now());
    return shown;
}

void UrController::restart() {
    sessions_.clear();
    splitters_.clear();
    lines_.clear();
    for (const auto& one : ports_) {
        one.server->resetAll();
    }
    robot_.restart();
}

Result<std::unique_ptr<Controller>> start(const ControllerRequest& request) {
    if (request.model == nullptr) {
        return fail(Errc::invalid_argument, request.name + ": a UR controller needs a model");
    }
    METIER_ASSIGN(auto options, readOptions(request.settings, *request.model));
    options.address = request.address;
    auto controller = std::make_unique<UrController>(request, options);
    METIER_TRY(controller->start());
    return controller;
}

}  // namespace
}  // namespace metier::virtual_ur

namespace metier::virtual_controller {

ControllerType urController();  // found by the table of controllers (cmake/MetierDevices.cmake)

ControllerType urController() {
    return {"ur", "controller of a Universal Robots arm: CB3 or e-Series", &virtual_ur::start};
}

}  // namespace metier::virtual_controller
