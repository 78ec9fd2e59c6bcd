// A cabinet that answers each command with whatever it likes, while motions and set-points are
// asked for: what the arm is commanded stays finite, and every motion ends.
#include <spdlog/spdlog.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "input.hpp"
#include "metier/motion/frame.hpp"
#include "metier/motion/robot_model.hpp"
#include "motion_commander.hpp"

namespace {

using namespace metier;
using namespace metier::iiwa_driver;
using fuzz::Input;

constexpr std::size_t kAxes = 7;

const motion::RobotModel& iiwa7() {
    static const auto model =
        motion::RobotModel::load(std::string(METIER_MODELS_DIR) + "/iiwa7.toml").value();
    return model;
}

class TurningSource final : public device::SetPointSource {
public:
    explicit TurningSource(double step) : step_(step) {}
    Next next(const device::ArmState& /*state*/, device::JointArray& set_point) noexcept override {
        set_point[0] += step_;
        return Next::set_point;
    }
    void ended(device::EndCause /*cause*/, const device::Safety& /*safety*/) override {}

private:
    double step_;
};

/// One connection. The input decides how far the cabinet obeys its commands.
class Dialogue {
public:
    Dialogue() {
        state_.position = device::JointArray(kAxes);
        state_.velocity = device::JointArray(kAxes);
        state_.joint_torque = device::JointArray(kAxes);
        state_.ready = true;
        state_.executed = true;
        place();
        commander_.connected(state_, now_);
    }

    void step(Input& input) {
        const auto choice = input.next();
        if (choice % 8 == 0) {
            ask(input);
        }
        const auto command = commander_.command();
        static_cast<void>(encode(command, Precision::float32));
        follow(command, input, choice);
        now_ += std::chrono::milliseconds(choice % 16 == 1 ? input.next() : 10);
        commander_.take(command, state_, now_);
        commander_.dispatch();
        check(command);
    }

    void end() {
        commander_.lost("over");
        commander_.dispatch();
        if (asked_ != reported_) {
            std::abort();
        }
    }

private:
    void ask(Input& input) {
        if (input.next() % 2 == 0) {
            static_cast<void>(
                commander_.attach(std::make_shared<TurningSource>(input.number(0.01))));
            return;
        }
        device::ControllerPlannedMotion motion;
        motion.target_joints = state_.position;
        motion.target_joints[input.next() % kAxes] = input.number(1.0);
        if (commander_.move(motion, [this](const auto&) { ++reported_; })) {
            ++asked_;
        }
    }

    void follow(const Command& command, Input& input, std::uint8_t choice) {
        if (command.code == Code::move_joints && choice % 4 != 3) {
            for (std::size_t i = 0; i < kAxes; ++i) {
                state_.position[i] = command.arguments.at(i);
            }
            place();
        }
        state_.executed = choice % 32 != 5;
        if (choice >= 200) {
            state_.ready = input.next() % 4 != 0;
            state_.active = input.next() % 2 == 0;
            state_.last_error = input.next() % 50;
            state_.force_condition_met = input.next() % 8 == 0;
            state_.position[input.next() % kAxes] = input.number(3.0);
            state_.velocity[input.next() % kAxes] = input.number(10.0);
        }
    }

    void place() {
        motion::JointVector joints(kAxes);
        std::copy_n(state_.position.begin(), kAxes, joints.begin());
        state_.pose = motion::toFrame(iiwa7().kinematics().forward(joints));
    }

    void check(const Command& command) const {
        const bool may_be_unset = command.code == Code::force_condition;  // not watched
        for (const double argument : command.arguments) {
            if (!std::isfinite(argument) && !may_be_unset) {
                std::abort();
            }
        }
        for (const double position : commander_.core().state().commanded_position) {
            if (!std::isfinite(position)) {
                std::abort();
            }
        }
    }

    SteadyTime now_{std::chrono::seconds(1000)};
    CabinetState state_;
    int asked_ = 0;
    int reported_ = 0;
    MotionCommander commander_{
        {"iiwa", std::vector<std::string>(kAxes, "A"), std::chrono::milliseconds(10)}, iiwa7(), {}};
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    constexpr int most_steps = 200;
    spdlog::set_level(spdlog::level::off);
    Input input(data, size);
    Dialogue dialogue;
    for (int count = 0; count < most_steps && !input.isEmpty(); ++count) {
        dialogue.step(input);
    }
    dialogue.end();
    return 0;
}
