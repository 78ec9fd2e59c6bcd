#include "metier/client/kinematics_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "questions.hpp"

namespace metier::client {
namespace {

using opcua::Answer;
using opcua::Client;
using opcua::NodeId;
using opcua_skill::KinematicsData;

using Children = std::map<std::string, NodeId, std::less<>>;

Answer<Children> childrenByName(Questions& questions, const NodeId& node) {
    METIER_ASSIGN(const auto references, questions.browse({.node = node, .node_classes = {}}));
    Children children;
    for (const auto& reference : references) {
        children.emplace(reference.browse_name.name, reference.target);
    }
    return children;
}

/// The value in that type. Errors: type_mismatch, with the name.
template <typename T>
Answer<T> typed(const opcua::Value& value, std::string_view name) {
    auto held = value.as<T>();
    if (!held) {
        return tl::unexpected(
            failureOf(held.error().code, fmt::format("{}: {}", name, held.error().message)));
    }
    return std::move(*held);
}

/// Reads values by name below one object; the first problem is kept.
class NamedReader {
public:
    NamedReader(Questions& questions, Children children)
        : questions_(questions), children_(std::move(children)) {}

    template <typename T>
    void read(std::string_view name, T& target) {
        if (done_) {
            done_ = tryRead(name, target);
        }
    }

    const Answer<>& done() const { return done_; }

private:
    template <typename T>
    Answer<> tryRead(std::string_view name, T& target) {
        const auto found = children_.find(name);
        if (found == children_.end()) {
            return tl::unexpected(failureOf(Errc::not_found,
                                            fmt::format("Kinematics has no {}", name),
                                            opcua::status::kBadNoMatch));
        }
        METIER_ASSIGN(const auto value, questions_.read(found->second));
        METIER_ASSIGN(target, typed<T>(value, fmt::format("Kinematics/{}", name)));
        return {};
    }

    Questions& questions_;
    Children children_;
    Answer<> done_;
};

Answer<> checkLengths(const KinematicsData& data) {
    const auto axes = data.axisCount();
    const std::array lengths{data.joint_frames.size(),           data.min_joint_position.size(),
                             data.max_joint_position.size(),     data.max_joint_velocity.size(),
                             data.max_joint_acceleration.size(), data.max_joint_jerk.size()};
    const bool same = std::all_of(lengths.begin(), lengths.end(),
                                  [axes](std::size_t length) { return length == axes; });
    constexpr std::size_t kAlongAndAbout = 2;
    if (!same || axes == 0 || data.max_cartesian_velocity.size() != kAlongAndAbout ||
        data.max_cartesian_acceleration.size() != kAlongAndAbout ||
        data.max_cartesian_jerk.size() != kAlongAndAbout) {
        return tl::unexpected(
            failureOf(Errc::invalid_argument,
                      fmt::format("Kinematics: lists do not fit an arm of {} axes", axes)));
    }
    return {};
}

Answer<KinematicsNodes> nodesOf(Questions& questions, const Children::value_type& device,
                                const NodeId& object) {
    METIER_ASSIGN(const auto children, childrenByName(questions, object));
    KinematicsNodes nodes;
    nodes.device_name = device.first;
    nodes.device = device.second;
    nodes.object = object;
    for (const auto* name : {"ActualJointPosition", "SafetyState", "MissedCycles"}) {
        if (!children.contains(name)) {
            return tl::unexpected(
                failureOf(Errc::not_found, fmt::format("Kinematics has no {}", name)));
        }
    }
    const std::array<std::pair<std::string_view, NodeId*>, 9> known{
        {{"ActualJointPosition", &nodes.actual_joint_position},
         {"SafetyState", &nodes.safety_state},
         {"MissedCycles", &nodes.missed_cycles},
         {"CommandedJointPosition", &nodes.commanded_joint_position},
         {"Standstill", &nodes.standstill},
         {"CycleJitter", &nodes.cycle_jitter},
         {"FlangeForce", &nodes.flange_force},
         {"FlangeTorque", &nodes.flange_torque},
         {"ActualPose", &nodes.actual_pose}}};
    for (const auto& [name, node] : known) {
        if (const auto found = children.find(name); found != children.end()) {
            *node = found->second;
        }
    }
    return nodes;
}

/// FlangeLoad/Mass of the motion device [kg]; 0 if it says nothing of use.
Answer<double> readPayload(Questions& questions, const NodeId& device) {
    NodeId node = device;
    for (const auto* name : {"FlangeLoad", "Mass"}) {
        METIER_ASSIGN(const auto children, childrenByName(questions, node));
        const auto found = children.find(name);
        if (found == children.end()) {
            return 0.0;
        }
        node = found->second;
    }
    const auto mass = questions.read(node);
    const auto number = mass ? mass->as<double>() : Result<double>(0.0);
    return number && std::isfinite(*number) && *number > 0 ? *number : 0.0;
}

/// The Kinematics object below a folder `MotionDevices`; nothing if no device has one.
Answer<std::optional<KinematicsNodes>> searchDevices(Questions& questions, const NodeId& folder) {
    METIER_ASSIGN(const auto devices, childrenByName(questions, folder));
    for (const auto& device : devices) {
        METIER_ASSIGN(const auto parts, childrenByName(questions, device.second));
        if (const auto found = parts.find("Kinematics"); found != parts.end()) {
            METIER_ASSIGN(auto nodes, nodesOf(questions, device, found->second));
            return std::optional(std::move(nodes));
        }
    }
    return std::optional<KinematicsNodes>();
}

}  // namespace

Answer<KinematicsNodes> findKinematics(Client& client, const SkillAddress& skill) {
    Questions questions(client);
    for (auto object = skill.above.rbegin(); object != skill.above.rend(); ++object) {
        METIER_ASSIGN(const auto children, childrenByName(questions, object->node));
        const auto devices = children.find("MotionDevices");
        if (devices == children.end()) {
            continue;
        }
        METIER_ASSIGN(auto found, searchDevices(questions, devices->second));
        if (found) {
            return std::move(*found);
        }
    }
    return tl::unexpected(
        failureOf(Errc::not_found, skill.name + " belongs to no arm that publishes Kinematics"));
}

Answer<KinematicsData> readKinematics(Client& client, const KinematicsNodes& nodes) {
    Questions questions(client);
    METIER_ASSIGN(auto children, childrenByName(questions, nodes.object));
    NamedReader reader(questions, std::move(children));
    KinematicsData data;
    reader.read("BaseFromFirstJoint", data.base_from_first_joint);
    reader.read("LastJointFromFlange", data.last_joint_from_flange);
    reader.read("JointFrames", data.joint_frames);
    reader.read("JointAxes", data.joint_axes);
    reader.read("MinJointPosition", data.min_joint_position);
    reader.read("MaxJointPosition", data.max_joint_position);
    reader.read("MaxJointVelocity", data.max_joint_velocity);
    reader.read("MaxJointAcceleration", data.max_joint_acceleration);
    reader.read("MaxJointJerk", data.max_joint_jerk);
    reader.read("MaxCartesianVelocity", data.max_cartesian_velocity);
    reader.read("MaxCartesianAcceleration", data.max_cartesian_acceleration);
    reader.read("MaxCartesianJerk", data.max_cartesian_jerk);
    reader.read("CycleTime", data.cycle_time);
    reader.read("ToolFrames", data.tool_frames);
    METIER_TRY(reader.done());
    METIER_TRY(checkLengths(data));
    METIER_ASSIGN(data.payload, readPayload(questions, nodes.device));
    return data;
}

Answer<std::vector<double>> readJointPosition(Client& client, const KinematicsNodes& nodes) {
    METIER_ASSIGN(const auto value, client.read(nodes.actual_joint_position));
    return typed<std::vector<double>>(value, "ActualJointPosition");
}

Answer<std::uint64_t> readMissedCycles(Client& client, const KinematicsNodes& nodes) {
    METIER_ASSIGN(const auto value, client.read(nodes.missed_cycles));
    return typed<std::uint64_t>(value, "MissedCycles");
}

Answer<opcua::Subscription> subscribeJointPosition(
    Client& client, const KinematicsNodes& nodes, std::chrono::milliseconds interval,
    std::function<void(const std::vector<double>&)> callback) {
    constexpr std::uint32_t kQueue = 100;
    return client.subscribeData(
        nodes.actual_joint_position, {.sampling_interval = interval, .queue_size = kQueue},
        [callback = std::move(callback)](const opcua::DataValue& notice) {
            if (const auto joints = notice.value.as<std::vector<double>>()) {
                callback(*joints);
            }
        });
}

}  // namespace metier::client
