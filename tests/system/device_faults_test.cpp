// Each arm on its maker's wire: it moves, and whatever happens to its controller or its cable ends
// in a named state, within a stated time, with a way back.
#include <gmock/gmock.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <ostream>

#include "metier/base/queue.hpp"
#include "metier_program.hpp"
#include "running_cell.hpp"

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;
using skill::Reason;
using skill::State;
using ::testing::HasSubstr;

// The cell files allow a silence of 0.3 s; the rest is for a computer that runs other tests.
constexpr auto kNoticed = 2s;

struct ArmCase {
    const char* name;        ///< of its file in tests/system/devices
    double axis_1;           ///< of a long move [rad]
    const char* stop_fault;  ///< what its controller stops the arm for
    /// What the arm does when the cable is cut. An iiwa's cabinet does not notice, and ends the
    /// motion that it has accepted (docs/protocols/iiwa.md).
    enum class Cut { stands, goes_on } cut = Cut::stands;
};

void PrintTo(const ArmCase& arm, std::ostream* out) {
    *out << arm.name;
}

class ArmOnItsWire : public ::testing::TestWithParam<ArmCase> {
protected:
    ArmOnItsWire() {
        skill_.onTransition(
            [this](const skill::TransitionEvent& event) { events_.tryPush(event); });
    }
    ~ArmOnItsWire() override { skill_.onTransition({}); }

    /// Starts a move of axis 1 that takes some seconds, and waits until the controller moves.
    void startLongMove() {
        auto target = home_;
        target.front() += GetParam().axis_1;
        ASSERT_TRUE(skill_.set("TargetJointPosition", target));
        ASSERT_TRUE(skill_.set("SpeedOverride", 0.2));
        const auto started = skill_.start();
        ASSERT_TRUE(started) << started.error().message;
        const auto deadline = inAMinute();
        while (std::abs(position() - home_.front()) < 0.02) {
            ASSERT_LT(std::chrono::steady_clock::now(), deadline) << "the arm does not move";
        }
    }

    /// Of axis 1, as the virtual controller has it [rad].
    double position() const {
        const auto state = nlohmann::json::parse(cell_.state("controller"));
        return state.at("joint_position").at(0).get<double>();
    }

    /// The end of the move, which must come in time.
    skill::TransitionEvent endWithin(std::chrono::milliseconds time) {
        const auto deadline = std::chrono::steady_clock::now() + time;
        while (const auto event = events_.popUntil(deadline)) {
            if (event->to == State::halted || event->to == State::ready) {
                return *event;
            }
        }
        ADD_FAILURE() << "the move did not end in time";
        return {};
    }

    /// The arm rests, short of the target.
    void expectAtRestOnTheWay() const {
        const auto before = position();
        const auto deadline = std::chrono::steady_clock::now() + kNoticed;
        auto now = position();
        for (auto last = before; std::abs((now = position()) - last) > 1e-6; last = now) {
            ASSERT_LT(std::chrono::steady_clock::now(), deadline) << "the arm still moves";
        }
        EXPECT_LT(std::abs(now - home_.front()), 0.95 * std::abs(GetParam().axis_1));
    }

    void expectResetAndMove() {
        const auto deadline = inAMinute();
        auto reset = skill_.reset();
        while (!reset && std::chrono::steady_clock::now() < deadline) {
            reset = skill_.reset();
        }
        ASSERT_TRUE(reset) << reset.error().message;
        const auto moved = skill_.run({{"TargetJointPosition", home_}}, inAMinute());
        EXPECT_TRUE(moved) << moved.error().message;
    }

    Queue<skill::TransitionEvent> events_{100};
    RunningCell cell_{deviceCell(GetParam().name)};
    std::unique_ptr<opcua::Client> client_ = connectTo(cell_.url("arm"));
    skill_client::SkillHandle skill_ = openSkill(*client_, "JointPtpMoveSkill");
    std::vector<double> home_ = jointPosition(*client_, skill_);
};

TEST_P(ArmOnItsWire, MovesAlongALine) {
    auto line = openSkill(*client_, "CartesianLinearMoveSkill");
    for (const double x : {0.05, -0.05}) {
        const auto moved = line.run(
            {{"TargetPosition", skill::Frame{x, 0, 0, 0, 0, 0}}, {"Relative", 1}}, inAMinute());
        ASSERT_TRUE(moved) << moved.error().message;
    }
    const auto now = jointPosition(*client_, skill_);
    for (std::size_t axis = 0; axis < now.size(); ++axis) {
        EXPECT_NEAR(now[axis], home_[axis], 2e-3) << "axis " << axis + 1;
    }
}

TEST_P(ArmOnItsWire, IsSuspendedAndResumed) {
    startLongMove();
    ASSERT_TRUE(skill_.suspend());
    ASSERT_TRUE(skill_.awaitState(State::suspended, inAMinute()));
    expectAtRestOnTheWay();
    ASSERT_TRUE(skill_.resume());
    EXPECT_EQ(endWithin(60s).to, State::ready);
    EXPECT_NEAR(position(), home_.front() + GetParam().axis_1, 2e-3);
}

TEST_P(ArmOnItsWire, HaltsOnTheWay) {
    startLongMove();
    ASSERT_TRUE(skill_.halt());
    const auto halted = endWithin(kNoticed);
    EXPECT_EQ(halted.to, State::halted);
    EXPECT_EQ(halted.reason, Reason::by_client);
    expectAtRestOnTheWay();
    expectResetAndMove();
}

TEST_P(ArmOnItsWire, IsHaltedByACutCableAndComesBack) {
    startLongMove();
    cell_.inject("controller", "cut-link");
    const auto halted = endWithin(kNoticed);
    EXPECT_EQ(halted.to, State::halted);
    EXPECT_EQ(halted.reason, Reason::device_lost);
    EXPECT_THAT(halted.reason_text, HasSubstr("arm")) << "names the device";
    if (GetParam().cut == ArmCase::Cut::stands) {
        expectAtRestOnTheWay();
    }
    EXPECT_FALSE(skill_.reset()) << "nobody is there to agree";
    cell_.inject("controller", "restore-link");
    expectResetAndMove();
}

TEST_P(ArmOnItsWire, IsHaltedFromReadyByACutCable) {
    cell_.inject("controller", "cut-link");
    ASSERT_TRUE(skill_.awaitState(State::halted, std::chrono::steady_clock::now() + kNoticed));
    const auto refused = skill_.start();
    EXPECT_FALSE(refused);
    cell_.inject("controller", "restore-link");
    expectResetAndMove();
}

TEST_P(ArmOnItsWire, IsHaltedByARestartOfItsController) {
    startLongMove();
    cell_.inject("controller", "restart");
    const auto halted = endWithin(kNoticed);
    EXPECT_EQ(halted.to, State::halted);
    EXPECT_EQ(halted.reason, Reason::device_lost) << halted.reason_text;
    home_ = jointPosition(*client_, skill_);
    expectResetAndMove();
}

TEST_P(ArmOnItsWire, IsHaltedByAnEmergencyStop) {
    startLongMove();
    cell_.inject("controller", "emergency-stop");
    const auto halted = endWithin(kNoticed);
    EXPECT_EQ(halted.to, State::halted);
    EXPECT_EQ(halted.reason, Reason::error) << halted.reason_text;
    EXPECT_NE(halted.reason_text, "");
    expectAtRestOnTheWay();
    EXPECT_FALSE(skill_.reset()) << "the button is still pressed";
}

TEST_P(ArmOnItsWire, IsHaltedByAStopOfItsControllerAndComesBack) {
    startLongMove();
    cell_.inject("controller", GetParam().stop_fault);
    const auto halted = endWithin(kNoticed);
    EXPECT_EQ(halted.to, State::halted);
    EXPECT_NE(halted.reason_text, "");
    expectAtRestOnTheWay();
    expectResetAndMove();
}

INSTANTIATE_TEST_SUITE_P(
    Devices, ArmOnItsWire,
    ::testing::Values(ArmCase{"ur5", 1.0, "protective-stop"},
                      ArmCase{"iiwa", 1.0, "protective-stop", ArmCase::Cut::goes_on},
                      ArmCase{"edo", 0.6, "brake"}, ArmCase{"edo_classic", 0.6, "brake"}),
    [](const auto& arm) { return std::string(arm.param.name); });

/// A gripper on its maker's wire.
class GripperOnItsWire : public ::testing::Test {
protected:
    void SetUp() override { resetAll(); }

    /// Makes both skills ready: Reset acknowledges the gripper's fault and homes it.
    void resetAll() {
        const auto deadline = inAMinute();
        for (auto* skill : {&grasp_, &release_}) {
            while (*skill->state() != State::ready && !skill->reset()) {
                ASSERT_LT(std::chrono::steady_clock::now(), deadline) << skill->reasonText();
            }
        }
    }

    RunningCell cell_{deviceCell("wsg50")};
    std::unique_ptr<opcua::Client> client_ = connectTo(cell_.url("gripper"));
    skill_client::SkillHandle grasp_ = openSkill(*client_, "GraspGripperSkill");
    skill_client::SkillHandle release_ = openSkill(*client_, "ReleaseGripperSkill");
};

TEST_F(GripperOnItsWire, HoldsAPartAndLetsItGo) {
    cell_.inject("controller", "part", "30");
    const auto held = grasp_.run({{"Force", 40.0}}, inAMinute());
    ASSERT_TRUE(held) << held.error().message;
    EXPECT_EQ(held->at("PartHeld"), skill::Value(true));
    EXPECT_NEAR(std::get<double>(held->at("WidthReached")), 0.03, 2e-3);
    const auto released = release_.run({}, inAMinute());
    ASSERT_TRUE(released) << released.error().message;
    EXPECT_EQ(released->at("PartHeld"), skill::Value(false));
}

TEST_F(GripperOnItsWire, SaysThatThereIsNoPart) {
    const auto missed = grasp_.run({}, inAMinute());
    ASSERT_FALSE(missed);
    EXPECT_THAT(missed.error().message, HasSubstr("no part"));
    EXPECT_EQ(*grasp_.state(), State::halted);
    resetAll();
    EXPECT_TRUE(release_.run({}, inAMinute()));
}

TEST_F(GripperOnItsWire, IsHaltedByACutCableAndComesBack) {
    cell_.inject("controller", "cut-link");
    ASSERT_TRUE(grasp_.awaitState(State::halted, std::chrono::steady_clock::now() + kNoticed));
    cell_.inject("controller", "restore-link");
    resetAll();
    EXPECT_TRUE(release_.run({}, inAMinute()));
}

}  // namespace
}  // namespace metier::system_tests
