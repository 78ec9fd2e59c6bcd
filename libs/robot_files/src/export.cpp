#include "metier/robot_files/export.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <pugixml.hpp>
#include <set>
#include <sstream>

#include "metier/motion/frame.hpp"

namespace metier::robot_files {

namespace {

using Eigen::Vector3d;
using motion::Pose;
using motion::RobotModel;

constexpr const char* kBase = "base_link";
constexpr const char* kFlange = "tool0";
constexpr const char* kGroup = "manipulator";

void set(pugi::xml_node element, const char* attribute, const std::string& value) {
    element.append_attribute(attribute).set_value(value.c_str());
}

void set(pugi::xml_node element, const char* attribute, double value) {
    set(element, attribute, fmt::format("{}", value));
}

void set(pugi::xml_node element, const char* attribute, const Vector3d& value) {
    // Adding 0 leaves no -0.
    set(element, attribute,
        fmt::format("{} {} {}", value.x() + 0.0, value.y() + 0.0, value.z() + 0.0));
}

void addOrigin(pugi::xml_node element, const Pose& pose) {
    const auto frame = motion::toFrame(pose);
    auto origin = element.append_child("origin");
    set(origin, "xyz", Vector3d(frame.x, frame.y, frame.z));
    set(origin, "rpy", Vector3d(frame.a, frame.b, frame.c));
}

std::string textOf(const pugi::xml_document& document) {
    std::ostringstream text;
    document.save(text, "  ");
    return text.str();
}

/// The frame half way between two points, its z axis towards the second.
Pose between(const Vector3d& from, const Vector3d& to) {
    return {(from + to) / 2, Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), to - from)};
}

/// Names that no two links or joints share.
class Names {
public:
    std::string taken(std::string name) {
        name = name.empty() ? "unnamed" : name;
        while (!taken_.insert(name).second) {
            name += '_';
        }
        return name;
    }

private:
    std::set<std::string> taken_;
};

class UrdfWriter {
public:
    explicit UrdfWriter(const RobotModel& model);
    ExportedRobot write();

private:
    void addLinks();
    void addAxis(std::size_t axis);
    void addFixed(const std::string& parent, const std::string& child, const Pose& place);
    void addVisual(pugi::xml_node link, const motion::VisualPrimitive& shape);
    void addCapsule(pugi::xml_node link, const motion::Capsule& capsule);
    static void addBall(pugi::xml_node element, const Vector3d& centre, double radius);
    std::string semantics() const;
    void listLeftOut();

    const RobotModel& model_;
    pugi::xml_document document_;
    pugi::xml_node robot_;
    Names links_;
    Names joints_;
    std::vector<std::string> link_names_;
    std::vector<std::string> joint_names_;
    std::size_t cones_ = 0;
    std::vector<std::string> left_out_;
};

UrdfWriter::UrdfWriter(const RobotModel& model) : model_(model) {
    document_.append_child(pugi::node_comment)
        .set_value(" Made by metier robot export. effort: metier knows none. ");
    robot_ = document_.append_child("robot");
    set(robot_, "name", std::string(model.name()));
    link_names_.push_back(links_.taken(kBase));
    for (std::size_t i = 0; i < model.axisCount(); ++i) {
        link_names_.push_back(links_.taken(fmt::format("link_{}", i + 1)));
        joint_names_.push_back(joints_.taken(model.chain().joints[i].name));
    }
}

void UrdfWriter::addBall(pugi::xml_node element, const Vector3d& centre, double radius) {
    addOrigin(element, {centre, Eigen::Quaterniond::Identity()});
    set(element.append_child("geometry").append_child("sphere"), "radius", radius);
}

void addCylinder(pugi::xml_node element, const Pose& place, double length, double radius) {
    addOrigin(element, place);
    auto cylinder = element.append_child("geometry").append_child("cylinder");
    set(cylinder, "length", length);
    set(cylinder, "radius", radius);
}

/// A sphere, a cylinder, or a cone as the cylinder around it.
void UrdfWriter::addVisual(pugi::xml_node link, const motion::VisualPrimitive& shape) {
    const double length = (shape.to - shape.from).norm();
    const double radius = std::max(shape.from_radius, shape.to_radius);
    constexpr double rounding = 1e-9;
    if (length < rounding) {
        ++cones_;
        return;
    }
    const bool even = std::abs(shape.from_radius - shape.to_radius) < rounding;
    const bool ball =
        even && shape.edge > radius - rounding && std::abs(length - 2 * radius) < rounding;
    cones_ += ball || (even && shape.edge <= 0) ? 0 : 1;
    auto visual = link.append_child("visual");
    if (ball) {
        addBall(visual, (shape.from + shape.to) / 2, radius);
    } else {
        addCylinder(visual, between(shape.from, shape.to), length, radius);
    }
    auto color = visual.append_child("material");
    set(color, "name",
        fmt::format("color_{:.3f}_{:.3f}_{:.3f}", shape.color[0], shape.color[1], shape.color[2]));
    set(color.append_child("color"), "rgba",
        fmt::format("{} {} {} 1", shape.color[0], shape.color[1], shape.color[2]));
}

/// A cylinder with a ball at each end.
void UrdfWriter::addCapsule(pugi::xml_node link, const motion::Capsule& capsule) {
    constexpr double rounding = 1e-9;
    const double length = (capsule.to - capsule.from).norm();
    if (length < rounding) {
        addBall(link.append_child("collision"), capsule.from, capsule.radius);
        return;
    }
    addCylinder(link.append_child("collision"), between(capsule.from, capsule.to), length,
                capsule.radius);
    addBall(link.append_child("collision"), capsule.from, capsule.radius);
    addBall(link.append_child("collision"), capsule.to, capsule.radius);
}

void UrdfWriter::addLinks() {
    for (std::size_t number = 0; number < link_names_.size(); ++number) {
        auto link = robot_.append_child("link");
        set(link, "name", link_names_[number]);
        for (const auto& shape : model_.visual()) {
            if (shape.link == number) {
                addVisual(link, shape);
            }
        }
        for (const auto& capsule : model_.capsules()) {
            if (capsule.link == number) {
                addCapsule(link, capsule);
            }
        }
    }
}

void UrdfWriter::addAxis(std::size_t axis) {
    const auto& description = model_.chain().joints[axis];
    const auto& limits = description.limits;
    auto joint = robot_.append_child("joint");
    set(joint, "name", joint_names_[axis]);
    set(joint, "type", std::string("revolute"));
    addOrigin(joint, description.parent_from_joint);
    set(joint.append_child("parent"), "link", link_names_[axis]);
    set(joint.append_child("child"), "link", link_names_[axis + 1]);
    set(joint.append_child("axis"), "xyz", description.axis);
    auto limit = joint.append_child("limit");
    set(limit, "lower", limits.lower);
    set(limit, "upper", limits.upper);
    set(limit, "effort", 0.0);
    set(limit, "velocity", limits.velocity);
    set(limit, "acceleration", limits.acceleration);
    set(limit, "jerk", limits.jerk);
}

void UrdfWriter::addFixed(const std::string& parent, const std::string& child, const Pose& place) {
    set(robot_.append_child("link"), "name", child);
    auto joint = robot_.append_child("joint");
    set(joint, "name", joints_.taken(child + "_fixed"));
    set(joint, "type", std::string("fixed"));
    addOrigin(joint, place);
    set(joint.append_child("parent"), "link", parent);
    set(joint.append_child("child"), "link", child);
}

void addPair(pugi::xml_node robot, const std::string& first, const std::string& second,
             const char* reason) {
    auto pair = robot.append_child("disable_collisions");
    set(pair, "link1", first);
    set(pair, "link2", second);
    set(pair, "reason", std::string(reason));
}

std::string UrdfWriter::semantics() const {
    pugi::xml_document document;
    auto robot = document.append_child("robot");
    set(robot, "name", std::string(model_.name()));
    auto group = robot.append_child("group");
    set(group, "name", std::string(kGroup));
    auto chain = group.append_child("chain");
    set(chain, "base_link", std::string(kBase));
    set(chain, "tip_link", std::string(kFlange));
    auto state = robot.append_child("group_state");
    set(state, "name", std::string("home"));
    set(state, "group", std::string(kGroup));
    for (std::size_t i = 0; i < model_.axisCount(); ++i) {
        auto joint = state.append_child("joint");
        set(joint, "name", joint_names_[i]);
        set(joint, "value", model_.home()[i]);
    }
    for (std::size_t first = 0; first < link_names_.size(); ++first) {
        for (std::size_t apart = 1; apart < motion::kLeastJointsBetween; ++apart) {
            if (first + apart < link_names_.size()) {
                addPair(robot, link_names_[first], link_names_[first + apart],
                        apart == 1 ? "Adjacent" : "User");
            }
        }
    }
    for (const auto& pair : model_.notCompared()) {
        const auto [low, high] = std::minmax(pair.first, pair.second);
        if (high - low >= motion::kLeastJointsBetween) {
            addPair(robot, link_names_[low], link_names_[high], "User");
        }
    }
    return textOf(document);
}

void UrdfWriter::listLeftOut() {
    left_out_.emplace_back("maker, product, cycle time and Cartesian limits");
    if (cones_ > 0) {
        left_out_.push_back(fmt::format(
            "round edges and unequal radii of {} shapes to draw: cylinders around them are written",
            cones_));
    }
    const auto& tools = model_.chain().tools;
    const auto heavy = std::count_if(tools.begin(), tools.end(),
                                     [](const motion::ToolFrame& tool) { return tool.mass > 0; });
    if (heavy > 0) {
        left_out_.push_back(fmt::format("the masses of {} tools", heavy));
    }
}

ExportedRobot UrdfWriter::write() {
    addLinks();
    for (std::size_t axis = 0; axis < model_.axisCount(); ++axis) {
        addAxis(axis);
    }
    const auto flange = links_.taken(kFlange);
    addFixed(link_names_.back(), flange, model_.chain().last_from_flange);
    for (const auto& tool : model_.chain().tools) {
        addFixed(flange, links_.taken(tool.name), tool.flange_from_tool);
    }
    listLeftOut();
    return {textOf(document_), semantics(), left_out_};
}

}  // namespace

ExportedRobot exportUrdf(const RobotModel& model) {
    return UrdfWriter(model).write();
}

}  // namespace metier::robot_files
