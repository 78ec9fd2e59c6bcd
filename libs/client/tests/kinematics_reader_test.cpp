// Arms of servers that publish them in part, or wrongly.
#include "metier/client/kinematics_reader.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <map>

#include "served_nodes.hpp"

namespace metier::client {
namespace {

using opcua::Value;
using ::testing::HasSubstr;

using Named = std::map<std::string, Value>;

/// Values of an arm of two axes, as they should be.
Named twoAxes() {
    const auto pair = Value::of(std::vector<double>{1.0, 2.0});
    return {{"BaseFromFirstJoint", Value::of(opcua::ThreeDFrame{})},
            {"LastJointFromFlange", Value::of(opcua::ThreeDFrame{})},
            {"JointFrames", Value::of(std::vector<opcua::ThreeDFrame>(2))},
            {"JointAxes", Value::of(std::vector<opcua::ThreeDVector>(2))},
            {"MinJointPosition", pair},
            {"MaxJointPosition", pair},
            {"MaxJointVelocity", pair},
            {"MaxJointAcceleration", pair},
            {"MaxJointJerk", pair},
            {"MaxCartesianVelocity", pair},
            {"MaxCartesianAcceleration", pair},
            {"MaxCartesianJerk", pair},
            {"CycleTime", Value::of(0.008)},
            {"ToolFrames", Value::of(std::vector<std::string>{"flange"})}};
}

class PublishedArm : public ::testing::Test {
protected:
    /// An arm of its own. \return nodes of its device and Kinematics
    KinematicsNodes add(const Named& values) {
        KinematicsNodes nodes;
        nodes.device = served_.object(opcua::ids::kObjectsFolder, "Arm" + std::to_string(++arms_));
        nodes.object = served_.object(nodes.device, "Kinematics");
        for (const auto& [name, value] : values) {
            served_.variable(nodes.object, name, value);
        }
        return nodes;
    }
    KinematicsNodes addWith(const std::string& name, const Value& value) {
        auto values = twoAxes();
        values[name] = value;
        return add(values);
    }
    KinematicsNodes addWithMass(const Value& mass) {
        const auto nodes = add(twoAxes());
        served_.variable(served_.object(nodes.device, "FlangeLoad"), "Mass", mass);
        return nodes;
    }
    opcua::Answer<opcua_skill::KinematicsData> read(const KinematicsNodes& nodes) {
        return readKinematics(served_.client(), nodes);
    }

    testing::ServedNodes served_{{"device"}};
    int arms_ = 0;
};

TEST_F(PublishedArm, IsReadWithoutWhatIsOptional) {
    const auto nodes = add(twoAxes());
    const auto data = read(nodes);
    ASSERT_TRUE(data) << data.error().message;
    EXPECT_EQ(data->axisCount(), 2U);
    EXPECT_EQ(data->cycle_time, 0.008);
    EXPECT_EQ(data->payload, 0.0) << "unknown";
}

TEST_F(PublishedArm, IsRefusedWithTheNameOfWhatIsMissing) {
    std::map<std::string, KinematicsNodes> arms;
    for (const auto& [name, value] : twoAxes()) {
        auto values = twoAxes();
        values.erase(name);
        arms[name] = add(values);
    }
    for (const auto& [name, nodes] : arms) {
        const auto data = read(nodes);
        ASSERT_FALSE(data) << name;
        EXPECT_EQ(data.error().code, Errc::not_found);
        EXPECT_THAT(data.error().message, HasSubstr("Kinematics has no " + name));
    }
}

TEST_F(PublishedArm, IsRefusedWithTheNameOfWhatHasAnotherType) {
    std::map<std::string, KinematicsNodes> arms;
    for (const auto& [name, value] : twoAxes()) {
        arms[name] = addWith(name, Value::of("two"));
    }
    for (const auto& [name, nodes] : arms) {
        const auto data = read(nodes);
        ASSERT_FALSE(data) << name;
        EXPECT_EQ(data.error().code, Errc::type_mismatch);
        EXPECT_THAT(data.error().message, HasSubstr("Kinematics/" + name + ": "));
    }
}

TEST_F(PublishedArm, IsRefusedIfItsListsAreOfDifferentLengths) {
    const auto three = Value::of(std::vector<double>{1, 2, 3});
    const std::vector arms{addWith("MinJointPosition", three),
                           addWith("MaxJointPosition", three),
                           addWith("MaxJointVelocity", three),
                           addWith("MaxJointAcceleration", three),
                           addWith("MaxJointJerk", three),
                           addWith("MaxCartesianVelocity", three),
                           addWith("MaxCartesianAcceleration", three),
                           addWith("MaxCartesianJerk", three),
                           addWith("JointFrames", Value::of(std::vector<opcua::ThreeDFrame>(1)))};
    const auto without_axes = addWith("JointAxes", Value::of(std::vector<opcua::ThreeDVector>{}));
    for (const auto& nodes : arms) {
        const auto data = read(nodes);
        ASSERT_FALSE(data) << nodes.object.toString();
        EXPECT_EQ(data.error().code, Errc::invalid_argument);
        EXPECT_THAT(data.error().message, HasSubstr("lists do not fit an arm of 2 axes"));
    }
    EXPECT_THAT(read(without_axes).error().message, HasSubstr("an arm of 0 axes"));
}

TEST_F(PublishedArm, HasAPayloadOnlyIfItIsAMass) {
    const auto right = addWithMass(Value::of(12.5));
    const std::vector wrong{addWithMass(Value::of(-1.0)), addWithMass(Value::of(std::nan(""))),
                            addWithMass(Value::of("heavy"))};
    EXPECT_EQ(read(right)->payload, 12.5);
    for (const auto& nodes : wrong) {
        const auto data = read(nodes);
        ASSERT_TRUE(data) << data.error().message;
        EXPECT_EQ(data->payload, 0.0);
    }
}

/// A skill below two systems, the inner one of which has devices.
class SkillOfASystem : public PublishedArm {
protected:
    SkillOfASystem() {
        skill_.name = "Move";
        skill_.above = {{"Cell", outer_}, {"System", inner_}};
    }
    opcua::NodeId addDevice(const opcua::NodeId& system, const std::string& name) {
        const opcua::NodeId folder{1, system.toString().substr(7) + ".MotionDevices"};
        return served_.object(
            served_.nodes().exists(folder) ? folder : served_.object(system, "MotionDevices"),
            name);
    }
    opcua::NodeId addKinematics(const opcua::NodeId& device, const std::string& without = "") {
        const auto object = served_.object(device, "Kinematics");
        for (const std::string name : {"ActualJointPosition", "SafetyState", "MissedCycles"}) {
            if (name != without) {
                served_.variable(object, name, Value::of(1.0));
            }
        }
        return object;
    }
    opcua::Answer<KinematicsNodes> find() { return findKinematics(served_.client(), skill_); }

    const opcua::NodeId outer_ = served_.object(opcua::ids::kObjectsFolder, "Cell");
    const opcua::NodeId inner_ = served_.object(outer_, "System");
    SkillAddress skill_;
};

TEST_F(SkillOfASystem, MovesTheFirstDeviceOfTheNearestSystemThatHasKinematics) {
    addKinematics(addDevice(outer_, "Other"));
    addDevice(inner_, "A");
    const auto device = addDevice(inner_, "B");
    const auto object = addKinematics(device);
    const auto nodes = find();
    ASSERT_TRUE(nodes) << nodes.error().message;
    EXPECT_EQ(nodes->object, object);
    EXPECT_EQ(nodes->device, device);
    EXPECT_EQ(nodes->device_name, "B");
    EXPECT_TRUE(nodes->standstill.isNull()) << "optional";
    const auto joints = readJointPosition(served_.client(), *nodes);
    ASSERT_FALSE(joints);
    EXPECT_THAT(joints.error().message, HasSubstr("ActualJointPosition: Double[] expected"));
    EXPECT_EQ(readMissedCycles(served_.client(), *nodes).error().code, Errc::type_mismatch);
}

TEST_F(SkillOfASystem, LooksFurtherUpIfTheNearestDevicesHaveNone) {
    const auto object = addKinematics(addDevice(outer_, "Other"));
    addDevice(inner_, "A");
    EXPECT_EQ(find()->object, object);
}

TEST_F(SkillOfASystem, MovesNoArmIfNoneIsPublished) {
    addDevice(inner_, "A");
    const auto nodes = find();
    ASSERT_FALSE(nodes);
    EXPECT_EQ(nodes.error().code, Errc::not_found);
    EXPECT_THAT(nodes.error().message, HasSubstr("Move belongs to no arm"));
}

TEST_F(SkillOfASystem, NamesWhatTheKinematicsOfItsArmLack) {
    addKinematics(addDevice(inner_, "A"), "SafetyState");
    EXPECT_THAT(find().error().message, HasSubstr("Kinematics has no SafetyState"));
}

}  // namespace
}  // namespace metier::client
