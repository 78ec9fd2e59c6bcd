#include <gtest/gtest.h>

#include "metier/base/testing/allocation_count.hpp"
#include "metier/motion/frame.hpp"
#include "motion_commander.hpp"
#include "scripted_cabinet.hpp"

namespace metier::iiwa_driver {
namespace {

using namespace std::chrono_literals;
using Next = device::SetPointSource::Next;

/// A cabinet without a socket, whose arm is at each set-point at once.
class Echo {
public:
    Echo() {
        state_.position = device::JointArray(std::span(ScriptedCabinet::kHome));
        state_.velocity = device::JointArray(kAxes);
        state_.ready = true;
    }
    CabinetState answer(const Command& command, const motion::RobotModel& model) {
        state_.executed = command.code != Code::state;
        if (command.code == Code::move_joints) {
            std::copy_n(command.arguments.begin(), kAxes, state_.position.begin());
        }
        motion::JointVector joints(kAxes);
        std::copy_n(state_.position.begin(), kAxes, joints.begin());
        const auto pose = model.kinematics().forward(joints);
        state_.pose = motion::toFrame(pose);
        return state_;
    }

private:
    CabinetState state_;
};

class TurningSource final : public device::SetPointSource {
public:
    Next next(const device::ArmState& /*state*/, device::JointArray& set_point) noexcept override {
        set_point[0] += 1e-3;
        return Next::set_point;
    }
    void ended(device::EndCause /*cause*/, const device::Safety& /*safety*/) override {}
};

class CycleOfTheMotionCommander : public ::testing::Test {
protected:
    CycleOfTheMotionCommander() {
        commander.connected(echo.answer({}, model), now);
        cycles(10);
        EXPECT_EQ(commander.core().safetyState(), device::SafetyState::normal);
    }

    /// \return the allocations of so many cycles
    std::size_t cycles(int count) {
        const auto before = allocationCount();
        for (int i = 0; i < count; ++i) {
            now += 10ms;
            const auto command = commander.command();
            const auto bytes = encode(command, Precision::float32);
            static_cast<void>(bytes);
            commander.take(command, echo.answer(command, model), now);
        }
        return allocationCount() - before;
    }

    const motion::RobotModel model = iiwa7();
    MotionCommander commander{{"iiwa", std::vector<std::string>(kAxes, "A"), 10ms}, model, {}};
    Echo echo;
    SteadyTime now{};
};

TEST_F(CycleOfTheMotionCommander, DoesNotAllocateWhileItStreams) {
    ASSERT_TRUE(commander.attach(std::make_shared<TurningSource>()));
    EXPECT_EQ(cycles(1000), 0U);
    EXPECT_NEAR(commander.core().state().position[0], 1.0, 0.1);
    commander.core().stop();
    EXPECT_EQ(cycles(20), 0U);
    EXPECT_TRUE(commander.toTell());
}

TEST_F(CycleOfTheMotionCommander, DoesNotAllocateWhileItIdles) {
    EXPECT_EQ(cycles(1000), 0U);
}

TEST_F(CycleOfTheMotionCommander, DoesNotAllocateDuringAPlannedMotion) {
    device::ControllerPlannedMotion motion;
    motion.target_joints = device::JointArray(std::span(ScriptedCabinet::kHome));
    motion.target_joints[1] = 0.9;
    bool done = false;
    ASSERT_TRUE(commander.move(motion, [&](const auto& outcome) { done = outcome.has_value(); }));
    EXPECT_EQ(cycles(100), 0U);
    commander.dispatch();
    EXPECT_TRUE(done);
}

}  // namespace
}  // namespace metier::iiwa_driver
