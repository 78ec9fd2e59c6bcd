#include "robot.hpp"

#include <utility>

namespace metier::virtual_edo {
namespace {

using virtual_controller::WorldEffect;
using virtual_controller::WorldReport;

// Slow topics come every tenth cycle.
constexpr std::uint64_t kSlow = 10;

AxisValues startOf(const RobotOptions& options, const motion::RobotModel& model) {
    AxisValues values{};
    if (options.ready) {
        setArm(values, model.home());
    }
    return values;
}

}  // namespace

Robot::Robot(RobotOptions options, const motion::RobotModel& model)
    : options_(std::move(options)),
      topics_(topicsOf(options_.software)),
      bus_(limitsOf(model), options_.axes, startOf(options_, model)),
      node_(options_.software, model, [this](Feedback feedback) { machine_.onFeedback(feedback); }),
      machine_(*this) {
    if (options_.ready) {
        bus_.makeReady();
        machine_.makeReady(options_.axes);
        node_.onJointState(*bus_.report());
    }
}

void Robot::connect(Publish publish, Wanted wanted) {
    publish_ = std::move(publish);
    wanted_ = std::move(wanted);
}

void Robot::send(const std::string& topic, const Json& message) {
    if (publish_) {
        publish_(topic, message);
    }
}

WorldReport Robot::step(const WorldEffect& effect) {
    ++cycles_;
    contact_left_ = std::max(0, contact_left_ - 1);
    // A client that writes the node's topic fights with it: now one comes last, now the other.
    if (std::exchange(client_set_points_, false) && nodeCommands() && cycles_ % 2 == 0) {
        bus_.command(targets());
    }
    bus_.step(partWidth(effect));
    const auto report = bus_.report();
    node_.setContact(contact_left_ > 0 || effect.wrench.force.norm() > options_.collision_force);
    // The state machine gets the joints' reports first and passes them on.
    machine_.step(report, node_.collision());
    if (report) {
        if (bus_.justCalibrated()) {
            countCalibration();
            node_.rebase(*report);
        }
        node_.onJointState(*report);
    }
    sayMode();
    node_.step();
    publishControl();
    if (report) {
        publishJointStates(*report);
    }
    if (cycles_ % kSlow == 0) {
        publishSlowTopics();
    }
    const AxisValues position = bus_.truePosition();
    WorldReport shown{.base_from_flange = node_.planner().baseFromFlange(position)};
    if (options_.axes > kArmAxes) {
        shown.jaw_width = position[kGripper] / 1000.0;
        shown.gripping = bus_.grips();
    }
    return shown;
}

std::optional<double> Robot::partWidth(const WorldEffect& effect) {
    part_lost_ = part_lost_ && effect.part_width.has_value();
    if (!effect.part_width || part_lost_) {
        return std::nullopt;
    }
    return *effect.part_width * 1000.0;
}

void Robot::sayMode() {
    if (node_.publishes() && wants("/algorithm_state")) {
        send("/algorithm_state", Json::object({{"data", static_cast<int>(node_.mode())}}));
    }
}

std::vector<double> Robot::targets() const {
    const auto& target = node_.target();
    return {target.begin(), target.begin() + static_cast<std::ptrdiff_t>(node_.axes())};
}

bool Robot::nodeCommands() const {
    return node_.publishes() && node_.mode() != AlgorithmMode::uninitialised;
}

void Robot::publishControl() {
    if (!nodeCommands()) {
        return;
    }
    bus_.command(targets());
    if (!wants("/algo_jnt_ctrl")) {
        return;
    }
    Json joints = Json::array();
    for (std::size_t axis = 0; axis < node_.axes(); ++axis) {
        Json joint{{"position", finiteOrNull(node_.target()[axis])},
                   {"velocity", finiteOrNull(node_.velocity()[axis])},
                   {"current", 0.0},
                   {"ff_velocity", 0.0},
                   {"ff_current", 0.0}};
        if (options_.software.residuals) {
            joint["R_rasp"] = 0.0;
        }
        joints.push_back(std::move(joint));
    }
    send("/algo_jnt_ctrl", {{"size", node_.axes()}, {"joints", joints}});
}

Json Robot::jointState(const JointReport& joint) const {
    const unsigned flags = options_.software.external_control ? joint.flags : joint.flags & 0xFFU;
    Json state{{"position", finiteOrNull(joint.position)},
               {"velocity", finiteOrNull(joint.velocity)},
               {"current", finiteOrNull(joint.current)},
               {"commandFlag", flags}};
    if (options_.software.residuals) {
        state["R_jnt"] = 0.0;
    }
    return state;
}

Json Robot::jointStates(const BusReport& report) const {
    Json joints = Json::array();
    for (const auto& joint : report.joints) {
        joints.push_back(jointState(joint));
    }
    return Json::object({{"joints_mask", report.mask}, {"joints", joints}});
}

void Robot::publishJointStates(const BusReport& report) {
    if (wants("/usb_jnt_state")) {
        send("/usb_jnt_state", jointStates(report));
    }
    // Forwarded by the state machine, which knows the joints only once it is configured.
    if (machine_.axes() == 0 || report.joints.size() != machine_.axes()) {
        return;
    }
    if (wants("/machine_bridge_jnt_state")) {
        send("/machine_bridge_jnt_state", jointStates(report));
    }
    if (wants("/app_jnt_state")) {
        Json joints = Json::array();
        for (const auto& joint : report.joints) {
            joints.push_back({{"position", finiteOrNull(joint.position)},
                              {"velocity", finiteOrNull(joint.velocity)}});
        }
        send("/app_jnt_state", {{"joints_mask", report.mask}, {"joints", joints}});
    }
}

void Robot::publishSlowTopics() {
    if (wants("/machine_state")) {
        send("/machine_state", {{"current_state", static_cast<int>(machine_.state())},
                                {"opcode", machine_.opcode()}});
    }
    if (node_.publishesPose() && wants("/cartesian_pose")) {
        send("/cartesian_pose", toJson(node_.pose()));
    }
}

void Robot::publishFeedback(Feedback feedback) {
    send("/machine_movement_ack",
         {{"type", static_cast<int>(feedback.type)}, {"data", static_cast<int>(feedback.data)}});
}

void Robot::publishBrakesCheck(std::int8_t state, std::uint8_t mask) {
    send("/brakes_check_ack", {{"state", state}, {"mask", mask}});
}

motion::JointVector Robot::jointPosition() const {
    return armRadians(bus_.truePosition());
}

Json Robot::state() const {
    const auto report = bus_.report();
    Json joints = Json::array();
    const AxisValues position = bus_.truePosition();
    for (std::size_t axis = 0; axis < kArmAxes; ++axis) {
        joints.push_back(position[axis] * kDegree);
    }
    Json shown{{"software", options_.software.version},
               {"machine_state", static_cast<int>(machine_.state())},
               {"opcode", machine_.opcode()},
               {"algorithm_state", static_cast<int>(node_.mode())},
               {"control_taken", node_.isSwitchedOff()},
               {"brakes", bus_.isBraked()},
               {"emergency_stop", bus_.emergencyStop()},
               {"joint_position", joints}};
    if (options_.axes > kArmAxes) {
        shown["jaw_width"] = position[kGripper] / 1000.0;
        shown["gripping"] = bus_.grips();
    }
    return shown;
}

}  // namespace metier::virtual_edo
