// Values that OPC 40010-1 makes mandatory, of a robot whose objects are made at run time.
#include <gmock/gmock.h>

#include <atomic>

#include "served_skills.hpp"

namespace metier::opcua_skill::testing {
namespace {

using Names = std::vector<std::string>;

KinematicsData twoAxes() {
    KinematicsData data;
    data.joint_frames.resize(2);
    data.joint_axes = {{0, 0, 1}, {0, 1, 0}};
    data.min_joint_position = data.max_joint_position = {1, 1};
    data.max_joint_velocity = data.max_joint_acceleration = data.max_joint_jerk = {1, 1};
    return data;
}

class RobotValues : public ServedSkills {
protected:
    RobotValues() {
        const auto published = publishKinematics(server().nodes(), system(), twoAxes(), [this] {
            return KinematicsState{{0.5, -0.5}, {}, safety_.load(), 0};
        });
        EXPECT_TRUE(published) << published.error().message;
        serve();
        client_ = connect();
        di_ = client_->namespaceIndex("http://opcfoundation.org/UA/DI/").value();
        robotics_ = client_->namespaceIndex("http://opcfoundation.org/UA/Robotics/").value();
        own_ = client_->namespaceIndex("urn:test").value();
    }

    ~RobotValues() override {
        client_.reset();
        shutDown();  // it reads safety_
    }

    opcua::NodeId find(const opcua::NodeId& start, std::vector<opcua::QualifiedName> path) {
        return client_->translate(start, std::move(path)).value();
    }
    /// "true", or the name of a Bad status.
    std::string read(const opcua::NodeId& start, std::vector<opcua::QualifiedName> path) {
        const auto value = client_->read(find(start, std::move(path)));
        return value ? value->toString() : value.error().status.name();
    }
    std::string safety(const char* name) {
        return read(system().system, {{robotics_, "SafetyStates"},
                                      {own_, "SafetyState"},
                                      {di_, "ParameterSet"},
                                      {robotics_, name}});
    }
    Names stops() { return {safety("EmergencyStop"), safety("ProtectiveStop")}; }

    std::atomic<SafetyStateKind> safety_{SafetyStateKind::normal};
    std::unique_ptr<opcua::Client> client_;
    std::uint16_t di_ = 0;
    std::uint16_t robotics_ = 0;
    std::uint16_t own_ = 0;
};

TEST_F(RobotValues, ShowTheStopsOfTheController) {
    EXPECT_EQ(stops(), (Names{"false", "false"}));
    safety_ = SafetyStateKind::emergency_stop;
    EXPECT_EQ(stops(), (Names{"true", "false"}));
    safety_ = SafetyStateKind::protective_stop;
    EXPECT_EQ(stops(), (Names{"false", "true"}));
}

TEST_F(RobotValues, ShowNoStopsWhileNobodyKnowsThem) {
    safety_ = SafetyStateKind::unknown;
    EXPECT_EQ(stops(), (Names{"BadNoCommunication", "BadNoCommunication"}));
}

TEST_F(RobotValues, InventNothing) {
    EXPECT_EQ(safety("OperationalMode"), "BadNoData");
    EXPECT_EQ(read(system().motion_device, {{di_, "ParameterSet"}, {robotics_, "SpeedOverride"}}),
              "BadNoData");
    for (const auto* train : {"PowerTrain_1", "PowerTrain_2"}) {
        EXPECT_EQ(read(system().motion_device, {{robotics_, "PowerTrains"},
                                                {own_, train},
                                                {own_, "Motor"},
                                                {di_, "ParameterSet"},
                                                {robotics_, "MotorTemperature"}}),
                  "BadNoData");
    }
    for (const auto* name : {"TaskProgramName", "TaskProgramLoaded"}) {
        EXPECT_EQ(read(system().controller, {{robotics_, "TaskControls"},
                                             {own_, "SkillControl"},
                                             {di_, "ParameterSet"},
                                             {robotics_, name}}),
                  "BadNoData");
    }
}

TEST_F(RobotValues, NameTheMakerOfTheSoftwareButNoRevisionThatIsNotKnown) {
    const auto software =
        find(system().controller, {{robotics_, "Software"}, {own_, "ControllerSoftware"}});
    const auto maker = client_->read(find(software, {{di_, "Manufacturer"}}));
    EXPECT_EQ(maker->as<opcua::LocalizedText>()->text, "metier");
    const auto revision = client_->read(find(software, {{di_, "SoftwareRevision"}}));
    EXPECT_EQ(revision->as<std::string>(), "");
}

TEST_F(RobotValues, TellWhichPowerTrainMovesWhichAxis) {
    const auto train =
        find(system().motion_device, {{robotics_, "PowerTrains"}, {own_, "PowerTrain_2"}});
    const opcua::NodeId moves(robotics_, 18178U);
    const auto moved = client_->browse({.node = train, .reference_type = moves});
    ASSERT_TRUE(moved) << moved.error().message;
    ASSERT_EQ(moved->size(), 1U);
    EXPECT_EQ(moved->front().browse_name.name, "Axis_2");
}

}  // namespace
}  // namespace metier::opcua_skill::testing
