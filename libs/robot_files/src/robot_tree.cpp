#include "robot_tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

namespace metier::robot_files {

RobotTree RobotTree::read(XmlFile& file) {
    RobotTree tree;
    const auto robot = file.root();
    if (std::string_view(robot.name()) != "robot") {
        file.note(robot, "no URDF file: its outermost element is not <robot>");
        return tree;
    }
    tree.readLinks(file);
    std::set<std::string_view> names;
    for (const auto element : robot.children("joint")) {
        if (!names.insert(element.attribute("name").value()).second) {
            file.note(element, "a second joint of this name");
        }
        tree.readJoint(file, element);
    }
    tree.refuseRings(file);
    return tree;
}

void RobotTree::readLinks(XmlFile& file) {
    for (const auto element : file.root().children("link")) {
        auto name = file.text(element, "name");
        if (!by_name_.emplace(name, links_.size()).second) {
            file.note(element, "a second link of this name");
        }
        links_.push_back({std::move(name), element, std::nullopt, {}});
    }
    if (links_.empty()) {
        file.note(file.root(), "it has no link");
    }
}

std::optional<std::size_t> RobotTree::linkOf(XmlFile& file, pugi::xml_node joint,
                                             const char* end) const {
    const auto element = joint.child(end);
    const std::string name = element.attribute("link").value();
    const auto found = link(name);
    if (!element) {
        file.note(joint, fmt::format("no <{}>", end));
    } else if (!found) {
        file.note(joint, fmt::format("its {} link \"{}\" is not in the file", end, name));
    }
    return found;
}

void RobotTree::readJoint(XmlFile& file, pugi::xml_node element) {
    TreeJoint joint{file.text(element, "name"), file.text(element, "type"), 0, 0, element};
    const auto parent = linkOf(file, element, "parent");
    const auto child = linkOf(file, element, "child");
    if (!parent || !child) {
        return;
    }
    if (const auto other = links_[*child].joint_to_parent) {
        file.note(element,
                  fmt::format("its child link \"{}\" has a parent by joint \"{}\" already: closed "
                              "kinematic chains cannot be taken in",
                              links_[*child].name, joints_[*other].name));
        return;
    }
    joint.parent = *parent;
    joint.child = *child;
    links_[*child].joint_to_parent = joints_.size();
    links_[*parent].joints_to_children.push_back(joints_.size());
    joints_.push_back(std::move(joint));
}

void RobotTree::refuseRings(XmlFile& file) const {
    // Every link is below one without a parent, unless it is in a ring or behind one.
    std::vector<bool> below(links_.size(), false);
    std::vector<std::size_t> open;
    for (std::size_t i = 0; i < links_.size(); ++i) {
        if (!links_[i].joint_to_parent) {
            open.push_back(i);
        }
    }
    while (!open.empty()) {
        const auto at = open.back();
        open.pop_back();
        below[at] = true;
        for (const auto joint : links_[at].joints_to_children) {
            open.push_back(joints_[joint].child);
        }
    }
    for (std::size_t i = 0; i < links_.size(); ++i) {
        if (!below[i]) {
            file.note(links_[i].element, "it is in a ring of joints, or behind one");
        }
    }
}

std::optional<std::size_t> RobotTree::link(const std::string& name) const {
    const auto found = by_name_.find(name);
    return found == by_name_.end() ? std::nullopt : std::optional(found->second);
}

std::vector<std::size_t> RobotTree::heldBy(std::size_t link) const {
    std::vector<std::size_t> held{link};
    for (std::size_t i = 0; i < held.size(); ++i) {
        for (const auto joint : links_[held[i]].joints_to_children) {
            if (joints_[joint].isFixed()) {
                held.push_back(joints_[joint].child);
            }
        }
    }
    return held;
}

std::optional<std::vector<std::size_t>> RobotTree::path(std::size_t from, std::size_t to) const {
    std::vector<std::size_t> joints;
    while (to != from) {
        const auto up = links_[to].joint_to_parent;
        if (!up) {
            return std::nullopt;
        }
        joints.push_back(*up);
        to = joints_[*up].parent;
    }
    std::reverse(joints.begin(), joints.end());
    return joints;
}

}  // namespace metier::robot_files
