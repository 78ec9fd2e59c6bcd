#include "chain_choice.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>

#include "metier/motion/joint_vector.hpp"

namespace metier::robot_files {

namespace {

constexpr std::size_t kMostNamed = 12;

/// Joints to the last moved link of each candidate, with the last links behind it.
struct Candidate {
    std::size_t moved = 0;                ///< link behind the last axis
    std::vector<std::size_t> joints;      ///< from the base to `moved`
    std::vector<std::size_t> last_links;  ///< links without children, held by `moved`
};

class ChainChooser {
public:
    ChainChooser(XmlFile& file, const RobotTree& tree) : file_(file), tree_(tree) {}

    std::optional<ChainChoice> choose(const ChainEnds& ends);

private:
    std::optional<std::size_t> named(const std::string& name, const char* option);
    std::optional<std::size_t> onlyRoot();
    std::optional<ChainChoice> toTip(std::size_t base, std::size_t tip);
    std::optional<ChainChoice> withoutTip(std::size_t base);
    std::vector<Candidate> candidates(std::size_t base) const;
    ChainChoice endOf(std::size_t base, const Candidate& candidate) const;
    std::vector<std::size_t> axesOf(const std::vector<std::size_t>& joints) const;
    void refuseJoint(std::size_t joint);
    bool allAxes(const std::vector<std::size_t>& joints) const;
    void refuseCandidates(const std::vector<Candidate>& found);
    std::vector<Candidate> longest(const std::vector<Candidate>& found) const;
    std::string nameOf(std::size_t link) const { return '"' + tree_.links()[link].name + '"'; }

    XmlFile& file_;
    const RobotTree& tree_;
};

std::optional<ChainChoice> ChainChooser::choose(const ChainEnds& ends) {
    const auto base = ends.base.empty() ? onlyRoot() : named(ends.base, "--base");
    if (!base) {
        return std::nullopt;
    }
    if (ends.tip.empty()) {
        return withoutTip(*base);
    }
    const auto tip = named(ends.tip, "--tip");
    return tip ? toTip(*base, *tip) : std::nullopt;
}

std::optional<std::size_t> ChainChooser::named(const std::string& name, const char* option) {
    const auto link = tree_.link(name);
    if (!link) {
        std::vector<std::string> names;
        for (const auto& known : tree_.links()) {
            names.push_back(known.name);
        }
        const bool all = names.size() <= kMostNamed;
        names.resize(std::min(names.size(), kMostNamed));
        file_.note(file_.root(), fmt::format("{}: no link \"{}\"; there are: {}{}", option, name,
                                             fmt::join(names, ", "), all ? "" : ", ..."));
    }
    return link;
}

std::optional<std::size_t> ChainChooser::onlyRoot() {
    std::vector<std::size_t> roots;
    for (std::size_t i = 0; i < tree_.links().size(); ++i) {
        if (!tree_.links()[i].joint_to_parent) {
            roots.push_back(i);
        }
    }
    if (roots.size() == 1) {
        return roots.front();
    }
    for (const auto root : roots) {
        file_.note(
            tree_.links()[root].element,
            fmt::format("one of {} links without a parent: choose one with --base", roots.size()));
    }
    return std::nullopt;
}

std::vector<std::size_t> ChainChooser::axesOf(const std::vector<std::size_t>& joints) const {
    std::vector<std::size_t> axes;
    std::copy_if(joints.begin(), joints.end(), std::back_inserter(axes),
                 [&](std::size_t joint) { return !tree_.joints()[joint].isFixed(); });
    return axes;
}

bool ChainChooser::allAxes(const std::vector<std::size_t>& joints) const {
    const auto axes = axesOf(joints);
    return axes.size() <= motion::kMaxAxes &&
           std::all_of(axes.begin(), axes.end(),
                       [&](std::size_t joint) { return tree_.joints()[joint].canBeAxis(); });
}

/// Notes why the joint is no axis, and how to leave it out.
void ChainChooser::refuseJoint(std::size_t joint) {
    const auto& refused = tree_.joints()[joint];
    const auto why = refused.turns()
                         ? std::string(
                               "it follows another joint (<mimic>), and each axis of a "
                               "model turns by itself")
                         : fmt::format(
                               "its type is {}, and each axis of a model turns (revolute, "
                               "continuous)",
                               refused.type);
    file_.note(
        refused.element,
        fmt::format("{}: a chain may end before it (--tip {}) or begin behind it (--base {})", why,
                    nameOf(refused.parent), nameOf(refused.child)));
}

std::optional<ChainChoice> ChainChooser::toTip(std::size_t base, std::size_t tip) {
    const auto joints = tree_.path(base, tip);
    if (!joints) {
        file_.note(tree_.links()[tip].element,
                   fmt::format("it is not behind the base link {}", nameOf(base)));
        return std::nullopt;
    }
    ChainChoice choice{base, tip, *joints, axesOf(*joints), {}};
    for (const auto joint : choice.axes) {
        if (!tree_.joints()[joint].canBeAxis()) {
            refuseJoint(joint);
        }
    }
    if (choice.axes.empty()) {
        file_.note(tree_.links()[tip].element,
                   fmt::format("no joint turns between it and the base link {}", nameOf(base)));
    } else if (choice.axes.size() > motion::kMaxAxes) {
        file_.note(tree_.joints()[choice.axes[motion::kMaxAxes]].element,
                   fmt::format("axis {} of {}, at most {}: choose a part with --base and --tip",
                               motion::kMaxAxes + 1, choice.axes.size(), motion::kMaxAxes));
    }
    return file_.hasErrors() ? std::nullopt : std::optional(choice);
}

/// The chains to links without children, one for each link that the last axis of such a chain
/// moves.
std::vector<Candidate> ChainChooser::candidates(std::size_t base) const {
    std::map<std::size_t, Candidate> found;
    for (std::size_t leaf = 0; leaf < tree_.links().size(); ++leaf) {
        const auto path =
            tree_.links()[leaf].joints_to_children.empty() ? tree_.path(base, leaf) : std::nullopt;
        if (!path || axesOf(*path).empty()) {
            continue;
        }
        const auto last = axesOf(*path).back();
        auto& candidate = found[last];
        candidate.moved = tree_.joints()[last].child;
        candidate.joints.assign(path->begin(), std::find(path->begin(), path->end(), last) + 1);
        candidate.last_links.push_back(leaf);
    }
    std::vector<Candidate> list;
    for (auto& [last, candidate] : found) {
        list.push_back(std::move(candidate));
    }
    return list;
}

/// Those that can be taken in, without those that are the beginning of another one: a link that is
/// fixed beside a chain is no end of it.
std::vector<Candidate> ChainChooser::longest(const std::vector<Candidate>& found) const {
    std::vector<Candidate> usable;
    std::copy_if(found.begin(), found.end(), std::back_inserter(usable),
                 [&](const Candidate& candidate) { return allAxes(candidate.joints); });
    const auto begins = [](const Candidate& one, const Candidate& other) {
        return one.joints.size() < other.joints.size() &&
               std::equal(one.joints.begin(), one.joints.end(), other.joints.begin());
    };
    std::vector<Candidate> ends;
    std::copy_if(
        usable.begin(), usable.end(), std::back_inserter(ends), [&](const Candidate& candidate) {
            return std::none_of(usable.begin(), usable.end(),
                                [&](const Candidate& other) { return begins(candidate, other); });
        });
    return ends;
}

ChainChoice ChainChooser::endOf(std::size_t base, const Candidate& candidate) const {
    const auto held = tree_.heldBy(candidate.moved);
    const auto find = [&](const char* name) -> std::optional<std::size_t> {
        const auto link = tree_.link(name);
        return link && std::find(held.begin(), held.end(), *link) != held.end() ? link
                                                                                : std::nullopt;
    };
    ChainChoice choice{base, candidate.moved, {}, {}, "the last link that an axis moves"};
    if (const auto tool0 = find("tool0")) {
        choice.tip = *tool0;
        choice.why_this_tip = "ROS' name of a controller's flange";
    } else if (const auto flange = find("flange")) {
        choice.tip = *flange;
        choice.why_this_tip = "by its name";
    } else if (candidate.last_links.size() == 1) {
        choice.tip = candidate.last_links.front();
        choice.why_this_tip = "the last link of the chain";
    }
    choice.joints = tree_.path(base, choice.tip).value_or(std::vector<std::size_t>{});
    choice.axes = axesOf(choice.joints);
    return choice;
}

void ChainChooser::refuseCandidates(const std::vector<Candidate>& found) {
    std::set<std::size_t> refused;
    for (const auto& candidate : found) {
        const auto axes = axesOf(candidate.joints);
        const auto first = std::find_if(axes.begin(), axes.end(), [&](std::size_t joint) {
            return !tree_.joints()[joint].canBeAxis();
        });
        if (first != axes.end()) {
            refused.insert(*first);
        } else {
            file_.note(
                tree_.links()[candidate.moved].element,
                fmt::format(
                    "end of one of {} chains ({} axes): choose with --tip {} or a link before it",
                    found.size(), axes.size(), nameOf(candidate.moved)));
        }
    }
    for (const auto joint : refused) {
        refuseJoint(joint);
    }
}

std::optional<ChainChoice> ChainChooser::withoutTip(std::size_t base) {
    const auto found = candidates(base);
    if (found.empty()) {
        file_.note(tree_.links()[base].element, "no joint behind this link turns");
        return std::nullopt;
    }
    const auto usable = longest(found);
    if (usable.size() == 1) {
        return endOf(base, usable.front());
    }
    if (found.size() == 1) {
        return toTip(base, found.front().moved);
    }
    refuseCandidates(usable.empty() ? found : usable);
    return std::nullopt;
}

}  // namespace

std::optional<ChainChoice> chooseChain(XmlFile& file, const RobotTree& tree,
                                       const ChainEnds& ends) {
    return ChainChooser(file, tree).choose(ends);
}

}  // namespace metier::robot_files
