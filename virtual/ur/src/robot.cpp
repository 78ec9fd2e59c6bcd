#include "robot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "metier/base/text.hpp"

namespace metier::virtual_ur {

namespace {

// Clients wait until a controller has run for 40 s before they trust it.
constexpr double kFirstSecond = 64.0;

// From the maker's list of errors: a script came while the arm is in local control.
constexpr std::int32_t kReadOnlyInterface = 210;

// Code of a stop that a program asks for; the controller's own code is not known.
constexpr int kProgramsStop = 0;

std::uint64_t masked(std::uint64_t bits, std::uint64_t mask, std::uint64_t value) {
    return (bits & ~mask) | (value & mask);
}

}  // namespace

Robot::Robot(RobotOptions options, Surroundings around)
    : options_(std::move(options)),
      around_(std::move(around)),
      rate_(std::round(1.0 / options_.arm.cycle)),
      control_mode_(options_.control),
      arm_(*options_.description.model, options_.arm),
      sockets_(around_.context, options_.address, around_.faults) {
    begin();
}

void Robot::begin() {
    state_ = {};
    control_ = {};
    asked_ = {};
    state_.cycle = static_cast<std::uint64_t>(std::llround(kFirstSecond * rate_));
    state_.timestamp = kFirstSecond;
    arm_.reset(options_.arm.start);
    arm_.setTool(motion::Pose::identity());
    modes_.emplace(options_.times, options_.power);
    published_safety_ = modes_->safetyMode();
    script_robot_.emplace(ScriptRobot::Parts{
        arm_, state_, sockets_, options_.arm.cycle,
        [this](const std::string& text) { tellText(text); },
        [this](const urscript::Popup& popup) { around_.tell(popupMessage(timeOf(state_), popup)); },
        [this] { asked_.power_down = true; }, [this] { asked_.protective_stop = true; }});
    programs_.emplace(*script_robot_, state_,
                      [this](const Bytes& message) { around_.tell(message); });
    publish();
    state_.elbow_velocity = {};  // it did not come from anywhere
}

void Robot::restart() {
    programs_.reset();
    script_robot_.reset();
    sockets_.closeAll();
    begin();
}

void Robot::cycle() {
    ++state_.cycle;
    state_.timestamp = static_cast<double>(state_.cycle) / rate_;
    modes_->step(options_.arm.cycle, arm_.standing());
    programs_->step(arm_.standing());
    doAsked();
    state_.speed_scaling = programs_->timeShare();
    if (const auto violation = arm_.cycle(state_.speed_scaling * state_.speed_slider)) {
        protectiveStop(*violation);
    }
    watchSafety();
    publish();
    around_.world.report(
        {.time = state_.timestamp,
         .base_from_flange = arm_.model().kinematics().forward(toJointVector(state_.actual_q))});
}

void Robot::doAsked() {
    const auto asked = std::exchange(asked_, {});
    if (asked.protective_stop) {
        protectiveStop({kProgramsStop, "the program asked for it"});
    }
    if (asked.power_down) {
        powerOff();
    }
}

void Robot::watchSafety() {
    if (const auto mode = modes_->safetyMode(); mode != published_safety_) {
        published_safety_ = mode;
        around_.tell(safetyModeMessage(timeOf(state_), mode));
    }
}

void Robot::inputsWritten(const std::vector<std::string>& names) {
    script_robot_->inputsWritten(names);
    const bool control = std::any_of(names.begin(), names.end(), [](const std::string& name) {
        return !name.starts_with("input_");
    });
    if (control) {
        applyControlInputs();
    }
}

void Robot::applyControlInputs() {
    auto& outputs = state_.io.digital_outputs;
    const auto shifted = [](std::uint8_t byte, unsigned by) { return std::uint64_t{byte} << by; };
    outputs =
        masked(outputs, control_.standard_digital_output_mask, control_.standard_digital_output);
    outputs = masked(outputs, shifted(control_.configurable_digital_output_mask, 8),
                     shifted(control_.configurable_digital_output, 8));
    outputs = masked(outputs, shifted(control_.tool_digital_output_mask & 3U, 16),
                     shifted(control_.tool_digital_output, 16));
    for (int i = 0; i < 2; ++i) {
        const auto index = static_cast<std::size_t>(i);
        if ((control_.standard_analog_output_mask >> i & 1U) != 0) {
            state_.io.analog_output_domains[index] = control_.standard_analog_output_type >> i & 1U;
            (void)script_robot_->setAnalogOutput(urscript::AnalogPort::standard, i,
                                                 control_.standard_analog_output[index]);
        }
    }
    if (control_.speed_slider_mask != 0) {
        state_.speed_slider = std::clamp(control_.speed_slider_fraction, 0.0, 1.0);
    }
}

bool Robot::commandsAllowed() const {
    return options_.description.series == Series::cb3 || control_mode_ == Control::remote;
}

void Robot::takeScript(std::string_view text) {
    if (!commandsAllowed()) {
        around_.tell(errorCodeMessage(timeOf(state_),
                                      {kReadOnlyInterface, 0, ErrorCode::Level::warning,
                                       "Socket is read-only when the robot is in local control"}));
        return;
    }
    if (takeCommandLine(trimmed(text))) {
        return;
    }
    if (!modes_->mayRun()) {
        tellText(fmt::format("program not started: robot mode {}, safety mode {}",
                             toText(modes_->robotMode()), toText(modes_->safetyMode())));
        return;
    }
    programs_->run(text);
}

bool Robot::takeCommandLine(std::string_view line) {
    if (line == "power on") {
        (void)powerOn();
    } else if (line == "power off") {
        powerOff();
    } else if (line == "set robotmode run") {
        (void)releaseBrakes();
    } else if (line == "set unlock protective stop") {
        (void)unlock();
    } else if (line == "stop program") {
        programs_->stop();
    } else if (line == "pause program") {
        programs_->pause();
    } else if (line == "resume program") {
        (void)play();
    } else if (line.starts_with("set speed ")) {
        double share = state_.speed_slider;
        std::from_chars(line.data() + std::string_view("set speed ").size(),
                        line.data() + line.size(), share);
        state_.speed_slider = std::isfinite(share) ? std::clamp(share, 0.0, 1.0) : 1.0;
    } else {
        return false;
    }
    return true;
}

void Robot::tellText(std::string_view text) {
    around_.tell(textMessage(timeOf(state_), text));
}

void Robot::stopEverything() {
    programs_->stop();
    if (!arm_.standing()) {
        arm_.brake();
    }
}

void Robot::powerOff() {
    stopEverything();
    modes_->powerOff();
}

void Robot::restartSafety() {
    stopEverything();
    modes_->restartSafety();
}

Result<void> Robot::play() {
    if (!modes_->mayRun()) {
        return fail(Errc::invalid_state, "the robot is not ready");
    }
    return programs_->play();
}

void Robot::showPopup(std::string text) {
    around_.tell(popupMessage(timeOf(state_), {.text = std::move(text), .title = ""}));
}

void Robot::emergencyStop() {
    stopEverything();
    modes_->emergencyStop();
}

void Robot::protectiveStop(const ArmViolation& cause) {
    if (!modes_->mayRun()) {
        return;
    }
    arm_.brake();
    modes_->protectiveStop();
    programs_->holdForSafety();
    around_.tell(errorCodeMessage(timeOf(state_), {cause.code, 0, ErrorCode::Level::violation,
                                                   "Protective stop: " + cause.text}));
}

void Robot::safeguardStop() {
    if (modes_->mayRun()) {
        arm_.brake();
        modes_->safeguardStop();
        programs_->holdForSafety();
    }
}

void Robot::enterRecovery() {
    stopEverything();
    modes_->recovery();
}

void Robot::violateSafety() {
    stopEverything();
    modes_->violation();
}

void Robot::exceedLimit(std::size_t axis) {
    protectiveStop(arm_.beyondLimit(axis));
}

}  // namespace metier::virtual_ur
