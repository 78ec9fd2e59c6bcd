// Moves of an iiwa on its own wire, against its virtual cabinet: run by the cabinet's planner or by
// metier's set-points, each is the move that was asked for.
#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ostream>

#include "metier/iiwa_driver/iiwa_arm.hpp"
#include "metier/robot_skills/arm_skills.hpp"
#include "metier/skill/program.hpp"
#include "metier/skill/testing/manual_executor.hpp"
#include "metier/virtual_controller/testing/running_controller.hpp"

namespace metier::virtual_controller {
ControllerType iiwaController();
}  // namespace metier::virtual_controller

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;
using skill::Frame;
using skill::State;
using skill::ValueMap;
using skill::Vector3;

constexpr const char* kPtp = "JointPtpMoveSkill";
constexpr const char* kLine = "CartesianLinearMoveSkill";
constexpr const char* kForceMove = "CartesianLinearForceMoveSkill";

/// An iiwa 7 with a tool that sticks out to the side, 15 cm from the flange.
motion::RobotModel armWithTool() {
    auto chain = motion::RobotModel::load(METIER_MODELS_DIR "/iiwa7.toml").value().chain();
    motion::ToolFrame tool;
    tool.name = "pen";
    tool.flange_from_tool.translation = {0.05, 0.0, 0.15};
    chain.tools.push_back(tool);
    return motion::RobotModel::fromChain(std::move(chain)).value();
}

class IiwaMoves : public ::testing::Test {
protected:
    IiwaMoves() {
        auto skills = robot_skills::makeArmSkills(
                          {.arm = *arm_, .planner = arm_.get(), .sensor = &arm_->flangeForce()},
                          model_, clock_)
                          .value();
        skill::ProgramOptions options;
        options.resource = skills.resource;
        for (auto& skill : skills.moves) {
            const auto name = skill->description().name;
            programs_[name] =
                std::make_unique<skill::Program>(options, std::move(skill), executor_, clock_);
        }
        EXPECT_TRUE(cabinet_.waitUntil([&](const auto&) { return isReady(); }, kPatience));
    }

    bool isReady() { return arm_->safety().state == device::SafetyState::normal; }
    skill::Program& program(const std::string& skill) { return *programs_.at(skill); }
    Result<void> start(const std::string& skill, const ValueMap& values) {
        for (const auto& [name, value] : values) {
            if (auto written = program(skill).write(caller_, name, value); !written) {
                return written;
            }
        }
        return program(skill).start(caller_);
    }
    bool becomes(const std::string& skill, State state) {
        return executor_->runUntil([&] { return program(skill).state() == state; }, kPatience);
    }
    /// Starts it and waits for its end; what went wrong, if anything did.
    std::string run(const std::string& skill, const ValueMap& values) {
        if (const auto started = start(skill, values); !started) {
            return started.error().message;
        }
        executor_->runUntil([&] { return program(skill).state() != State::running; }, kPatience);
        return program(skill).state() == State::ready ? "" : program(skill).reasonText();
    }
    double number(const std::string& skill, const std::string& result) {
        return std::get<double>(program(skill).finalResult().at(result));
    }
    /// Time from the first to the last set-point [s].
    double between(const std::string& skill) {
        return number(skill, "MotionEndTime") - number(skill, "MotionStartTime");
    }
    /// Speed of the fastest axis [rad/s].
    double speed() {
        double fastest = 0.0;
        const auto state = cabinet_.state();
        for (const double velocity : state.at("joint_velocity")) {
            fastest = std::max(fastest, std::abs(velocity));
        }
        return fastest;
    }
    bool awaitSpeed(double least) {
        return cabinet_.waitUntil(
            [&](const auto&) {
                executor_->run();
                return speed() > least;
            },
            kPatience);
    }
    /// Time from the request until standstill is published [s].
    double timeToRest(const std::string& skill, State rest) {
        const auto asked = std::chrono::steady_clock::now();
        EXPECT_TRUE(rest == State::halted ? program(skill).halt(caller_)
                                          : program(skill).suspend(caller_));
        EXPECT_TRUE(becomes(skill, rest)) << program(skill).reasonText();
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - asked;
        EXPECT_LT(speed(), 5e-3) << "below this the driver takes the arm for standing";
        return took.count();
    }

    static constexpr std::chrono::milliseconds kPatience = 60s;

    const motion::RobotModel model_ = armWithTool();
    const SystemClock clock_;
    const skill::Caller caller_{"session", "client", "user"};
    std::unique_ptr<iiwa_driver::IiwaArm> arm_ =
        iiwa_driver::IiwaArm::create({.port = 0, .answer_timeout = 2s}, model_).value();
    virtual_controller::testing::RunningController cabinet_{
        virtual_controller::iiwaController(),
        {.settings = {{"pc_port", static_cast<double>(arm_->port())}, {"redial_delay", 0.02}},
         .model = &model_}};
    // Shared with the Programs, as they ask for.
    std::shared_ptr<skill::testing::ManualExecutor> executor_ =
        std::make_shared<skill::testing::ManualExecutor>();
    std::map<std::string, std::unique_ptr<skill::Program>> programs_;
};

const ValueMap kTurn{{"TargetJointPosition", std::vector<double>{0.3, 0, 0, 0, 0, 0, 0}},
                     {"Relative", std::int32_t{1}}};
const ValueMap kTurnBack{{"TargetJointPosition", std::vector<double>{-0.3, 0, 0, 0, 0, 0, 0}},
                         {"Relative", std::int32_t{1}}};
const ValueMap kUp{{"TargetPosition", Frame{0, 0, 0.1}}, {"Relative", std::int32_t{1}}};
const ValueMap kDown{{"TargetPosition", Frame{0, 0, -0.1}}, {"Relative", std::int32_t{1}}};
// Times and paths are measured: one round of so many is not held up by the machine's other work.
constexpr int kRounds = 5;

ValueMap with(ValueMap values, const ValueMap& more) {
    values.insert(more.begin(), more.end());
    return values;
}

TEST_F(IiwaMoves, ADurationIsWhatAMoveTakes) {
    constexpr double turning = 4.0;  // [s]
    for (int round = 0; round < kRounds; ++round) {
        EXPECT_EQ(run(kPtp, with(round % 2 == 0 ? kTurn : kTurnBack, {{"Duration", turning}})), "");
        if (std::abs(number(kPtp, "Duration") - turning) < 0.05) {
            break;
        }
    }
    EXPECT_NEAR(number(kPtp, "Duration"), turning, 0.05);
    constexpr double rising = 3.0;  // [s]
    for (int round = 0; round < kRounds; ++round) {
        EXPECT_EQ(run(kLine, with(round % 2 == 0 ? kUp : kDown, {{"Duration", rising}})), "");
        if (std::abs(number(kLine, "Duration") - rising) < 0.05 &&
            std::abs(between(kLine) - rising) < 0.2) {
            break;
        }
    }
    EXPECT_NEAR(number(kLine, "Duration"), rising, 0.05);
    EXPECT_NEAR(between(kLine), rising, 0.2);
}

TEST_F(IiwaMoves, ALineOfAToolBesideTheFlangeMayTurn) {
    // A line of the flange would lead the tool 12 mm beside its own. The servo interface lets each
    // axis lag by itself, the more the faster it is.
    const auto begin = arm_->state().position;
    const ValueMap back{{"TargetJointPosition", std::vector<double>(begin.begin(), begin.end())}};
    for (int round = 0; round < kRounds; ++round) {
        EXPECT_EQ(run(kLine, {{"TargetPosition", Frame{0, 0, -0.05, 0.0, 0.8, 0}},
                              {"Relative", std::int32_t{2}},
                              {"ToolFrame", std::string("pen")},
                              {"MaxVelocity", std::vector<double>{.1, .1, .1, .2, .2, .2}}}),
                  "");
        if (number(kLine, "LargestPathDeviation") < 2e-3) {
            break;
        }
        EXPECT_EQ(run(kPtp, back), "");
    }
    EXPECT_LT(number(kLine, "LargestPathDeviation"), 2e-3);
}

TEST_F(IiwaMoves, TheElbowMayTurnOnALine) {
    EXPECT_EQ(run(kLine, with(kUp, {{"RedundancyAngle", 0.1745}})), "");
    const auto reached = arm_->state().position;
    const auto end = motion::JointVector::from(reached.values()).value();
    EXPECT_NEAR(model_.kinematics().redundancyAngle(end), 0.1745, 5e-3);
    EXPECT_EQ(run(kLine, kUp), "") << "and then the cabinet's planner goes on";
}

TEST_F(IiwaMoves, AForceEndsALineWhicheverWayTheFlangeIsTurned) {
    ASSERT_EQ(run(kPtp, {{"TargetJointPosition", std::vector<double>{0, 0, 0, 0, 0, 0.4, 0.5}},
                         {"Relative", std::int32_t{1}}}),
              "");
    virtual_controller::WorldEffect wall;
    const auto pose = model_.kinematics().forward(
        motion::JointVector::from(arm_->state().position.values()).value());
    wall.wrench.force = pose.rotation.inverse() * Eigen::Vector3d(0, 0, 40);
    ASSERT_TRUE(start(kForceMove, {{"TargetPosition", Frame{0, 0, -0.1}},
                                   {"Relative", std::int32_t{1}},
                                   {"Duration", 5.0},
                                   {"MaxForce", Vector3{0, 0, 20}}}));
    ASSERT_TRUE(awaitSpeed(0.01));
    cabinet_.setEffect(wall);
    ASSERT_TRUE(becomes(kForceMove, State::ready)) << program(kForceMove).reasonText();
    const auto exceeded = std::get<Vector3>(program(kForceMove).finalResult().at("ForcesExceeded"));
    EXPECT_NEAR(exceeded.z, 40.0, 0.5);
    EXPECT_NEAR(exceeded.x, 0.0, 0.5);
    EXPECT_LT(number(kForceMove, "Duration"), 4.0);
}

// ---- stopping ----------------------------------------------------------------------------------

/// A move that is slow for one reason or another.
struct SlowMove {
    const char* name;
    const char* skill;
    ValueMap values;
    double speed;  ///< speed of the fastest axis at which it is stopped [rad/s]
};

void PrintTo(const SlowMove& move, std::ostream* out) {
    *out << move.name;
}

class SlowIiwaMoves : public IiwaMoves, public ::testing::WithParamInterface<SlowMove> {};

TEST_P(SlowIiwaMoves, StopAsFastAsTheArmCan) {
    const auto& move = GetParam();
    constexpr double longest = 0.5;  // [s]
    double suspended = 1e9;
    double halted = 1e9;
    for (int round = 0; round < kRounds && (suspended >= longest || halted >= longest); ++round) {
        ASSERT_TRUE(round == 0 ||
                    executor_->runUntil(
                        [&] { return program(move.skill).reset(caller_).has_value(); }, kPatience));
        ASSERT_TRUE(start(move.skill, move.values));
        ASSERT_TRUE(awaitSpeed(move.speed));
        suspended = std::min(suspended, timeToRest(move.skill, State::suspended));
        ASSERT_TRUE(program(move.skill).resume(caller_));
        ASSERT_TRUE(awaitSpeed(move.speed));
        halted = std::min(halted, timeToRest(move.skill, State::halted));
    }
    RecordProperty("suspended_after_s", std::to_string(suspended));
    RecordProperty("halted_after_s", std::to_string(halted));
    // The arm itself stops from such a speed in 20 ms; the rest is the wire's, and a busy
    // computer's.
    EXPECT_LT(suspended, longest);
    EXPECT_LT(halted, longest);
}

INSTANTIATE_TEST_SUITE_P(Reasons, SlowIiwaMoves,
                         ::testing::Values(SlowMove{"ptp_at_a_low_speed", kPtp,
                                                    with(kTurn, {{"SpeedOverride", 0.02}}), 0.02},
                                           SlowMove{"line_at_a_low_speed", kLine,
                                                    with(kUp, {{"SpeedOverride", 0.02}}), 0.02}),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace metier::system_tests
