#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "joint_bus.hpp"
#include "machine.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/virtual_controller/controller.hpp"
#include "rosbridge.hpp"
#include "software.hpp"
#include "trajectory_node.hpp"

namespace metier::virtual_edo {

/// Options of an e.DO.
struct RobotOptions {
    Software software;
    std::size_t axes = kMostAxes;  ///< 7 with the gripper, 6 without
    /// Starts calibrated with free brakes, at the model's home position; otherwise in INIT, at
    /// zero, uncalibrated.
    bool ready = true;
    double collision_force = 50.0;  ///< smallest force on the flange that is a collision [N]
    /// Offers kinematics services to clients; no release of the maker does.
    bool kinematics_services = false;
};

/// The e.DO behind the bridge: its nodes, topics and services, in cycles of 10 ms.
///
/// Threading: one thread.
/// Source: Comau/eDO_core.
class Robot final : private MachinePeers {
public:
    /// Gives a whole message of a topic to whom it concerns.
    using Publish = std::function<void(const std::string& topic, const Json& message)>;
    using Wanted = std::function<bool(std::string_view topic)>;

    /// \param model of an arm of six axes; outlives the robot
    Robot(RobotOptions options, const motion::RobotModel& model);

    /// Topics and services, bound to this robot.
    RosGraph graph();
    /// \param wanted whether a topic has subscribers
    void connect(Publish publish, Wanted wanted);

    /// One cycle of 10 ms.
    /// \return what it shows the world
    virtual_controller::WorldReport step(const virtual_controller::WorldEffect& effect);

    std::vector<virtual_controller::InjectionHelp> injections();
    Json state() const;
    /// True joint position of the arm [rad].
    motion::JointVector jointPosition() const;

private:
    using Topics = std::map<std::string, std::string, std::less<>>;

    /// The robot's own topics in one release, name to type.
    static Topics topicsOf(const Software& software);
    void serveAlways(RosGraph& graph);
    void serveKinematics(RosGraph& graph);
    void serveToolAndCounter(RosGraph& graph);
    void countCalibration();

    void publishJointStates(const BusReport& report);
    void publishControl();
    bool nodeCommands() const;
    void publishSlowTopics();
    void sayMode();
    void send(const std::string& topic, const Json& message);
    bool wants(std::string_view topic) const {
        return topics_.contains(topic) && wanted_ && wanted_(topic);
    }
    Json jointState(const JointReport& joint) const;
    Json jointStates(const BusReport& report) const;

    void onMessage(const std::string& topic, const Json& message);
    void onSetPoints(const Json& message);
    void onExternalControl(const Json& message);
    bool isCommand(const std::string& topic) const;
    Result<Json> jointsNumber() const;
    Result<Json> softwareVersions() const;
    Result<Json> directKinematics(const Json& arguments) const;
    Result<Json> inverseKinematics(const Json& arguments) const;
    std::int8_t tool() const;
    std::vector<double> targets() const;

    virtual_controller::InjectionHelp jointFault(const char* name, const char* help,
                                                 std::vector<JointFlag> flags);
    Result<void> silence(const virtual_controller::Injection& injection);
    std::optional<double> partWidth(const virtual_controller::WorldEffect& effect);

    std::size_t loadConfiguration(std::size_t axes) override { return node_.load(axes); }
    JointBus& bus() override { return bus_; }
    void passMove(const Movement& movement) override { node_.move(movement); }
    void passJog(const Movement& movement) override { node_.jog(movement); }
    bool algorithmBusy() const override { return node_.isBusy(); }
    void publishFeedback(Feedback feedback) override;
    void publishBrakesCheck(std::int8_t state, std::uint8_t mask) override;
    void onBraked() override { node_.onBraked(); }

    RobotOptions options_;
    Topics topics_;
    JointBus bus_;
    TrajectoryNode node_;
    Machine machine_;
    Publish publish_;
    Wanted wanted_;
    std::uint64_t cycles_ = 0;
    std::uint64_t calibrations_ = 0;
    std::int8_t tool_ = -1;  // tool configured by /tool_configuration or the start-up
    std::size_t commands_to_drop_ = 0;
    int contact_left_ = 0;  // cycles that an injected collision lasts
    bool part_lost_ = false;
    bool client_set_points_ = false;  // /algo_jnt_ctrl was written by a client in this cycle
};

}  // namespace metier::virtual_edo
