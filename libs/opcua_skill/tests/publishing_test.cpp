#include <gmock/gmock.h>

#include "metier/opcua_skill/live_figures.hpp"
#include "metier/opcua_skill/values.hpp"
#include "metier/robot_skills/move_parameters.hpp"
#include "metier/skill/lambda_skill.hpp"
#include "served_skills.hpp"

namespace metier::opcua_skill::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

KinematicsData twoAxes() {
    KinematicsData data;
    data.base_from_first_joint = {0, 0, 0.5, 0, 0, 0};
    data.last_joint_from_flange = {0.25, 0, 0, 0, 0, 0};
    data.joint_frames = {{}, {0.75, 0, 0, 0, 0, 0}};
    data.joint_axes = {{0, 0, 1}, {0, 1, 0}};
    data.min_joint_position = {-3, -2};
    data.max_joint_position = {3, 2};
    data.max_joint_velocity = {2, 2};
    data.max_joint_acceleration = {10, 10};
    data.max_joint_jerk = {100, 100};
    data.max_cartesian_velocity = {1, 2};
    data.max_cartesian_acceleration = {3, 4};
    data.max_cartesian_jerk = {5, 6};
    data.cycle_time = 0.008;
    data.tool_frames = {"", "gripper"};
    return data;
}

class Publishing : public ServedSkills {
protected:
    SystemClock clock_;
    Result<skill::Program*> publish(skill::SkillDescription description) {
        return skills().publish(
            system().skills,
            std::make_unique<skill::LambdaSkill>(std::move(description), skill::SkillFunctions{}));
    }
};

TEST_F(Publishing, AControllerThatIsMadeHasALockThatKeepsOthersOut) {
    const auto control = std::make_shared<skill::Control>(skills().executor(), clock_);
    ASSERT_TRUE(skills().serveControl(system().controller, control));
    auto& nodes = server().nodes();
    const auto di = nodes.namespaceIndex("http://opcfoundation.org/UA/DI/").value();
    const auto lock = nodes.find(system().controller, {di, "Lock"}).value();
    const auto init = nodes.find(lock, {di, "InitLock"}).value();
    const auto locked = nodes.find(lock, {di, "Locked"}).value();
    serve();
    const auto alice = connect("alice");
    const auto bob = connect("bob");
    const auto taken = alice->call(lock, init, {opcua::Value::of("a test")});
    ASSERT_TRUE(taken) << taken.error().message;
    EXPECT_EQ(taken->outputs.at(0).as<std::int32_t>(), 0);
    EXPECT_EQ(bob->read(locked).value().as<bool>(), true);
    const auto refused = bob->call(lock, init, {opcua::Value::of("a test")});
    EXPECT_EQ(refused.value().outputs.at(0).as<std::int32_t>(), -1);
}

TEST_F(Publishing, ReportsEveryFieldThatTheTypeLacks) {
    auto description = jointMoveDescription();
    auto fields = description.parameters.toVector();
    fields[0].name = "TargetJoint";
    fields[4].name = "Turbo";
    description.parameters = std::move(fields);
    const auto refused = publish(description);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::not_found);
    EXPECT_THAT(refused.error().message,
                AllOf(HasSubstr("ParameterSet/TargetJoint"), HasSubstr("Options/Turbo")));
}

TEST_F(Publishing, ReportsEveryFieldOfAnotherType) {
    auto description = jointMoveDescription();
    auto fields = description.parameters.toVector();
    fields[0].type = skill::ValueType::text;
    fields[4].type = skill::ValueType::int32;
    description.parameters = std::move(fields);
    const auto refused = publish(description);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::type_mismatch);
    EXPECT_THAT(refused.error().message,
                AllOf(HasSubstr("TargetJointPosition"), HasSubstr("SpeedOverride")));
}

TEST_F(Publishing, TheForceMovesTypeHasANodeForEachOfItsFields) {
    const auto model = motion::RobotModel::load(METIER_MODELS_DIR "/iiwa7.toml").value();
    skill::SkillDescription description{.name = "CartesianLinearForceMoveSkill",
                                        .type = "CartesianLinearForceMoveSkillType"};
    description.parameters = robot_skills::forceMoveFields(model).fields();
    auto results = robot_skills::forceMoveResultFields().fields();
    for (auto& result : results) {
        result.place = skill::Place::final_result;
    }
    description.results = std::move(results);
    const auto published = publish(description);
    ASSERT_TRUE(published) << published.error().message;
}

TEST_F(Publishing, RefusesATypeThatIsNotThere) {
    auto description = jointMoveDescription();
    description.type = "DanceSkillType";
    const auto refused = publish(description);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("DanceSkillType"));
}

TEST_F(Publishing, RefusesASecondSkillOfTheSameName) {
    ASSERT_TRUE(publish(jointMoveDescription()));
    const auto second = publish(jointMoveDescription());
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, Errc::already_exists);
}

TEST_F(Publishing, ACompactSkillServesTheSame) {
    auto hand = std::make_shared<Hand>();
    ASSERT_TRUE(skills().publish(system().skills,
                                 std::make_unique<HandDrivenSkill>(streamDescription(), hand), {},
                                 NodeStyle::compact));
    serve();
    const auto client = connect();
    const auto index = system().skills.namespaceIndex();
    const auto skill = client->translate(system().skills, {{index, "PositionStreamSkill"}});
    ASSERT_TRUE(skill) << skill.error().message;
    TransitionWatch watch(*client, *skill);
    ASSERT_TRUE(client->call(*skill, *client->translate(*skill, {{0, "Start"}})));
    EXPECT_EQ(watch.nextName(), "ReadyToRunning");
    const auto number = client->translate(*skill, {{0, "CurrentState"}, {0, "Number"}});
    ASSERT_TRUE(number);
    EXPECT_EQ(client->read(*number)->as<std::uint32_t>(), 13U);
    const auto diagnostic = client->translate(*skill, {{0, "ProgramDiagnostic"}});
    ASSERT_TRUE(diagnostic);
    EXPECT_EQ(client->read(*diagnostic)->as<opcua::ProgramDiagnostic>()->last_method_call, "Start");
}

TEST_F(Publishing, AnExecutionMayOutliveItsServer) {
    const auto skill = add(streamDescription());
    serve();
    const auto client = connect();
    ASSERT_EQ(call(*client, skill, "Start"), "Good");
    ASSERT_TRUE(skill.hand->await("start"));
    shutDown();
    skill.hand->execution().finish();
    EXPECT_TRUE(skill.hand->await("forceStop"));
}

TEST_F(Publishing, TheSystemIsFoundByItsTypes) {
    const auto found = findMotionDeviceSystem(server().nodes());
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_EQ(found->skills, system().skills);
    EXPECT_EQ(found->kinematics, system().kinematics);
}

TEST_F(Publishing, KinematicsAreReadBack) {
    ASSERT_TRUE(publishKinematics(server().nodes(), system(), twoAxes(), [] {
        return KinematicsState{{0.5, -0.5}, {1, 2, 3, 0, 0, 0}, SafetyStateKind::normal, 7};
    }));
    serve();
    const auto client = connect();
    const auto metier = client->namespaceIndex("urn:metier:skills");
    ASSERT_TRUE(metier);
    const auto value = [&](std::vector<opcua::QualifiedName> path) {
        const auto node = client->translate(system().kinematics, std::move(path));
        return node ? client->read(*node).value_or(opcua::Value()) : opcua::Value();
    };
    EXPECT_EQ(value({{*metier, "AxisCount"}}), opcua::Value::of(std::uint32_t{2}));
    EXPECT_EQ(value({{*metier, "MaxJointPosition"}}), opcua::Value::of(std::vector{3.0, 2.0}));
    EXPECT_EQ(value({{*metier, "ActualJointPosition"}}), opcua::Value::of(std::vector{0.5, -0.5}));
    EXPECT_EQ(value({{*metier, "ActualPose"}, {0, "CartesianCoordinates"}, {0, "Y"}}),
              opcua::Value::of(2.0));
    EXPECT_EQ(value({{*metier, "SafetyState"}}).as<std::int32_t>(), 1);
    EXPECT_EQ(value({{*metier, "ToolFrames"}}),
              opcua::Value::of(std::vector<std::string>{"", "gripper"}));
}

TEST_F(Publishing, AGrippersFiguresAreLiveAndBadWhileNobodyKnows) {
    std::atomic<int> held{1};
    ASSERT_TRUE(publishGripperFigures(
        server().nodes(), system().controller, {0.11, true},
        [&]() -> std::optional<GripperFigures> {
            return held < 0 ? std::nullopt : std::optional(GripperFigures{0.05, 12.0, held == 1});
        }));
    serve();
    const auto client = connect();
    const auto metier = client->namespaceIndex("urn:metier:skills").value();
    const auto node = client->translate(system().controller, {{metier, "PartHeld"}}).value();
    Queue<opcua::DataValue> seen{10};
    const auto watch =
        client->subscribeData(node, {.sampling_interval = std::chrono::milliseconds(10)},
                              [&](const opcua::DataValue& value) { seen.tryPush(value); });
    ASSERT_TRUE(watch) << watch.error().message;
    const auto next = [&] {
        return seen.popUntil(clock_.now() + std::chrono::seconds(10)).value();
    };
    const auto value = [&](const char* name) {
        return client->read(client->translate(system().controller, {{metier, name}}).value());
    };
    EXPECT_EQ(next().value, opcua::Value::of(true));
    EXPECT_EQ(value("GripperStroke").value(), opcua::Value::of(0.11));
    EXPECT_EQ(value("GripperWidth").value(), opcua::Value::of(0.05));
    EXPECT_EQ(value("GripperForce").value(), opcua::Value::of(12.0));
    held = 0;
    EXPECT_EQ(next().value, opcua::Value::of(false));
    held = -1;
    EXPECT_EQ(next().status.name(), "BadNoCommunication");
    EXPECT_EQ(value("GripperWidth").error().status.name(), "BadNoCommunication");
    EXPECT_EQ(value("GripperStroke").value(), opcua::Value::of(0.11)) << "that is known still";
}

TEST_F(Publishing, AnArmsFiguresTellTheirUnits) {
    std::atomic<bool> connected{true};
    const auto known = [&](auto value) { return connected ? std::optional(value) : std::nullopt; };
    ASSERT_TRUE(publishArmFigures(server().nodes(), system().kinematics,
                                  {.commanded_joint_position =
                                       [=] {
                                           return known(std::vector{0.5, -0.5});
                                       },
                                   .standstill = [=] { return known(true); },
                                   .stopping =
                                       [=] {
                                           return known(StoppingFigures{0.25, 0.02});
                                       },
                                   .cycle_jitter = [=] { return known(25e-6); },
                                   .flange_wrench =
                                       [=] {
                                           return known(FlangeWrench{{1, 2, 3}, {4, 5, 6}});
                                       },
                                   .stream =
                                       [] {
                                           return StreamFigures{0.1, 0.2, -0.3, 4, 5};
                                       }}));
    serve();
    const auto client = connect();
    const auto metier = client->namespaceIndex("urn:metier:skills").value();
    const auto value = [&](std::vector<opcua::QualifiedName> path) {
        return client->read(client->translate(system().kinematics, std::move(path)).value());
    };
    const auto unit = [&](const char* name) {
        return symbolOf(value({{metier, name}, {0, "EngineeringUnits"}})
                            .value()
                            .as<opcua::EuInformation>()
                            .value());
    };
    EXPECT_EQ(value({{metier, "CommandedJointPosition"}}).value(),
              opcua::Value::of(std::vector{0.5, -0.5}));
    EXPECT_EQ(value({{metier, "Standstill"}}).value(), opcua::Value::of(true));
    EXPECT_EQ(value({{metier, "StoppingTime"}}).value(), opcua::Value::of(0.25));
    EXPECT_EQ(value({{metier, "StoppingDistance"}}).value(), opcua::Value::of(0.02));
    EXPECT_EQ(unit("StoppingTime"), "s");
    EXPECT_EQ(unit("StoppingDistance"), "m");
    EXPECT_EQ(value({{metier, "CycleJitter"}}).value(), opcua::Value::of(25e-6));
    EXPECT_EQ(value({{metier, "FlangeForce"}}).value(), opcua::Value::of(std::vector{1., 2., 3.}));
    EXPECT_EQ(value({{metier, "FlangeTorque"}}).value(), opcua::Value::of(std::vector{4., 5., 6.}));
    EXPECT_EQ(value({{metier, "StreamLag"}}).value(), opcua::Value::of(0.1));
    EXPECT_EQ(value({{metier, "LargestStreamLag"}}).value(), opcua::Value::of(0.2));
    EXPECT_EQ(value({{metier, "StreamClockStep"}}).value(), opcua::Value::of(-0.3));
    EXPECT_EQ(value({{metier, "RefusedSetPoints"}}).value(), opcua::Value::of(std::uint64_t{4}));
    EXPECT_EQ(value({{metier, "DroppedSetPoints"}}).value(), opcua::Value::of(std::uint64_t{5}));
    EXPECT_EQ(unit("StreamLag"), "s");
    EXPECT_EQ(unit("CommandedJointPosition"), "rad");
    EXPECT_EQ(unit("CycleJitter"), "s");
    EXPECT_EQ(unit("FlangeForce"), "N");
    EXPECT_EQ(unit("FlangeTorque"), "N m");
    connected = false;
    EXPECT_EQ(value({{metier, "FlangeForce"}}).error().status.name(), "BadNoCommunication");
}

TEST_F(Publishing, AnArmWithoutASensorHasNoVariablesOfOne) {
    ASSERT_TRUE(publishArmFigures(
        server().nodes(), system().kinematics,
        {.commanded_joint_position = [] { return std::optional(std::vector{0.5}); }}));
    serve();
    const auto client = connect();
    const auto metier = client->namespaceIndex("urn:metier:skills").value();
    EXPECT_TRUE(client->translate(system().kinematics, {{metier, "CommandedJointPosition"}}));
    EXPECT_FALSE(client->translate(system().kinematics, {{metier, "FlangeForce"}}));
    EXPECT_FALSE(client->translate(system().kinematics, {{metier, "CycleJitter"}}));
}

TEST_F(Publishing, KinematicsOfDifferentLengthsAreRefused) {
    auto data = twoAxes();
    data.max_joint_velocity.push_back(1.0);
    const auto refused = publishKinematics(server().nodes(), system(), data, nullptr);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::invalid_argument);
}

}  // namespace
}  // namespace metier::opcua_skill::testing
