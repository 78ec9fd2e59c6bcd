#include "metier/client/skill_references.hpp"

#include <array>
#include <utility>

#include "metier/opcua_skill/namespaces.hpp"

namespace metier::client {
namespace {

using opcua::Answer;
using opcua::NodeId;

// Namespace 0.
const NodeId kNonHierarchicalReferences{0, 32U};
const NodeId kHasDictionaryEntry{0, 17597U};

// The Metier NodeSet.
constexpr std::uint32_t kUsesSkill = 20306;
constexpr std::uint32_t kUsedSkillType = 20307;

constexpr std::size_t kMostUses = 100;

}  // namespace

ReferenceReader::ReferenceReader(opcua::Client& client, std::optional<std::uint16_t> metier)
    : client_(&client), metier_(metier) {}

Answer<ReferenceReader> ReferenceReader::create(opcua::Client& client) {
    const auto metier = client.namespaceIndex(opcua_skill::kMetierUri);
    if (!metier && metier.error().code != Errc::not_found) {
        return tl::unexpected(metier.error());
    }
    return ReferenceReader(client, metier ? std::optional(*metier) : std::nullopt);
}

Answer<SkillReferences> ReferenceReader::read(const NodeId& node) const {
    METIER_ASSIGN(const auto references,
                  client_->browse({.node = node, .reference_type = kNonHierarchicalReferences}));
    SkillReferences result;
    for (const auto& reference : references) {
        if (reference.type == kHasDictionaryEntry) {
            result.terms.push_back(reference.browse_name.name);
        } else if (metier_ && reference.type == NodeId(*metier_, kUsesSkill) &&
                   result.uses.size() < kMostUses) {
            METIER_ASSIGN(auto use, readUse(reference));
            result.uses.push_back(std::move(use));
        }
    }
    return result;
}

/// Reads a used skill. A missing property stays empty, so that it matches no skill.
Answer<SkillUse> ReferenceReader::readUse(const opcua::Reference& used) const {
    SkillUse use{{}, {}, {}, used.target};
    if (used.type_definition != NodeId(*metier_, kUsedSkillType)) {
        return use;
    }
    const std::array<std::pair<const char*, std::string*>, 3> properties{
        {{"EndpointUrl", &use.endpoint_url},
         {"SkillName", &use.name},
         {"ControllerName", &use.controller}}};
    std::vector<opcua::RelativePath> paths;
    paths.reserve(properties.size());
    for (const auto& [name, target] : properties) {
        paths.push_back({used.target, {{*metier_, name}}});
    }
    METIER_ASSIGN(const auto nodes, client_->translateMany(std::move(paths)));
    std::vector<opcua::ReadItem> items;
    std::vector<std::string*> targets;
    for (std::size_t i = 0; i < properties.size(); ++i) {
        if (nodes[i]) {
            items.push_back({*nodes[i]});
            targets.push_back(properties[i].second);
        }
    }
    if (items.empty()) {
        return use;
    }
    METIER_ASSIGN(const auto values, client_->readMany(std::move(items)));
    for (std::size_t i = 0; i < targets.size(); ++i) {
        *targets[i] = values[i].value.as<std::string>().value_or("");
    }
    return use;
}

}  // namespace metier::client
