#include "metier/client/skill_finder.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "metier/opcua/text.hpp"
#include "questions.hpp"
#include "skill_nodes.hpp"

namespace metier::client {
namespace {

using opcua::Answer;
using opcua::BrowseQuery;
using opcua::Client;
using opcua::NodeClass;
using opcua::NodeId;
using opcua::Reference;
using opcua::sanitise;

constexpr std::size_t kMaxDepth = 12;

/// Walks the objects of a server, each once.
class Walk {
public:
    explicit Walk(Client& client) : questions_(client) {}

    Answer<> below(const NodeId& node, std::vector<SkillAddress::Above>& above) {
        if (above.size() > kMaxDepth) {
            return {};
        }
        METIER_ASSIGN(auto children,
                      questions_.browse({.node = node, .node_classes = {NodeClass::object}}));
        for (const auto& child : children) {
            METIER_TRY(visit(child, above));
        }
        return {};
    }

    std::vector<SkillAddress> found;

private:
    Answer<> visit(const Reference& child, std::vector<SkillAddress::Above>& above) {
        if (child.target == opcua::ids::kServer || !seen_.insert(child.target).second) {
            return {};
        }
        METIER_ASSIGN(const auto is_program, isProgram(child.type_definition));
        if (is_program) {
            return add(child, above);
        }
        above.push_back({sanitise(child.browse_name.name), child.target});
        auto walked = below(child.target, above);
        above.pop_back();
        return walked;
    }

    Answer<> add(const Reference& skill, const std::vector<SkillAddress::Above>& above) {
        METIER_ASSIGN(const auto type_name,
                      questions_.read(skill.type_definition, opcua::AttributeId::browse_name));
        const auto type = type_name.as<opcua::QualifiedName>().value_or(opcua::QualifiedName{});
        found.push_back({sanitise(skill.browse_name.name), sanitise(skill.display_name.text),
                         skill.target, skill.type_definition, sanitise(type.name), above,
                         baseTypesOf(skill.type_definition)});
        return {};
    }

    /// Of a type that isProgram() has looked at.
    std::vector<std::string> baseTypesOf(const NodeId& type) const {
        std::vector<std::string> names;
        auto parent = parents_.find(type);
        while (parent != parents_.end() && names.size() <= kMaxDepth &&
               parent->second.target != opcua::ids::kProgramStateMachineType) {
            names.push_back(sanitise(parent->second.browse_name.name));
            parent = parents_.find(parent->second.target);
        }
        return names;
    }

    /// A type that is derived from itself, over whatever way, is none.
    Answer<bool> isProgram(const NodeId& type) {
        std::vector<NodeId> chain;
        NodeId next = type;
        std::optional<bool> answer;
        while (!answer) {
            answer = known(next, chain.size());
            if (!answer) {
                chain.push_back(next);
                METIER_ASSIGN(const auto parents,
                              questions_.browse({.node = next,
                                                 .reference_type = opcua::ids::kHasSubtype,
                                                 .direction = BrowseQuery::Direction::inverse,
                                                 .node_classes = {}}));
                if (!parents.empty()) {
                    parents_.emplace(next, parents.front());
                }
                next = parents.empty() ? NodeId{} : parents.front().target;
            }
        }
        for (const auto& derived : chain) {
            is_program_[derived] = *answer;
        }
        return *answer;
    }

    /// Answer that needs no further look, for a type that many types above the first.
    std::optional<bool> known(const NodeId& type, std::size_t above) const {
        if (type == opcua::ids::kProgramStateMachineType) {
            return true;
        }
        if (type == NodeId{} || type == opcua::ids::kBaseObjectType || above > kMaxDepth) {
            return false;
        }
        const auto decided = is_program_.find(type);
        return decided == is_program_.end() ? std::nullopt : std::optional(decided->second);
    }

    Questions questions_;
    std::set<NodeId> seen_;
    std::map<NodeId, bool> is_program_;
    std::map<NodeId, Reference> parents_;  // types above those that were looked at
};

bool matches(const SkillAddress& skill, std::string_view name) {
    return skill.name == name || fmt::format("{}/{}", skill.controllerName(), skill.name) == name;
}

std::vector<std::string> namesOf(const std::vector<SkillAddress>& skills) {
    std::vector<std::string> names;
    for (const auto& skill : skills) {
        names.push_back(skill.name);
    }
    return names;
}

}  // namespace

const SkillAddress::Above* SkillAddress::controller() const {
    const auto skills = std::find_if(above.rbegin(), above.rend(),
                                     [](const Above& object) { return object.name == "Skills"; });
    return skills == above.rend() || std::next(skills) == above.rend() ? nullptr
                                                                       : &*std::next(skills);
}

bool SkillAddress::servesAs(std::string_view wanted) const {
    constexpr std::string_view kForceMove = "CartesianLinearForceMoveSkillType";
    const auto is_it = [wanted](const std::string& each) {
        return each == wanted || each + "Type" == wanted;
    };
    if (is_it(type_name)) {
        return true;
    }
    const auto found = std::find_if(base_types.begin(), base_types.end(), is_it);
    return found != base_types.end() && type_name != kForceMove &&
           std::find(base_types.begin(), found, kForceMove) == found;
}

std::string SkillAddress::controllerName() const {
    const auto* object = controller();
    return object == nullptr ? "" : object->name;
}

Answer<std::vector<SkillAddress>> findSkills(Client& client) {
    Walk walk(client);
    std::vector<SkillAddress::Above> above;
    METIER_TRY(walk.below(opcua::ids::kObjectsFolder, above));
    return std::move(walk.found);
}

Answer<std::vector<SkillType>> typeChain(Client& client, const SkillAddress& skill) {
    std::vector<SkillType> types{{skill.type_name, skill.type}};
    while (types.size() <= kMaxDepth) {
        METIER_ASSIGN(const auto parents,
                      client.browse({.node = types.back().node,
                                     .reference_type = opcua::ids::kHasSubtype,
                                     .direction = BrowseQuery::Direction::inverse,
                                     .node_classes = {}}));
        if (parents.empty() || parents.front().target == opcua::ids::kProgramStateMachineType) {
            break;
        }
        types.push_back({sanitise(parents.front().browse_name.name), parents.front().target});
    }
    return types;
}

Answer<NodeId> findMethod(Client& client, const SkillAddress& skill, skill::Method method) {
    METIER_ASSIGN(const auto methods,
                  client.browse({.node = skill.node, .node_classes = {NodeClass::method}}));
    const auto* found = methodAmong(methods, method);
    if (found == nullptr) {
        return tl::unexpected(failureOf(Errc::not_found,
                                        fmt::format("{} has no {}", skill.name, toString(method)),
                                        opcua::status::kBadNoMatch));
    }
    return found->target;
}

Answer<SkillAddress> findSkill(Client& client, std::string_view name) {
    METIER_ASSIGN(auto skills, findSkills(client));
    std::vector<SkillAddress> matching;
    std::copy_if(skills.begin(), skills.end(), std::back_inserter(matching),
                 [&](const auto& skill) { return matches(skill, name); });
    if (matching.empty()) {
        return tl::unexpected(failureOf(
            Errc::not_found,
            fmt::format("no skill '{}'; there are: {}", name, fmt::join(namesOf(skills), ", ")),
            opcua::status::kBadNoMatch));
    }
    if (matching.size() > 1) {
        return tl::unexpected(
            failureOf(Errc::invalid_argument,
                      fmt::format("{} controllers have a skill '{}'; say Controller/{}",
                                  matching.size(), name, name),
                      opcua::status::kBadNoMatch));
    }
    return std::move(matching.front());
}

}  // namespace metier::client
