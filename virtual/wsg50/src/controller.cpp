#include "metier/virtual_controller/controller.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gripper.hpp"
#include "metier/base/numbers.hpp"
#include "metier/base/text.hpp"
#include "metier/virtual_controller/cycle_timer.hpp"
#include "metier/virtual_controller/tcp_server.hpp"
#include "session.hpp"

namespace metier::virtual_wsg50 {
namespace {

using namespace virtual_controller;
using namespace std::chrono_literals;

/// Options from the settings (README.md).
struct Options {
    std::uint16_t port = 1000;
    Capability capability;
    Identity identity;
    double part_width = 0.0;  ///< [m]; 0: only what the world has
    bool fast_stop_on_disconnect = true;
};

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

/// A WSG 50 on its TCP port, for one client.
class WsgController final : public Controller {
public:
    WsgController(const ControllerRequest& request, Options options);
    /// Errors: those of TcpServer::listen().
    Result<void> listen(const ControllerRequest& request);

    std::vector<InjectionHelp> injections() const override { return injections_; }
    nlohmann::ordered_json state() const override;
    void restart() override;

private:
    std::vector<InjectionHelp> makeInjections();
    void switchOn();
    void connected(TcpPeer& peer);
    void closed(const TcpPeer& peer);
    std::optional<double> partWidth();
    void cycle();

    const Options options_;
    const std::vector<InjectionHelp> injections_ = makeInjections();
    WorldLink& world_;
    Identity identity_;
    double part_width_ = 0.0;   // [m]; 0: none of its own
    double block_width_ = 0.0;  // [m]; 0: nothing is in the way
    bool part_slipped_ = false;
    std::optional<Gripper> gripper_;
    TcpPeer* client_ = nullptr;
    std::optional<Session> session_;
    std::unique_ptr<TcpServer> server_;
    CycleTimer timer_;
};

WsgController::WsgController(const ControllerRequest& request, Options options)
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

Result<void> WsgController::listen(const ControllerRequest& request) {
    return TcpServer::listen(request.context, {request.address, options_.port}, request.faults,
                             {.on_connected = [this](TcpPeer& peer) { connected(peer); },
                              .on_data =
                                  [this](TcpPeer& peer, std::span<const std::byte> bytes) {
                                      if (&peer == client_) {
                                          session_->receive(bytes);
                                      }
                                  },
                              .on_closed = [this](TcpPeer& peer) { closed(peer); }})
        .map([this](auto server) { server_ = std::move(server); });
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
    WorldReport report;
    report.jaw_width = gripper_->width();
    report.gripping = gripper_->force() > 0.0;
    world_.report(report);
}

std::vector<InjectionHelp> WsgController::makeInjections() {
    return {
        {"part", "a part between the jaws: its width, 0 to 110 mm; 0: what the world has",
         [this](const std::string& value) {
             return parseWidth(value, options_.capability.stroke).map([this](double width) {
                 part_width_ = width;
                 part_slipped_ = false;
             });
         }},
        {"lost-part", "the part slips out of the jaws until another one is there", always([this] {
             part_width_ = 0.0;
             part_slipped_ = true;
         })},
        {"block", "jaws cannot pass this width, 0 to 110 mm; 0: nothing is in the way",
         [this](const std::string& value) {
             return parseWidth(value, options_.capability.stroke).map([this](double width) {
                 block_width_ = width;
             });
         }},
        {"fast-stop", "fast stop, as if the command had come: needs an acknowledgement",
         always([this] { gripper_->fastStop(); })},
        {"temperature-fault", "too hot; `off`: cool again, then it can be acknowledged",
         [this](const std::string& value) -> Result<void> {
             gripper_->setTemperatureFault(value != "off");
             return {};
         }},
    };
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

Result<std::unique_ptr<Controller>> start(const ControllerRequest& request) {
    auto options = readOptions(request.settings);
    METIER_TRY(request.settings.finish());
    auto controller = std::make_unique<WsgController>(request, std::move(options));
    METIER_TRY(controller->listen(request));
    return controller;
}

}  // namespace
}  // namespace metier::virtual_wsg50

namespace metier::virtual_controller {

ControllerType wsg50Controller();
ControllerType wsg50Controller() {
    return {"wsg50", "Weiss WSG 50 gripper: binary commands over TCP", virtual_wsg50::start};
}

}  // namespace metier::virtual_controller
