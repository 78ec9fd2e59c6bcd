#include "metier/opcua_skill/skill_dictionary.hpp"

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "model_ids.hpp"

namespace metier::opcua_skill {

namespace {

using opcua::AddressSpace;
using opcua::NodeId;

// OPC 10000-19, namespace 0.
const NodeId kDictionaries{0, 17594U};
const NodeId kDictionaryFolderType{0, 17591U};
const NodeId kUriDictionaryEntryType{0, 17600U};
const NodeId kHasDictionaryEntry{0, 17597U};

constexpr std::string_view kUriHead = "urn:metier:dictionary:";

/// A term for a task, and the types for that task.
struct Term {
    std::string_view name;
    std::string_view text;
    std::vector<std::string_view> types;
};

const std::vector<Term>& terms() {
    static const std::vector<Term> kTerms{
        {"move", "Brings an arm to a place.", {"MoveSkillType"}},
        {"move-straight", "Moves a tool along a straight line.", {"LinearMoveSkillType"}},
        {"move-until-contact",
         "Moves a tool until it meets a force.",
         {"CartesianLinearForceMoveSkillType"}},
        {"move-along-path", "Moves a tool through several poses.", {"CartesianPathMoveSkillType"}},
        {"move-together",
         "Moves several arms so that they begin and arrive together.",
         {"SynchronizedMoveSkillType"}},
        {"stream",
         "Follows positions that are given one by one.",
         {"StreamSkillType", "PositionStreamSkillType"}},
        {"grasp", "Holds a part.", {"GraspGripperSkill"}},
        {"release", "Lets a part go.", {"ReleaseGripperSkill"}},
        {"hold", "Watches that a part is held.", {"HoldGripperSkillType"}},
        {"pick-and-place",
         "Takes a part from one place and puts it at another.",
         {"PickPlaceSkillType"}},
        {"sequence", "Runs other skills.", {"SequenceSkillType"}},
    };
    return kTerms;
}

/// All types below `base`, by name.
Result<void> collectTypes(const AddressSpace& nodes, const NodeId& base,
                          std::map<std::string, NodeId, std::less<>>& types) {
    METIER_ASSIGN(const auto subtypes, nodes.browse(base, {opcua::ids::kHasSubtype}));
    for (const auto& subtype : subtypes) {
        types.emplace(subtype.browse_name.name, subtype.target);
        METIER_TRY(collectTypes(nodes, subtype.target, types));
    }
    return {};
}

Result<NodeId> addFolder(AddressSpace& nodes, std::uint16_t metier) {
    return nodes.addObject({.node = {.id = NodeId(metier, std::string("urn:metier:dictionary")),
                                     .parent = kDictionaries,
                                     .browse_name = {metier, "metier"},
                                     .description = {"en", "What skill types are for."}},
                            .type = kDictionaryFolderType});
}

Result<NodeId> addEntry(AddressSpace& nodes, const NodeId& folder, const Term& term) {
    const auto uri = std::string(kUriHead) + std::string(term.name);
    return nodes.addObject({.node = {.id = NodeId(folder.namespaceIndex(), uri),
                                     .parent = folder,
                                     .browse_name = {folder.namespaceIndex(), uri},
                                     .display_name = {"en", std::string(term.name)},
                                     .description = {"en", std::string(term.text)}},
                            .type = kUriDictionaryEntryType});
}

using TypesByName = std::map<std::string, NodeId, std::less<>>;

/// References from the types of a term that are there to its entry.
Result<void> addReferences(AddressSpace& nodes, const TypesByName& types, const Term& term,
                           const NodeId& entry) {
    for (const auto name : term.types) {
        if (const auto type = types.find(name); type != types.end()) {
            METIER_TRY(nodes.addReference(type->second, kHasDictionaryEntry, entry));
        }
    }
    return {};
}

}  // namespace

Result<void> publishDictionary(AddressSpace& nodes) {
    METIER_ASSIGN(const auto metier, nodes.namespaceIndex(kMetierUri));
    METIER_ASSIGN(const auto device, nodes.namespaceIndex(kDeviceUri));
    TypesByName types;
    METIER_TRY(collectTypes(nodes, NodeId(device, kSkillTypeId), types));
    METIER_ASSIGN(const auto folder, addFolder(nodes, metier));
    for (const auto& term : terms()) {
        METIER_ASSIGN(const auto entry, addEntry(nodes, folder, term));
        METIER_TRY(addReferences(nodes, types, term, entry));
    }
    return {};
}

}  // namespace metier::opcua_skill
