#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "xml_file.hpp"

namespace metier::robot_files {

/// A joint of a URDF file. Links and joints are named by their places in RobotTree.
struct TreeJoint {
    std::string name;
    std::string type;
    std::size_t parent = 0;
    std::size_t child = 0;
    pugi::xml_node element;

    bool isFixed() const { return type == "fixed"; }
    /// Whether it turns about one axis.
    bool turns() const { return type == "revolute" || type == "continuous"; }
    bool isMimic() const { return element.child("mimic"); }
    /// Whether an axis of a model can be made of it.
    bool canBeAxis() const { return turns() && !isMimic(); }
};

struct TreeLink {
    std::string name;
    pugi::xml_node element;
    std::optional<std::size_t> joint_to_parent;
    std::vector<std::size_t> joints_to_children;
};

/// The links and joints of a URDF file, which are one or more trees.
class RobotTree {
public:
    /// Notes errors in the file: names that are missing or given twice, joints whose links are not
    /// there, links with two parents, rings.
    static RobotTree read(XmlFile& file);

    const std::vector<TreeLink>& links() const noexcept { return links_; }
    const std::vector<TreeJoint>& joints() const noexcept { return joints_; }
    std::optional<std::size_t> link(const std::string& name) const;
    /// The link itself and all that fixed joints hold to it or to those, nearest first.
    std::vector<std::size_t> heldBy(std::size_t link) const;
    /// The joints from one link down to another; nothing if the second is not behind the first.
    std::optional<std::vector<std::size_t>> path(std::size_t from, std::size_t to) const;

private:
    void readLinks(XmlFile& file);
    void readJoint(XmlFile& file, pugi::xml_node element);
    std::optional<std::size_t> linkOf(XmlFile& file, pugi::xml_node joint, const char* end) const;
    void refuseRings(XmlFile& file) const;

    std::vector<TreeLink> links_;
    std::vector<TreeJoint> joints_;
    std::map<std::string, std::size_t> by_name_;
};

}  // namespace metier::robot_files
