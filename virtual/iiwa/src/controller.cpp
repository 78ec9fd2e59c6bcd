#include "metier/virtual_controller/controller.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "metier/virtual_controller/cycle_timer.hpp"
#include "metier/virtual_controller/standing_time.hpp"
#include "metier/virtual_controller/tcp_dialer.hpp"
#include "robot_application.hpp"

namespace metier::virtual_iiwa {
namespace {

using namespace virtual_controller;
using namespace std::chrono_literals;

/// Options from the settings (README.md).
struct Options {
    std::string pc_address;
    std::uint16_t pc_port = 12225;
    Precision precision = Precision::single_precision;
    bool redial = true;
    double redial_delay = 1.0;    ///< [s]
    double answer_delay = 0.002;  ///< [s]
    double force_noise = 0.0;     ///< standard deviation [N], [Nm]
    double torque_noise = 0.0;    ///< standard deviation of the axes' torque [Nm]
    motion::JointVector start;    ///< joint position when power comes [rad]
};

constexpr std::size_t kAxes = 7;
// Largest number of bytes that a PC may send while the application is busy; more ends the
// application.
constexpr std::size_t kLongestBacklog = 65'536;

Options readOptions(const ControllerRequest& request) {
    const auto& settings = request.settings;
    Options options;
    options.pc_address = settings.textOr("pc_address", request.address);
    options.pc_port = static_cast<std::uint16_t>(settings.numberOr("pc_port", 12225, 1, 65535));
    options.precision = settings.flagOr("double_precision", false) ? Precision::double_precision
                                                                   : Precision::single_precision;
    options.redial = settings.flagOr("redial", true);
    options.redial_delay = settings.numberOr("redial_delay", options.redial_delay, 0.001, 3600.0);
    options.answer_delay = settings.numberOr("answer_delay", options.answer_delay, 0.0, 1.0);
    options.force_noise = settings.numberOr("force_noise", 0.0, 0.0, 100.0);
    options.torque_noise = settings.numberOr("torque_noise", 0.0, 0.0, 100.0);
    const auto& home = request.model->home();
    const auto start = settings.numbersOr("start_position", {home.begin(), home.end()}, kAxes);
    options.start = motion::JointVector::from(start).value_or(home);
    if (options.start.size() != kAxes || !request.model->kinematics().withinLimits(options.start)) {
        settings.reject("start_position", "is not within the joint limits");
        options.start = home;
    }
    return options;
}

int toCycles(double seconds) {
    return static_cast<int>(std::lround(seconds / kCycleSeconds));
}

/// A Sunrise cabinet whose robot application connects to the PC.
class IiwaController final : public Controller {
public:
    IiwaController(const ControllerRequest& request, Options options);
    /// Makes the dialer, which connects to the PC. Errors: those of TcpDialer::create().
    Result<void> dial(const ControllerRequest& request);

    std::vector<InjectionHelp> injections() const override { return injections_; }
    nlohmann::ordered_json state() const override;
    void restart() override;

private:
    std::vector<InjectionHelp> makeInjections();
    void failMotion();
    void connected(TcpPeer& peer);
    void received(std::span<const std::byte> bytes);
    void takeCommands();
    void answer();
    void endApplication();
    /// Errors: invalid_argument, no mode of a cabinet.
    Result<void> selectMode(const std::string& mode);
    void redialLater();
    void cycle();
    void stepArm();
    void stepAnswer();

    const Options options_;
    const std::vector<InjectionHelp> injections_ = makeInjections();
    WorldLink& world_;
    Cabinet cabinet_;
    double time_ = 0.0;  ///< the cabinet's own, by its cycles [s]
    std::optional<RobotApplication> application_;
    TcpPeer* pc_ = nullptr;
    std::vector<std::byte> received_;  // not yet read by the application
    std::optional<RobotApplication::Answer> due_;
    int answer_cycles_ = 0;  // cycles until the answer is sent
    int redial_cycles_ = 0;  // cycles until the next connection attempt; 0: none
    bool silent_ = false;
    std::uint64_t answers_ = 0;
    std::string last_failure_;
    std::mt19937 random_{1};
    std::normal_distribution<double> normal_;
    std::unique_ptr<TcpDialer> dialer_;
    StandingTime standing_;
    CycleTimer timer_;
};

IiwaController::IiwaController(const ControllerRequest& request, Options options)
    : options_(std::move(options)),
      world_(request.world),
      cabinet_{.arm = Arm(*request.model, options_.start),
               .torque_noise = motion::JointVector(kAxes)},
      timer_(request.context, 1ms, [this] { cycle(); }) {}

Result<void> IiwaController::dial(const ControllerRequest& request) {
    METIER_ASSIGN(
        dialer_,
        TcpDialer::create(request.context, {request.address, options_.pc_address, options_.pc_port},
                          request.faults,
                          {.peer = {.on_connected = [this](TcpPeer& peer) { connected(peer); },
                                    .on_data =
                                        [this](TcpPeer& peer, std::span<const std::byte> bytes) {
                                            if (&peer == pc_) {
                                                received(bytes);
                                            }
                                        },
                                    .on_closed =
                                        [this](TcpPeer& peer) {
                                            if (&peer == pc_) {
                                                pc_ = nullptr;
                                                endApplication();
                                            }
                                        }},
                           .on_failed = [this](const Error& error) {
                               last_failure_ = error.message;
                               redialLater();
                           }}));
    dialer_->dial();
    return {};
}

// ---- the robot application ---------------------------------------------------------------------

void IiwaController::connected(TcpPeer& peer) {
    pc_ = &peer;
    last_failure_.clear();
    received_.clear();
    due_.reset();
    silent_ = false;
    application_.emplace(cabinet_);
}

void IiwaController::received(std::span<const std::byte> bytes) {
    if (received_.size() + bytes.size() > kLongestBacklog) {
        endApplication();
        return;
    }
    received_.insert(received_.end(), bytes.begin(), bytes.end());
    takeCommands();
}

void IiwaController::takeCommands() {
    const auto size = commandSize(options_.precision);
    while (application_ && !due_ && !silent_ && !received_.empty()) {
        // One read call: what comes in parts is not put together.
        if (received_.size() < size) {
            endApplication();
            return;
        }
        const auto command = decodeCommand(std::span(received_).first(size), options_.precision);
        received_.erase(received_.begin(), received_.begin() + static_cast<std::ptrdiff_t>(size));
        const auto wanted = application_->execute(command);
        if (wanted == RobotApplication::Answer::application_ends) {
            endApplication();
            return;
        }
        due_ = wanted;
        answer_cycles_ = toCycles(options_.answer_delay);
        if (answer_cycles_ == 0 && !application_->waiting()) {
            answer();
        }
    }
}

void IiwaController::answer() {
    ++answers_;
    silent_ = *due_ == RobotApplication::Answer::then_no_more;
    due_.reset();
    pc_->send(encodeState(application_->state(), options_.precision));
}

void IiwaController::endApplication() {
    cabinet_.arm.brake(Arm::End::cancelled);
    application_.reset();
    received_.clear();
    due_.reset();
    if (auto* pc = std::exchange(pc_, nullptr)) {
        pc->close();
    } else {
        dialer_->reset();
    }
    redialLater();
}

void IiwaController::redialLater() {
    redial_cycles_ = options_.redial ? std::max(1, toCycles(options_.redial_delay)) : 0;
}

// ---- one cycle ---------------------------------------------------------------------------------

void IiwaController::cycle() {
    stepArm();
    stepAnswer();
    if (redial_cycles_ > 0 && --redial_cycles_ == 0) {
        dialer_->dial();
    }
}

void IiwaController::stepArm() {
    cabinet_.wrench = world_.effect().wrench;
    for (Eigen::Index i = 0; i < 3; ++i) {
        cabinet_.wrench.force[i] += options_.force_noise * normal_(random_);
        cabinet_.wrench.torque[i] += options_.torque_noise * normal_(random_);
    }
    for (double& noise : cabinet_.torque_noise) {
        noise = options_.torque_noise * normal_(random_);
    }
    const auto end = cabinet_.arm.step();
    if (application_) {
        application_->step(end);
    }
    WorldReport report;
    time_ += kCycleSeconds;
    report.time = time_;
    report.base_from_flange = cabinet_.arm.model().kinematics().forward(cabinet_.arm.position());
    world_.report(report);
    standing_.take(cabinet_.arm.position().span(), std::chrono::steady_clock::now());
}

void IiwaController::stepAnswer() {
    if (!due_ || application_->waiting()) {
        return;
    }
    if (--answer_cycles_ <= 0) {
        answer();
        takeCommands();
    }
}

// ---- what people and accidents do --------------------------------------------------------------

void IiwaController::restart() {
    pc_ = nullptr;
    application_.reset();
    received_.clear();
    due_.reset();
    dialer_->reset();
    cabinet_.arm.halt();
    cabinet_.emergency_stop = false;
    cabinet_.enabled = true;
    cabinet_.limit_violated = false;
    redialLater();
}

std::vector<InjectionHelp> IiwaController::makeInjections() {
    return {
        {"emergency-stop", "the button is pressed: the motion ends, the robot is not ready",
         always([this] {
             cabinet_.emergency_stop = true;
             cabinet_.arm.brake(Arm::End::cancelled);
         })},
        {"release-emergency-stop", "the button is released",
         always([this] { cabinet_.emergency_stop = false; })},
        {"protective-stop", "the motion fails: error -14, -13 if it is synchronous",
         always([this] { failMotion(); })},
        {"limit", "an axis is beyond its limit: the motion fails; not ready until `ready`",
         always([this] {
             cabinet_.limit_violated = true;
             failMotion();
         })},
        {"not-ready", "the enabling signal goes: the motion ends; not ready until `ready`",
         always([this] {
             cabinet_.enabled = false;
             cabinet_.arm.brake(Arm::End::cancelled);
         })},
        {"ready", "ends `limit` and `not-ready`", always([this] {
             cabinet_.enabled = true;
             cabinet_.limit_violated = false;
         })},
        {"operating-mode", "AUT, T1 or T2: another one ends the motion; ready in AUT only",
         [this](const std::string& mode) { return selectMode(mode); }},
        {"end-application", "the robot application ends, as by the operator's key",
         always([this] { endApplication(); })},
    };
}

void IiwaController::failMotion() {
    if (application_) {
        application_->fail();
    }
    cabinet_.arm.brake(Arm::End::failed);
}

/// Selects a mode. The enabling switch is never pressed, so T1 and T2 allow no motion.
Result<void> IiwaController::selectMode(const std::string& mode) {
    if (mode != "AUT" && mode != "T1" && mode != "T2") {
        return fail(Errc::invalid_argument,
                    fmt::format("operating-mode: \"{}\" is not one of AUT, T1, T2", mode));
    }
    cabinet_.automatic = mode == "AUT";
    cabinet_.arm.brake(Arm::End::cancelled);
    return {};
}

nlohmann::ordered_json IiwaController::state() const {
    const auto& arm = cabinet_.arm;
    const auto velocity = arm.velocity();
    nlohmann::ordered_json state{
        {"pc", pc_ == nullptr ? "" : pc_->address()},
        {"last_failure", last_failure_},
        {"answers", answers_},
        {"ready", cabinet_.ready()},
        {"emergency_stop", cabinet_.emergency_stop},
        {"moving", arm.moving()},
        {"joint_position", std::vector(arm.position().begin(), arm.position().end())},
        {"joint_velocity", std::vector(velocity.begin(), velocity.end())},
    };
    standing_.show(state, std::chrono::steady_clock::now());
    if (application_) {
        state["error_code"] = static_cast<int>(application_->error());
        state["condition_fired"] = application_->conditionFired();
        state["servo"] = application_->servo();
        state["synchronous"] = application_->synchronous();
        state["motion_type"] = application_->motionType();
        state["control_mode"] = application_->controlMode();
        state["impedance_settings"] = application_->impedance().size();
    }
    return state;
}

Result<std::unique_ptr<Controller>> start(const ControllerRequest& request) {
    if (request.model == nullptr || request.model->axisCount() != kAxes) {
        return fail(Errc::invalid_argument,
                    request.name + ": an iiwa needs the model of an arm with 7 axes");
    }
    auto options = readOptions(request);
    METIER_TRY(request.settings.finish());
    auto controller = std::make_unique<IiwaController>(request, std::move(options));
    METIER_TRY(controller->dial(request));
    return controller;
}

}  // namespace
}  // namespace metier::virtual_iiwa

namespace metier::virtual_controller {

ControllerType iiwaController();
ControllerType iiwaController() {
    return {"iiwa", "KUKA LBR iiwa: a cabinet whose robot application (libiiwa) dials the PC",
            virtual_iiwa::start};
}

}  // namespace metier::virtual_controller
