// The virtual controller of the Tern: written from the description of its wire, as tern_driver.cpp
// repeats it, and without a line of that driver.
#include <fmt/format.h>

#include <chrono>
#include <deque>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "metier/joint_simulator/guard.hpp"
#include "metier/virtual_controller/controller.hpp"
#include "metier/virtual_controller/cycle_timer.hpp"
#include "metier/virtual_controller/peer_lines.hpp"
#include "metier/virtual_controller/tcp_server.hpp"

namespace metier::virtual_tern {
namespace {

using namespace std::chrono_literals;
using device::JointArray;
using virtual_controller::Controller;
using virtual_controller::ControllerRequest;
using virtual_controller::Injection;
using virtual_controller::InjectionHelp;
using virtual_controller::TcpPeer;
using virtual_controller::TcpServer;

constexpr auto kCycle = 10ms;
constexpr int kLongestSilence = 50;  // [cycles]
constexpr std::size_t kBuffer = 10;  // [set-points]
constexpr double kRadian = 180.0 / std::numbers::pi;

std::vector<joint_simulator::AxisLimits> limitsOf(const motion::RobotModel& model) {
    std::vector<joint_simulator::AxisLimits> limits;
    for (const auto& joint : model.chain().joints) {
        // The drives give twice what motions are planned with, since a Halt brakes that hard.
        limits.push_back({joint.limits.lower, joint.limits.upper, joint.limits.velocity,
                          2.0 * joint.limits.acceleration});
    }
    return limits;
}

class TernController final : public Controller {
public:
    explicit TernController(const ControllerRequest& request)
        : model_(*request.model),
          world_(request.world),
          guard_(limitsOf(model_), {}, std::chrono::duration<double>(kCycle).count()) {
        restart();
    }

    Result<void> listen(const ControllerRequest& request, std::uint16_t port) {
        auto server = TcpServer::listen(
            request.context, {request.address, port}, request.faults,
            {.on_connected = {},
             .on_data =
                 [this](TcpPeer& peer, auto bytes) {
                     lines_.add(peer, bytes, [this](std::string_view line) { obey(line); });
                 },
             .on_closed = [this](TcpPeer& peer) { lines_.forget(peer); }});
        if (!server) {
            return fail(server.error());
        }
        server_ = std::move(*server);
        timer_.emplace(request.context, kCycle, [this] { cycle(); });
        return {};
    }

    std::vector<InjectionHelp> injections() const override {
        return {{"protective-stop", "The controller stops the arm"}};
    }
    Result<void> inject(const Injection&) override {
        running_ = false;
        return {};
    }
    nlohmann::ordered_json state() const override {
        const auto& position = guard_.position();
        return {{"running", running_},
                {"joint_position", std::vector<double>(position.begin(), position.end())}};
    }
    void restart() override {
        guard_.reset(
            JointArray(std::span<const double>(model_.home().begin(), model_.home().end())));
        target_ = guard_.position();
        waiting_.clear();
        playing_ = false;
        running_ = true;
        if (server_) {
            server_->resetAll();
        }
    }

private:
    void obey(std::string_view line) {
        std::istringstream words{std::string(line)};
        std::string command;
        words >> command;
        if (command == "RESET" && guard_.standing()) {
            running_ = true;
            target_ = guard_.position();
        } else if (command == "BRAKE") {
            braking_ = true;
        } else if (command == "GO" && running_) {
            auto target = target_;
            for (auto& angle : target) {
                if (!(words >> angle)) {
                    return;
                }
                angle /= kRadian;
            }
            target_ = target;
            waiting_.push_back(target);
            braking_ = false;
            silence_ = 0;
        }
    }

    /// One set-point per cycle, some cycles late: a network delivers them in bunches.
    void follow() {
        playing_ = waiting_.size() >= kBuffer || (playing_ && !waiting_.empty()) ||
                   (silence_ > static_cast<int>(kBuffer) && !waiting_.empty());
        auto next = guard_.position();
        if (playing_) {
            next = waiting_.front();
            waiting_.pop_front();
        }
        if (guard_.accept(next)) {
            running_ = false;  // it broke a limit, or the stream did
            guard_.brake();
        }
    }

    void cycle() {
        ++silence_;
        running_ = running_ && (guard_.standing() || silence_ <= kLongestSilence);
        if (braking_ || !running_) {
            target_ = guard_.brake();
            waiting_.clear();
            playing_ = false;
            braking_ = braking_ && !guard_.standing();
        } else {
            follow();
        }
        auto line = std::string(running_ ? "STATE RUN" : "STATE STOP");
        for (const double angle : guard_.position()) {
            line += fmt::format(" {:.6f}", angle * kRadian);
        }
        line += '\n';
        server_->forEach([&](TcpPeer& peer) { peer.send(line); });
        const auto& position = guard_.position();
        const auto joints = motion::JointVector::from(std::span(position.begin(), position.size()));
        world_.report({.base_from_flange = model_.kinematics().forward(*joints)});
    }

    const motion::RobotModel model_;
    virtual_controller::WorldLink& world_;
    joint_simulator::Guard guard_;
    JointArray target_;
    std::deque<JointArray> waiting_;
    bool playing_ = false;
    bool running_ = true;
    bool braking_ = false;
    int silence_ = 0;  // [cycles]
    virtual_controller::PeerLines lines_;
    std::unique_ptr<TcpServer> server_;
    std::optional<virtual_controller::CycleTimer> timer_;
};

Result<std::unique_ptr<Controller>> start(const ControllerRequest& request) {
    const auto port = static_cast<std::uint16_t>(request.settings.numberOr("port", 7300, 0, 65535));
    if (auto checked = request.settings.finish(); !checked) {
        return fail(checked.error());
    }
    if (request.model == nullptr) {
        return fail(Errc::invalid_argument, request.name + ": needs a model");
    }
    auto controller = std::make_unique<TernController>(request);
    if (auto listening = controller->listen(request, port); !listening) {
        return fail(listening.error());
    }
    return controller;
}

}  // namespace
}  // namespace metier::virtual_tern

namespace metier::virtual_controller {

ControllerType ternController() {
    return {"tern", "The robot of docs/guide/add-a-robot.md", virtual_tern::start};
}

}  // namespace metier::virtual_controller
