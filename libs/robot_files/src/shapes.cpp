#include "shapes.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

namespace metier::robot_files {

namespace {

using Eigen::Vector3d;
using motion::Capsule;
using motion::Pose;
using motion::VisualPrimitive;

constexpr double kLongest = 1e4;  // [m]
constexpr std::array<double, 3> kGrey{0.75, 0.75, 0.75};

/// A cylinder about the line between two points; round ends if `round`.
struct Rod {
    Vector3d from;
    Vector3d to;
    double radius = 0;
    bool round = false;
};

/// Half the length along one axis of a shape's frame.
Vector3d half(double length, Eigen::Index axis) {
    Vector3d end = Vector3d::Zero();
    end[axis] = length / 2;
    return end;
}

/// The capsule around a box, along its longest side.
Rod aroundBox(const Vector3d& size) {
    Eigen::Index longest = 0;
    size.maxCoeff(&longest);
    const Vector3d end = half(size[longest], longest);
    const double across = size.squaredNorm() - size[longest] * size[longest];
    return {-end, end, std::sqrt(across) / 2, false};
}

/// The cylinder that looks most like a box: along the side that differs most from the others, with
/// a cross section of the same area.
Rod likeBox(const Vector3d& size) {
    Eigen::Index along = 0;
    double least = std::numeric_limits<double>::infinity();
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
        const double a = size[(axis + 1) % 3];
        const double b = size[(axis + 2) % 3];
        const double unlike = std::max(a, b) / std::min(a, b);
        if (unlike < least) {
            least = unlike;
            along = axis;
        }
    }
    const Vector3d end = half(size[along], along);
    const double area = size[(along + 1) % 3] * size[(along + 2) % 3];
    return {-end, end, std::sqrt(area / std::numbers::pi), false};
}

enum class Use { collision, visual };

class ShapeReader {
public:
    ShapeReader(XmlFile& file, motion::RobotAppearance& appearance)
        : file_(file), appearance_(appearance) {}

    void read(std::size_t number, pugi::xml_node link, const Pose& frame_from_link);
    void finish(std::vector<std::string>& left_out) const;

private:
    std::optional<Rod> rodOf(pugi::xml_node element, Use use);
    std::optional<Rod> roundShape(pugi::xml_node geometry);
    Vector3d boxSize(pugi::xml_node box);
    double length(pugi::xml_node shape, const char* attribute);
    void addCapsule(std::size_t number, const Rod& rod);
    void addVisual(std::size_t number, const Rod& rod, const std::array<double, 3>& color);
    std::array<double, 3> colorOf(pugi::xml_node visual);

    XmlFile& file_;
    motion::RobotAppearance& appearance_;
    std::map<std::pair<std::string, Use>, std::vector<std::size_t>> left_out_;  // lines
    bool empty_ = false;                    ///< the shape that is being read has a size of 0
    std::vector<std::size_t> drawn_boxes_;  // lines
};

/// A sphere, cylinder or capsule; nothing if the element is another.
std::optional<Rod> ShapeReader::roundShape(pugi::xml_node geometry) {
    if (const auto sphere = geometry.child("sphere")) {
        return Rod{Vector3d::Zero(), Vector3d::Zero(), length(sphere, "radius"), true};
    }
    for (const char* name : {"cylinder", "capsule"}) {
        if (const auto shape = geometry.child(name)) {
            const Vector3d end = half(length(shape, "length"), 2);
            return Rod{-end, end, length(shape, "radius"), std::string_view(name) == "capsule"};
        }
    }
    return std::nullopt;
}

/// A length; `empty_` is set if it is not over 0.
double ShapeReader::length(pugi::xml_node shape, const char* attribute) {
    const auto value = file_.number(shape, attribute);
    if (!shape.attribute(attribute)) {
        file_.note(shape, fmt::format("no {}", attribute));
    } else if (value && *value > kLongest) {
        file_.note(shape, fmt::format("{} of {} m, at most {} m", attribute, *value, kLongest));
    }
    empty_ = empty_ || (value && *value <= 0.0);
    return value.value_or(0.0);
}

Vector3d ShapeReader::boxSize(pugi::xml_node box) {
    Vector3d size = file_.vector(box, "size", Vector3d::Zero());
    empty_ = empty_ || size.minCoeff() <= 0.0;
    return size;
}

std::optional<Rod> ShapeReader::rodOf(pugi::xml_node element, Use use) {
    const auto geometry = element.child("geometry");
    empty_ = false;
    auto rod = roundShape(geometry);
    const auto box = geometry.child("box");
    if (!rod && box) {
        const auto size = boxSize(box);
        rod = use == Use::visual && !empty_ ? likeBox(size) : aroundBox(size);
    }
    if (rod && !empty_) {
        if (box && use == Use::visual) {
            drawn_boxes_.push_back(file_.line(element));
        }
        return rod;
    }
    const auto other = geometry.first_child();
    const char* name = rod ? "a size of 0" : other ? other.name() : "no geometry";
    left_out_[{name, use}].push_back(file_.line(element));
    return std::nullopt;
}

void ShapeReader::addCapsule(std::size_t number, const Rod& rod) {
    // Balls at the ends of a cylinder, as metier exports a capsule, are in the cylinder's capsule.
    const auto inside = [&](const Capsule& other) {
        constexpr double rounding = 1e-9;
        const bool ball = (rod.from - rod.to).norm() < rounding;
        return ball && other.link == number && rod.radius <= other.radius + rounding &&
               std::min((rod.from - other.from).norm(), (rod.from - other.to).norm()) < rounding;
    };
    auto& capsules = appearance_.capsules;
    if (std::none_of(capsules.begin(), capsules.end(), inside)) {
        capsules.push_back({number, rod.from, rod.to, rod.radius});
    }
}

std::array<double, 3> ShapeReader::colorOf(pugi::xml_node visual) {
    const auto material = visual.child("material");
    auto color = material.child("color");
    if (!color) {
        color = file_.root()
                    .find_child_by_attribute("material", "name", material.attribute("name").value())
                    .child("color");
    }
    const auto rgba = numbersIn(color.attribute("rgba").value());
    if (!rgba || rgba->size() < 3) {
        return kGrey;
    }
    return {std::clamp((*rgba)[0], 0.0, 1.0), std::clamp((*rgba)[1], 0.0, 1.0),
            std::clamp((*rgba)[2], 0.0, 1.0)};
}

void ShapeReader::addVisual(std::size_t number, const Rod& rod,
                            const std::array<double, 3>& color) {
    VisualPrimitive shape{number, rod.from, rod.to, rod.radius, rod.radius, color};
    if (rod.round) {
        const Vector3d along =
            (rod.to - rod.from).norm() > 0 ? (rod.to - rod.from).normalized() : Vector3d::UnitZ();
        shape.from -= rod.radius * along;
        shape.to += rod.radius * along;
        shape.edge = rod.radius;
    }
    appearance_.visual.push_back(shape);
}

void ShapeReader::read(std::size_t number, pugi::xml_node link, const Pose& frame_from_link) {
    const auto placed = [&](pugi::xml_node element, Use use) {
        auto rod = rodOf(element, use);
        if (rod) {
            const Pose frame_from_shape = frame_from_link * file_.origin(element);
            rod->from = frame_from_shape * rod->from;
            rod->to = frame_from_shape * rod->to;
        }
        return rod;
    };
    for (const auto element : link.children("collision")) {
        if (const auto rod = placed(element, Use::collision)) {
            addCapsule(number, *rod);
        }
    }
    for (const auto element : link.children("visual")) {
        if (const auto rod = placed(element, Use::visual)) {
            addVisual(number, *rod, colorOf(element));
        }
    }
}

std::string lines(const std::vector<std::size_t>& numbers) {
    return fmt::format("line{} {}", numbers.size() == 1 ? "" : "s", fmt::join(numbers, ", "));
}

void ShapeReader::finish(std::vector<std::string>& left_out) const {
    for (const auto& [kind, at] : left_out_) {
        const auto& [name, use] = kind;
        const bool mesh = name == "mesh";
        const auto why =
            !mesh ? "a model has no such shape"
            : use == Use::visual
                ? "a model has no meshes; metier dashboard --meshes draws those of the "
                  "URDF file"
                : "self-collision needs capsules; [[capsule]] in the model file adds "
                  "them";
        left_out.push_back(fmt::format("{} <{}> with {} ({}): {}", at.size(),
                                       use == Use::visual ? "visual" : "collision", name, lines(at),
                                       why));
    }
    if (!drawn_boxes_.empty()) {
        left_out.push_back(fmt::format("corners of {} <visual> with box ({}): drawn as cylinders",
                                       drawn_boxes_.size(), lines(drawn_boxes_)));
    }
    if (appearance_.capsules.size() > motion::kMostCapsules) {
        left_out.push_back(fmt::format("{} of {} capsules: self-collision looks at the first {}",
                                       appearance_.capsules.size() - motion::kMostCapsules,
                                       appearance_.capsules.size(), motion::kMostCapsules));
    }
}

bool hasCollision(const RobotTree& tree, const HeldLink& held) {
    return tree.links()[held.link].element.child("collision");
}

/// Number of pairs of links in the file, and how many of them are disabled.
struct PairCount {
    std::size_t all = 0;
    std::size_t disabled = 0;
};

}  // namespace

LinkGroups groupLinks(const ChosenChain& chain, Angles angles) {
    const auto& [file, tree, choice] = chain;
    LinkGroups groups;
    for (std::size_t number = 0; number <= choice.axes.size(); ++number) {
        const auto first = number == 0 ? choice.base : tree.joints()[choice.axes[number - 1]].child;
        std::vector<HeldLink> group;
        std::map<std::size_t, Pose> places{{first, Pose::identity()}};
        for (const auto link : tree.heldBy(first)) {
            if (link != first) {
                const auto& joint = tree.joints()[*tree.links()[link].joint_to_parent];
                places[link] =
                    places[joint.parent] * file.origin(joint.element, angles == Angles::rounded);
            }
            group.push_back({link, places[link]});
        }
        groups.push_back(std::move(group));
    }
    return groups;
}

void readShapes(const ChosenChain& chain, const LinkGroups& groups,
                motion::RobotAppearance& appearance, std::vector<std::string>& left_out) {
    ShapeReader reader(chain.file, appearance);
    for (std::size_t number = 0; number < groups.size(); ++number) {
        for (const auto& held : groups[number]) {
            reader.read(number, chain.tree.links()[held.link].element, held.frame_from_link);
        }
    }
    reader.finish(left_out);
}

std::vector<motion::ToolFrame> readTools(const ChosenChain& chain, Angles angles,
                                         std::vector<std::string>& left_out) {
    const auto& [file, tree, choice] = chain;
    std::vector<motion::ToolFrame> tools;
    std::map<std::size_t, Pose> places{{choice.tip, Pose::identity()}};
    for (const auto link : tree.heldBy(choice.tip)) {
        if (link == choice.tip) {
            continue;
        }
        const auto& joint = tree.joints()[*tree.links()[link].joint_to_parent];
        places[link] = places[joint.parent] * file.origin(joint.element, angles == Angles::rounded);
        const auto& name = tree.links()[link].name;
        if (name == "flange") {
            left_out.push_back(fmt::format("link \"flange\" (line {}) as a tool: the name is taken",
                                           file.line(tree.links()[link].element)));
            continue;
        }
        tools.push_back({name, places[link], 0, Vector3d::Zero()});
    }
    return tools;
}

/// How many pairs of shapes two groups of links make, and how many of them are disabled.
PairCount countPairs(const RobotTree& tree, const Semantics& semantics, const LinkGroup& first,
                     const LinkGroups::value_type& second) {
    PairCount counted;
    for (const auto& a : first) {
        for (const auto& b : second) {
            if (hasCollision(tree, a) && hasCollision(tree, b)) {
                ++counted.all;
                const auto& name = tree.links()[a.link].name;
                counted.disabled += semantics.isDisabled(name, tree.links()[b.link].name) ? 1 : 0;
            }
        }
    }
    return counted;
}

std::vector<motion::UncomparedLinks> readUncompared(const RobotTree& tree, const LinkGroups& groups,
                                                    const Semantics& semantics,
                                                    std::vector<std::string>& remarks) {
    std::vector<motion::UncomparedLinks> pairs;
    std::vector<std::string> partly;
    for (std::size_t first = 0; first < groups.size(); ++first) {
        for (auto second = first + motion::kLeastJointsBetween; second < groups.size(); ++second) {
            const auto counted = countPairs(tree, semantics, groups[first], groups[second]);
            if (counted.all > 0 && counted.disabled == counted.all) {
                pairs.push_back({first, second});
            } else if (counted.disabled > 0) {
                partly.push_back(fmt::format("{} and {}", first, second));
            }
        }
    }
    if (!partly.empty()) {
        remarks.push_back(
            fmt::format("links {} are compared although the SRDF file disables some of their pairs",
                        fmt::join(partly, ", ")));
    }
    return pairs;
}

std::vector<std::string> jointsBeside(const ChosenChain& chain, const LinkGroups& groups) {
    std::vector<std::string> texts;
    const auto addThoseOf = [&](const HeldLink& held) {
        const auto& [file, tree, choice] = chain;
        for (const auto index : tree.links()[held.link].joints_to_children) {
            const auto& joint = tree.joints()[index];
            const bool axis =
                std::find(choice.axes.begin(), choice.axes.end(), index) != choice.axes.end();
            if (!joint.isFixed() && !axis) {
                texts.push_back(fmt::format(
                    "joint \"{}\" ({}{}, line {}) and everything behind it: beside the chain",
                    joint.name, joint.type, joint.isMimic() ? ", mimic" : "",
                    file.line(joint.element)));
            }
        }
    };
    for (const auto& group : groups) {
        std::for_each(group.begin(), group.end(), addThoseOf);
    }
    return texts;
}

}  // namespace metier::robot_files
