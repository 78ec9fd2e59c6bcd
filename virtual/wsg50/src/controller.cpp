#include "controller.hpp"

#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "metier/base/numbers.hpp"
#include "metier/base/text.hpp"

namespace metier::virtual_wsg50 {

namespace {

using namespace std::chrono_literals;
using virtual_controller::InjectionHelp;
using virtual_controller::TcpPeer;

constexpr std::chrono::milliseconds kCycle{2};
constexpr double kCycleSeconds = 0.002;

constexpr std::array<std::string_view, 8> kGraspingStates{
    "idle", "grasping", "no part", "part lost", "holding", "releasing", "positioning", "error"};

Options readOptions(const cell::Settings& settings) {
    Options options;
    auto& can = options.capability;
    options.port = static_cast<std::uint16_t>(settings.numberOr("port", 1000, 0, 65535));
    options.identity.serial =
        static_cast<std::uint32_t>(settings.numberOr("serial", 4711, 0, 4294967295.0));
    options.identity.tag = settings.textOr("tag", "");
    options.part_width = settings.numberOr("part_width", 0.0, 0.0, can.stroke);
    options.fast_stop_on_disconnect = settings.flagOr("fast_stop_on_disconnect", true);
    can.start_width = settings.numberOr("start_width", can.start_width, 0.0, can.stroke);
    can.clamping_travel = settings.numberOr("clamping_travel", can.clamping_travel, 0.0, 0.02);
    can.homing_speed =
        settings.numberOr("homing_speed", can.homing_speed, can.min_speed, can.max_speed);
    return options;
}

/// A width in millimetres as metres; an empty text is 0.
Result<double> parseWidth(const std::string& text, double stroke) {
    const auto width_mm = text.empty() ? 0.0 : numberIn<double>(text).value_or(-1.0);
    if (!(width_mm >= 0.0 && width_mm * kMillimetre <= stroke)) {
        return fail(Errc::invalid_argument,
                    fmt::format("\"{}\" is no width from 0 to {} mm", text, stroke / kMillimetre));
    }
    return width_mm * kMillimetre;
}

}  // namespace

Result<std::unique_ptr<WsgController>> WsgController::start(
    const virtual_controller::ControllerRequest& request) {
    auto options = readOptions(request.settings);
    METIER_TRY(request.settings.finish());
    auto controller =
        std::unique_ptr<WsgController>(new WsgController(request, std::move(options)));
    METIER_TRY(controller->listen(request));
    return controller;
}

WsgController::WsgController(const virtual_controller::ControllerRequest& request, Options options)
    : options_(std::move(options)),
      world_(request.world),
      identity_(options_.identity),
      timer_(request.context, kCycle, [this] { cycle(); }) {
    switchOn();
}

void WsgController::switchOn() {
    part_width_ = options_.part_width;
    block_width_ = 0.0;
    part_slipped_ = false;
    gripper_.emplace(options_.capability, [this](Command command, Status status) {
        if (session_) {
            session_->finished(command, status);
        }
    });
}

Result<void> WsgController::listen(const virtual_controller::ControllerRequest& request) {
    auto server = virtual_controller::TcpServer::listen(
        request.context, request.address, options_.port, request.faults,
        {.on_connected = [this](TcpPeer& peer) { connected(peer); },
         .on_data =
             [this](TcpPeer& peer, std::span<const std::byte> bytes) {
                 if (&peer == client_) {
                     session_->receive(bytes);
                 }
             },
         .on_closed = [this](TcpPeer& peer) { closed(peer); }});
    if (!server) {
        return fail(server.error());
    }
    server_ = std::move(*server);
    return {};
}

// ---- the one client ----------------------------------------------------------------------------

void WsgController::connected(TcpPeer& peer) {
    if (client_ != nullptr) {
        peer.close();
        return;
    }
    client_ = &peer;
    session_.emplace(*gripper_, identity_,
                     [&peer](std::span<const std::byte> bytes) { peer.send(bytes); });
}

void WsgController::closed(const TcpPeer& peer) {
    if (&peer != client_) {
        return;
    }
    const bool announced = session_->disconnectAnnounced();
    client_ = nullptr;
    session_.reset();
    if (!announced && options_.fast_stop_on_disconnect) {
        gripper_->fastStop();
    }
}

void WsgController::restart() {
    client_ = nullptr;
    session_.reset();
    server_->resetAll();
    switchOn();
}

// ---- the gripper and its world -----------------------------------------------------------------

std::optional<double> WsgController::partWidth() {
    const auto part = part_width_ > 0.0 ? std::optional(part_width_) : world_.effect().part_width;
    if (!part) {
        part_slipped_ = false;
    }
    return part_slipped_ ? std::nullopt : part;
}

void WsgController::cycle() {
    const auto block = block_width_ > 0.0 ? std::optional(block_width_) : std::nullopt;
    gripper_->step(kCycleSeconds, {partWidth(), block});
    if (session_) {
        session_->step(kCycle);
    }
    virtual_controller::WorldReport report;
    report.jaw_width = gripper_->width();
    report.gripping = gripper_->force() > 0.0;
    world_.report(report);
}

std::vector<InjectionHelp> WsgController::injections() const {
    return {
        {"part", "a part between the jaws: its width, 0 to 110 mm; 0: what the world has"},
        {"lost-part", "the part slips out of the jaws until another one is there"},
        {"block", "jaws cannot pass this width, 0 to 110 mm; 0: nothing is in the way"},
        {"fast-stop", "fast stop, as if the command had come: needs an acknowledgement"},
        {"temperature-fault", "too hot; `off`: cool again, then it can be acknowledged"},
    };
}

Result<void> WsgController::inject(const virtual_controller::Injection& injection) {
    if (injection.name == "part" || injection.name == "block") {
        METIER_ASSIGN(const auto width, parseWidth(injection.value, options_.capability.stroke));
        (injection.name == "part" ? part_width_ : block_width_) = width;
        part_slipped_ = injection.name == "part" ? false : part_slipped_;
        return {};
    }
    if (injection.name == "lost-part") {
        part_width_ = 0.0;
        part_slipped_ = true;
    } else if (injection.name == "fast-stop") {
        gripper_->fastStop();
    } else if (injection.name == "temperature-fault") {
        gripper_->setTemperatureFault(injection.value != "off");
    } else {
        return fail(Errc::not_found,
                    fmt::format("a WSG 50 knows no injection \"{}\"", injection.name));
    }
    return {};
}

nlohmann::ordered_json WsgController::state() const {
    return {
        {"port", server_->port()},
        {"client", client_ == nullptr ? "" : client_->address()},
        {"referenced", gripper_->referenced()},
        {"fault", gripper_->fault()},
        {"width", gripper_->width()},
        {"velocity", gripper_->velocity()},
        {"force", gripper_->force()},
        {"grasping_state", kGraspingStates.at(static_cast<std::size_t>(gripper_->graspingState()))},
        {"system_state", gripper_->systemState()},
        {"part_width", part_width_},
    };
}

}  // namespace metier::virtual_wsg50

namespace metier::virtual_controller {

ControllerType wsg50Controller();
ControllerType wsg50Controller() {
    return {"wsg50", "Weiss WSG 50 gripper: binary commands over TCP",
            [](const ControllerRequest& request) -> Result<std::unique_ptr<Controller>> {
                return virtual_wsg50::WsgController::start(request);
            }};
}

}  // namespace metier::virtual_controller
