#include <gmock/gmock.h>

#include <atomic>
#include <chrono>
#include <future>
#include <memory>

#include "metier/client/async_skill.hpp"
#include "metier/client/kinematics_reader.hpp"
#include "metier/client/skill_finder.hpp"
#include "metier/client/skill_handle.hpp"
#include "metier/opcua/server.hpp"
#include "metier/opcua_skill/motion_device_system.hpp"
#include "metier/opcua_skill/skill_server.hpp"
#include "metier/skill/lambda_skill.hpp"

namespace metier::client {
namespace {

using namespace std::chrono_literals;
using skill::State;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

SteadyTime soon() {
    return std::chrono::steady_clock::now() + 30s;
}

skill::SkillDescription jointMove() {
    skill::SkillDescription description;
    description.name = "JointPtpMoveSkill";
    description.type = "JointPtpMoveSkillType";
    description.parameters = {{.name = "TargetJointPosition",
                               .type = skill::ValueType::numbers,
                               .unit = skill::kRadian,
                               .range = skill::Range{-3, 3},
                               .length = skill::LengthLimit{2, 2},
                               .default_value = std::vector<double>{0, 0}}};
    description.results = {{.name = "Duration",
                            .type = skill::ValueType::number,
                            .unit = skill::kSecond,
                            .place = skill::Place::final_result}};
    return description;
}

/// Settings of a test for the skill's behaviour.
struct Behaviour {
    std::atomic<bool> finish_at_once{true};
    std::atomic<bool> refuse{false};
    std::atomic<bool> fail{false};
    std::atomic<double> first_axis{-1};  ///< target of the last start [rad]
};

/// A server with one arm system and one skill, and a client, on loopback.
class SkillClient : public ::testing::Test {
protected:
    enum class Suspend { possible, refused };
    explicit SkillClient(Suspend suspend = Suspend::possible) : suspend_(suspend) {
        opcua::ServerOptions options;
        options.port = 0;
        options.nodesets = {"device", "robotics", "metier"};
        server_ = opcua::Server::create(options).value();
        skills_ = opcua_skill::SkillServer::create(*server_, clock_).value();
        system_ =
            opcua_skill::publishMotionDeviceSystem(server_->nodes(), {.name = "Arm",
                                                                      .description = "An arm",
                                                                      .manufacturer = "metier",
                                                                      .model = "Two axes",
                                                                      .axis_names = {"A", "B"}})
                .value();
        EXPECT_TRUE(skills_->publish(system_.skills, makeSkill()));
        EXPECT_TRUE(opcua_skill::publishKinematics(server_->nodes(), system_, kinematics(),
                                                   [] { return armState(); }));
        EXPECT_TRUE(server_->start());
        client_ = opcua::Client::connect(server_->endpointUrl()).value();
    }

    ~SkillClient() override {
        client_.reset();
        skills_.reset();
    }

    std::unique_ptr<skill::Skill> makeSkill() {
        skill::SkillFunctions functions;
        functions.check = [behaviour = behaviour_](const skill::ValueMap&) -> Result<void> {
            if (behaviour->refuse) {
                return metier::fail(Errc::unreachable, "1.2 m away, the reach is 0.8 m");
            }
            return {};
        };
        functions.start = [behaviour = behaviour_](const skill::ValueMap& snapshot,
                                                   const skill::ExecutionHandle& execution) {
            behaviour->first_axis =
                std::get<std::vector<double>>(snapshot.at("TargetJointPosition")).front();
            if (behaviour->fail) {
                execution.fail(skill::Reason::error, "axis 2 is hot: 91 °C");
            } else if (behaviour->finish_at_once) {
                execution.finish({{"Duration", 0.25}});
            }
        };
        if (suspend_ == Suspend::refused) {
            return std::make_unique<skill::LambdaSkill>(jointMove(), functions);
        }
        functions.suspend = [](const skill::ExecutionHandle& execution) -> Result<void> {
            execution.atRest();
            return {};
        };
        functions.resume = [](const skill::ExecutionHandle& execution) -> Result<void> {
            execution.finish({{"Duration", 0.5}});
            return {};
        };
        return std::make_unique<skill::LambdaSkill>(jointMove(), functions);
    }

    static opcua_skill::KinematicsData kinematics() {
        opcua_skill::KinematicsData data;
        data.joint_frames = {{}, {0.3, 0, 0, 0, 0, 0}};
        data.joint_axes = {{0, 0, 1}, {0, 1, 0}};
        data.min_joint_position = {-3, -2};
        data.max_joint_position = {3, 2};
        data.max_joint_velocity = {1, 1};
        data.max_joint_acceleration = {5, 5};
        data.max_joint_jerk = {50, 50};
        data.max_cartesian_velocity = {0.5, 1};
        data.max_cartesian_acceleration = {1, 2};
        data.max_cartesian_jerk = {10, 20};
        data.cycle_time = 0.008;
        data.tool_frames = {"flange", "gripper"};
        return data;
    }

    static opcua_skill::KinematicsState armState() {
        opcua_skill::KinematicsState state;
        state.joint_position = {0.1, -0.2};
        state.safety_state = opcua_skill::SafetyStateKind::normal;
        state.missed_cycles = 7;
        return state;
    }

    SkillHandle open() {
        auto address = findSkill(*client_, "JointPtpMoveSkill").value();
        return std::move(SkillHandle::open(*client_, std::move(address)).value());
    }

    const Suspend suspend_;
    SystemClock clock_;
    // With the skill, which lives on the server's thread.
    std::shared_ptr<Behaviour> behaviour_ = std::make_shared<Behaviour>();
    std::unique_ptr<opcua::Server> server_;
    std::unique_ptr<opcua_skill::SkillServer> skills_;
    opcua_skill::MotionDeviceSystem system_;
    std::unique_ptr<opcua::Client> client_;
};

TEST_F(SkillClient, FindsASkillWithItsTypeAndItsController) {
    const auto skills = findSkills(*client_);
    ASSERT_TRUE(skills) << skills.error().message;
    ASSERT_THAT(*skills, SizeIs(1));
    EXPECT_EQ(skills->front().name, "JointPtpMoveSkill");
    EXPECT_TRUE(readLacks(*client_, skills->front()).value().empty());
    EXPECT_FALSE(open().locksDevice()) << "its Start is atomic";
    EXPECT_EQ(skills->front().type_name, "JointPtpMoveSkillType");
    EXPECT_THAT(skills->front().controllerName(), HasSubstr("Arm"));
}

TEST_F(SkillClient, NamesTheSkillsThereAreWhenOneIsNotFound) {
    const auto skill = findSkill(*client_, "GraspGripperSkill");
    ASSERT_FALSE(skill);
    EXPECT_EQ(skill.error().code, Errc::not_found);
    EXPECT_THAT(skill.error().message, HasSubstr("there are: JointPtpMoveSkill"));
}

class SkillThatCannotBeSuspended : public SkillClient {
protected:
    SkillThatCannotBeSuspended() : SkillClient(Suspend::refused) {}
};

bool isSuspendable(opcua::Client& client) {
    auto address = findSkill(client, "JointPtpMoveSkill").value();
    const auto skill = AsyncSkill::open(client, std::move(address), {});
    return skill.value().description().suspendable;
}

TEST_F(SkillClient, KnowsThatASkillCanBeSuspended) {
    EXPECT_TRUE(isSuspendable(*client_));
}

TEST_F(SkillThatCannotBeSuspended, TellsSo) {
    EXPECT_FALSE(isSuspendable(*client_));
}

TEST_F(SkillClient, ReadsWhatTheParametersAreLike) {
    const auto skill = open();
    const auto field = std::find_if(skill.parameters().begin(), skill.parameters().end(),
                                    [](const auto& f) { return f.name == "TargetJointPosition"; });
    ASSERT_NE(field, skill.parameters().end());
    EXPECT_EQ(field->type, skill::ValueType::numbers);
    EXPECT_EQ(field->unit.symbol, "rad");
    ASSERT_TRUE(field->range);
    EXPECT_DOUBLE_EQ(field->range->high, 3.0);
}

TEST_F(SkillClient, RunsASkillToItsResult) {
    auto skill = open();
    const auto result = skill.run({{"TargetJointPosition", std::vector<double>{0.1, 0.2}}}, soon());
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_EQ(result->at("Duration"), skill::Value(0.25));
    EXPECT_EQ(skill.state().value(), State::ready);
}

TEST_F(SkillClient, RunsASkillManyTimesWithoutMixingExecutions) {
    auto skill = open();
    for (int i = 0; i < 100; ++i) {
        const auto result = skill.run({}, soon());
        ASSERT_TRUE(result) << i << ": " << result.error().message;
    }
}

TEST_F(SkillClient, TellsARefusedValueWithItsLimitAndUnit) {
    auto skill = open();
    const auto written = skill.set("TargetJointPosition", std::vector<double>{0.1, 9.0});
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().status, opcua::status::kBadOutOfRange);
    EXPECT_THAT(written.error().message, HasSubstr("9"));
    EXPECT_THAT(written.error().message, HasSubstr("rad"));
    const auto unknown = skill.set("Target", 1.0);
    ASSERT_FALSE(unknown);
    EXPECT_THAT(unknown.error().message, HasSubstr("it has: "));
}

TEST_F(SkillClient, TellsWhyStartWasRefused) {
    auto skill = open();
    behaviour_->refuse = true;
    const auto result = skill.run({}, soon());
    ASSERT_FALSE(result);
    EXPECT_THAT(result.error().message, HasSubstr("1.2 m away, the reach is 0.8 m"));
    EXPECT_EQ(skill.state().value(), State::ready);
    behaviour_->refuse = false;
    EXPECT_TRUE(skill.run({}, soon()));
}

TEST_F(SkillClient, LeavesNothingOfARunWhoseStartWasRefusedToTheNextOne) {
    auto skill = open();
    behaviour_->refuse = true;
    EXPECT_FALSE(skill.run({{"TargetJointPosition", std::vector{0.4, 0.5}}}, soon()));
    behaviour_->refuse = false;
    ASSERT_TRUE(skill.run({}, soon()));
    EXPECT_EQ(behaviour_->first_axis, 0.0);
}

TEST_F(SkillClient, TellsWhyAnExecutionWasHalted) {
    auto skill = open();
    behaviour_->fail = true;
    const auto result = skill.run({}, soon());
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, Errc::device_fault);
    EXPECT_THAT(result.error().message, HasSubstr("axis 2 is hot: 91 °C"));
    EXPECT_TRUE(skill.reset());
    EXPECT_TRUE(skill.awaitState(State::ready, soon()));
}

TEST_F(SkillClient, HaltsASkillThatIsNotDoneAtItsDeadline) {
    auto skill = open();
    behaviour_->finish_at_once = false;
    const auto result = skill.run({}, std::chrono::steady_clock::now() + 50ms);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, Errc::timeout);
    EXPECT_TRUE(skill.awaitState(State::halted, soon()));
}

TEST_F(SkillClient, TellsTheEndOfWhatItStartedAlsoIfThatCameBefore) {
    auto skill = open();
    std::promise<void> ended;
    skill.onTransition([&](const skill::TransitionEvent& event) {
        if (event.to == State::ready) {
            ended.set_value();
        }
    });
    ASSERT_TRUE(skill.start());
    ASSERT_EQ(ended.get_future().wait_until(soon()), std::future_status::ready);
    const auto end = skill.awaitEnd(soon());
    ASSERT_TRUE(end) << end.error().message;
    EXPECT_EQ(end->to, State::ready);
    const auto next = skill.awaitEnd(std::chrono::steady_clock::now() + 10ms);
    ASSERT_FALSE(next) << "it was told";
    EXPECT_EQ(next.error().code, Errc::timeout);
}

TEST_F(SkillClient, TellsTheEndOfWhatItStartedAlsoAfterARefusedStart) {
    auto skill = open();
    behaviour_->finish_at_once = false;
    ASSERT_TRUE(skill.start());
    ASSERT_FALSE(skill.runWith({}, soon())) << "it is Running";
    ASSERT_TRUE(skill.halt());
    ASSERT_TRUE(skill.awaitState(State::halted, soon()));
    const auto end = skill.awaitEnd(soon());
    ASSERT_TRUE(end) << end.error().message;
    EXPECT_EQ(end->to, State::halted);
}

TEST_F(SkillClient, SuspendsAndResumes) {
    auto skill = open();
    behaviour_->finish_at_once = false;
    ASSERT_TRUE(skill.start());
    ASSERT_TRUE(skill.suspend());
    ASSERT_TRUE(skill.awaitState(State::suspended, soon()));
    EXPECT_FALSE(skill.executable(skill::Method::suspend).value());
    EXPECT_TRUE(skill.executable(skill::Method::resume).value());
    ASSERT_TRUE(skill.resume());
    ASSERT_TRUE(skill.awaitState(State::ready, soon()));
    EXPECT_EQ(skill.result().value().at("Duration"), skill::Value(0.5));
}

TEST_F(SkillClient, WaitsForRestWhicheverStateItIsIn) {
    auto skill = open();
    EXPECT_EQ(skill.awaitRest(soon()).value(), State::ready);
    behaviour_->finish_at_once = false;
    ASSERT_TRUE(skill.start());
    EXPECT_EQ(skill.awaitRest(std::chrono::steady_clock::now() + 50ms).error().code, Errc::timeout);
    ASSERT_TRUE(skill.suspend());
    EXPECT_EQ(skill.awaitRest(soon()).value(), State::suspended);
    ASSERT_TRUE(skill.halt());
    EXPECT_EQ(skill.awaitRest(soon()).value(), State::halted);
}

TEST_F(SkillClient, TellsTheStatusOfAMethodThatTheStateDoesNotAllow) {
    auto skill = open();
    const auto resumed = skill.resume();
    ASSERT_FALSE(resumed);
    EXPECT_EQ(resumed.error().status, opcua::status::kBadInvalidState);
}

TEST_F(SkillClient, StopsWaitingWhenTheServerIsGone) {
    auto skill = open();
    behaviour_->finish_at_once = false;
    ASSERT_TRUE(skill.start());
    skills_.reset();  // stops the server
    const auto outcome = skill.awaitState(State::ready, soon());
    ASSERT_FALSE(outcome);
    EXPECT_EQ(outcome.error().code, Errc::connection_lost);
}

TEST_F(SkillClient, ReadsTheArmThatASkillMoves) {
    const auto skill = findSkill(*client_, "JointPtpMoveSkill").value();
    const auto nodes = findKinematics(*client_, skill);
    ASSERT_TRUE(nodes) << nodes.error().message;
    const auto data = readKinematics(*client_, *nodes);
    ASSERT_TRUE(data) << data.error().message;
    EXPECT_EQ(data->axisCount(), 2U);
    EXPECT_DOUBLE_EQ(data->joint_frames[1].x, 0.3);
    EXPECT_THAT(data->max_joint_position, ElementsAre(3, 2));
    EXPECT_THAT(data->tool_frames, ElementsAre("flange", "gripper"));
    EXPECT_THAT(readJointPosition(*client_, *nodes).value(), ElementsAre(0.1, -0.2));
    EXPECT_EQ(readMissedCycles(*client_, *nodes).value(), 7U);
}

TEST_F(SkillClient, HearsOfTheMeasuredArm) {
    const auto skill = findSkill(*client_, "JointPtpMoveSkill").value();
    const auto nodes = findKinematics(*client_, skill).value();
    std::promise<std::vector<double>> first;
    std::atomic<bool> told = false;
    auto subscription = subscribeJointPosition(*client_, nodes, 10ms, [&](const auto& joints) {
        if (!told.exchange(true)) {
            first.set_value(joints);
        }
    });
    ASSERT_TRUE(subscription) << subscription.error().message;
    auto joints = first.get_future();
    ASSERT_EQ(joints.wait_until(soon()), std::future_status::ready);
    EXPECT_THAT(joints.get(), ElementsAre(0.1, -0.2));
}

}  // namespace
}  // namespace metier::client
