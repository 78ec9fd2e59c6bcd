#include "metier/opcua_skill/skill_types.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "metier/base/overloaded.hpp"
#include "metier/opcua/server.hpp"
#include "metier/opcua/text.hpp"
#include "metier/opcua_skill/values.hpp"
#include "model_ids.hpp"
#include "skill_layout.hpp"

namespace metier::opcua_skill {

namespace {

using opcua::AddressSpace;
using opcua::NodeId;
using opcua::QualifiedName;
using skill::Field;
using skill::SkillType;

// Namespace 0.
const NodeId kMandatoryRule{0, 78U};
const NodeId kOptionalRule{0, 80U};
const NodeId kUnitType{0, 17497U};
const NodeId kUnitAndRangeType{0, 17570U};
const NodeId kHasRule{0, 37U};
const NodeId kEntryOf{0, 17597U};  // HasDictionaryEntry
const NodeId kDictionaryFolder{0, 17591U};
const NodeId kUriEntryType{0, 17600U};
const NodeId kDictionariesFolder{0, 17594U};
const NodeId kRange{0, 884U};
const NodeId kEuInformation{0, 887U};

constexpr std::string_view kTermHead = "urn:metier:dictionary:";

/// Text as it may stand in XML, in an attribute, too.
std::string escaped(std::string_view text) {
    std::string result;
    for (const char letter : opcua::sanitise(text)) {
        switch (letter) {
            case '&':
                result += "&amp;";
                break;
            case '<':
                result += "&lt;";
                break;
            case '>':
                result += "&gt;";
                break;
            case '"':
                result += "&quot;";
                break;
            default:
                result += letter;
        }
    }
    return result;
}

std::string uriOfTerm(const std::string& term) {
    return term.find(':') == std::string::npos ? std::string(kTermHead) + term : term;
}

/// All skill types of a server by name, without those of the namespace that is written.
Result<void> collectSkillTypes(const AddressSpace& nodes, const NodeId& base,
                               std::map<std::string, NodeId, std::less<>>& types) {
    METIER_ASSIGN(const auto below, nodes.browse(base, {opcua::ids::kHasSubtype}));
    for (const auto& type : below) {
        types.emplace(type.browse_name.name, type.target);
        METIER_TRY(collectSkillTypes(nodes, type.target, types));
    }
    return {};
}

/// Spells ids and names of a server as a NodeSet file does, and keeps the file's namespaces.
class FileNames {
public:
    FileNames(std::string own_uri, std::vector<std::string> server_uris)
        : uris_{std::move(own_uri)}, server_uris_(std::move(server_uris)) {}

    std::string of(const NodeId& id) {
        const auto text =
            std::visit(overloaded{[](std::uint32_t number) { return fmt::format("i={}", number); },
                                  [](const std::string& name) { return "s=" + escaped(name); },
                                  [&](const auto& /*never of a type*/) { return id.toString(); }},
                       id.identifier());
        const auto index = indexOf(id.namespaceIndex());
        return index == 0 ? text : fmt::format("ns={};{}", index, text);
    }
    std::string of(const QualifiedName& name) {
        const auto index = indexOf(name.namespace_index);
        return index == 0 ? escaped(name.name) : fmt::format("{}:{}", index, escaped(name.name));
    }
    static std::string own(std::string_view path) { return "ns=1;s=" + escaped(path); }
    const std::vector<std::string>& uris() const noexcept { return uris_; }

private:
    std::size_t indexOf(std::uint16_t of_server) {
        if (of_server == 0) {
            return 0;
        }
        const auto& uri = server_uris_.at(of_server);
        auto found = std::find(uris_.begin(), uris_.end(), uri);
        if (found == uris_.end()) {
            found = uris_.insert(uris_.end(), uri);
        }
        return static_cast<std::size_t>(found - uris_.begin()) + 1;
    }

    std::vector<std::string> uris_;
    const std::vector<std::string> server_uris_;
};

/// A node to be written; its id is a path of names.
struct WrittenNode {
    std::string_view element;  ///< "UAVariable"
    std::string path;
    std::string name;  ///< BrowseName as in the file
    std::string parent;
    NodeId reference = opcua::ids::kHasComponent;
    std::optional<NodeId> type{};
    std::optional<NodeId> rule{};
    std::string description{};
    std::string attributes{};
    std::string value{};
    std::string references{};
};

class TypesWriter {
public:
    TypesWriter(const skill::SkillTypes& types, const AddressSpace& nodes, FileNames names)
        : types_(types), nodes_(nodes), names_(std::move(names)) {}

    Result<std::string> write() {
        METIER_ASSIGN(ids_, ModelIds::of(nodes_));
        METIER_ASSIGN(di_, nodes_.namespaceIndex(kDiUri));
        known_.emplace("SkillType", ids_.skill_type);
        METIER_TRY(collectSkillTypes(nodes_, ids_.skill_type, known_));
        check();
        if (problems_.empty()) {
            for (const auto& type : types_.types) {
                METIER_TRY(writeType(type));
            }
            writeTerms();
        }
        if (!problems_.empty()) {
            return fail(Errc::invalid_argument, fmt::format("{}", fmt::join(problems_, "\n")));
        }
        return document();
    }

private:
    void note(const SkillType& type, std::string_view why) {
        problems_.push_back(fmt::format("{}: {}", opcua::sanitise(type.name), why));
    }

    const SkillType* declared(std::string_view name) const {
        const auto found =
            std::find_if(types_.types.begin(), types_.types.end(),
                         [&](const SkillType& type) { return !type.extends && type.name == name; });
        return found == types_.types.end() ? nullptr : &*found;
    }

    void check() {
        if (types_.uri.empty()) {
            problems_.emplace_back("the namespace of the types has no URI");
        }
        std::set<std::string> names;
        for (const auto& type : types_.types) {
            if (type.extends) {
                if (!known_.contains(type.name)) {
                    note(type, "there is no such skill type to extend");
                }
                continue;
            }
            if (type.name.empty() || !names.insert(type.name).second) {
                note(type, "the name is empty, or declared twice");
            } else if (known_.contains(type.name)) {
                note(type, "the server has a skill type of that name");
            }
            checkBase(type);
        }
    }

    void checkBase(const SkillType& type) {
        std::size_t depth = 0;
        const auto* each = &type;
        while (const auto* above = declared(each->base)) {
            each = above;
            if (++depth > types_.types.size()) {
                note(type, "its base is derived from it");
                return;
            }
        }
        if (!known_.contains(each->base)) {
            note(type, fmt::format("there is no skill type {} to derive it from",
                                   opcua::sanitise(each->base)));
        }
    }

    /// Whether a type above declares the field; then it is not declared anew.
    Result<bool> isInherited(const SkillType& type, const Field& field) {
        const auto* each = &type;
        while (const auto* above = declared(each->base)) {
            each = above;
            for (const auto* fields : {&above->parameters, &above->results}) {
                const auto* same = skill::findField(*fields, field.name);
                if (same != nullptr && same->place == field.place) {
                    return true;
                }
            }
        }
        auto& layout = layouts_[each->base];
        if (layout.empty()) {
            METIER_ASSIGN(layout, layoutOfType(nodes_, known_.find(each->base)->second));
        }
        const auto path = std::string(folderOf(field)) + "/" + field.name;
        return std::any_of(layout.begin(), layout.end(),
                           [&](const LayoutNode& node) { return node.path == path; });
    }

    static std::string_view folderOf(const Field& field) {
        switch (field.place) {
            case skill::Place::options:
                return "Options";
            case skill::Place::final_result:
                return "FinalResultData";
            default:
                return "ParameterSet";
        }
    }

    QualifiedName folderName(std::string_view folder) const {
        const std::uint16_t index = folder == "ParameterSet" ? di_
                                    : folder == "Options"    ? ids_.metier
                                                             : std::uint16_t{0};
        return {index, std::string(folder)};
    }

    void add(const WrittenNode& node) {
        auto references = node.references;
        const auto refer = [&](const NodeId& type, const std::string& target, bool forward) {
            references +=
                fmt::format("\n      <Reference ReferenceType=\"{}\"{}>{}</Reference>",
                            names_.of(type), forward ? "" : " IsForward=\"false\"", target);
        };
        refer(node.reference, node.parent, false);
        if (node.type) {
            refer(opcua::ids::kHasTypeDefinition, names_.of(*node.type), true);
        }
        if (node.rule) {
            refer(kHasRule, names_.of(*node.rule), true);
        }
        const auto slash = node.path.rfind('/');
        const auto display = slash == std::string::npos ? node.path : node.path.substr(slash + 1);
        nodes_text_ += fmt::format(
            "  <{0} NodeId=\"{1}\" BrowseName=\"{2}\"{3}>\n    <DisplayName>{4}</DisplayName>\n"
            "{5}    <References>{6}\n    </References>\n{7}  </{0}>\n",
            node.element, FileNames::own(node.path), node.name, node.attributes, escaped(display),
            node.description.empty()
                ? ""
                : fmt::format("    <Description>{}</Description>\n", escaped(node.description)),
            references, node.value.empty() ? "" : "    <Value>" + node.value + "</Value>\n");
    }

    std::string ownName(std::string_view name) const { return "1:" + escaped(name); }

    Result<void> writeType(const SkillType& type) {
        const auto parent =
            type.extends ? names_.of(known_.find(type.name)->second) : FileNames::own(type.name);
        if (!type.extends) {
            const auto base = declared(type.base) != nullptr
                                  ? FileNames::own(type.base)
                                  : names_.of(known_.find(type.base)->second);
            std::string terms;
            for (const auto& term : type.terms) {
                terms += entryReference(term);
            }
            add({.element = "UAObjectType",
                 .path = type.name,
                 .name = ownName(type.name),
                 .parent = base,
                 .reference = opcua::ids::kHasSubtype,
                 .description = type.description,
                 .references = terms});
            METIER_TRY(writeFields(type, type.parameters));
            METIER_TRY(writeFields(type, type.results));
        } else {
            for (const auto& term : type.terms) {
                extended_terms_[uriOfTerm(term)].push_back(parent);
                static_cast<void>(entryReference(term));
            }
        }
        for (const auto& property : type.properties) {
            writeProperty(type, parent, property);
        }
        return {};
    }

    Result<void> writeFields(const SkillType& type, const skill::Fields& fields) {
        for (const auto& field : fields) {
            METIER_ASSIGN(const bool inherited, isInherited(type, field));
            if (!inherited) {
                writeField(type, field);
            }
        }
        return {};
    }

    void writeField(const SkillType& type, const Field& field) {
        const auto folder = folderOf(field);
        const auto folder_path = fmt::format("{}/{}", type.name, folder);
        if (folders_.insert(folder_path).second) {
            add({.element = "UAObject",
                 .path = folder_path,
                 .name = names_.of(folderName(folder)),
                 .parent = FileNames::own(type.name),
                 .type = opcua::ids::kBaseObjectType,
                 .rule = kMandatoryRule,
                 .description = field.place == skill::Place::final_result
                                    ? "Result of the last finished execution."
                                    : "Parameters of the next execution."});
        }
        const auto path = folder_path + "/" + field.name;
        const auto shape = shapeOf(field.type);
        const bool has_unit = field.unit.code != skill::kOne.code;
        const auto variable_type = has_unit && field.range ? kUnitAndRangeType
                                   : has_unit              ? kUnitType
                                   : field.range           ? opcua::ids::kBaseAnalogType
                                                           : opcua::ids::kBaseDataVariableType;
        add({.element = "UAVariable",
             .path = path,
             .name = ownName(field.name),
             .parent = FileNames::own(folder_path),
             .type = variable_type,
             .rule = field.optional && field.place == skill::Place::final_result ? kOptionalRule
                                                                                 : kMandatoryRule,
             .description = field.description,
             .attributes = fmt::format(
                 " DataType=\"{}\" ValueRank=\"{}\"{}", names_.of(shape.data_type),
                 shape.value_rank,
                 field.place == skill::Place::final_result ? "" : " AccessLevel=\"3\"")});
        writeMeasure(path, field.unit, field.range);
    }

    void writeMeasure(const std::string& path, const skill::Unit& unit,
                      const std::optional<skill::Range>& range) {
        if (unit.code != skill::kOne.code) {
            const auto eu = toOpcua(unit);
            addStandardProperty(
                path, "EngineeringUnits", kEuInformation,
                {"i=888",
                 fmt::format("<uax:EUInformation><uax:NamespaceUri>{}</uax:NamespaceUri>"
                             "<uax:UnitId>{}</uax:UnitId><uax:DisplayName><uax:Text>{}</uax:Text>"
                             "</uax:DisplayName><uax:Description><uax:Text>{}</uax:Text>"
                             "</uax:Description></uax:EUInformation>",
                             escaped(eu.namespace_uri), eu.unit_id, escaped(eu.display_name.text),
                             escaped(eu.description.text))});
        }
        if (range) {
            addStandardProperty(path, "EURange", kRange,
                                {"i=885", fmt::format("<uax:Range><uax:Low>{}</uax:Low><uax:High>{}"
                                                      "</uax:High></uax:Range>",
                                                      range->low, range->high)});
        }
    }

    /// A structure in XML.
    struct Structure {
        std::string_view encoding;
        std::string body;
    };

    void addStandardProperty(const std::string& path, std::string_view name, const NodeId& type,
                             const Structure& value) {
        add({.element = "UAVariable",
             .path = fmt::format("{}/{}", path, name),
             .name = std::string(name),
             .parent = FileNames::own(path),
             .reference = opcua::ids::kHasProperty,
             .type = opcua::ids::kPropertyType,
             .rule = kMandatoryRule,
             .attributes = fmt::format(" DataType=\"{}\"", names_.of(type)),
             .value = fmt::format("<uax:ExtensionObject><uax:TypeId><uax:Identifier>{}"
                                  "</uax:Identifier></uax:TypeId><uax:Body>{}</uax:Body>"
                                  "</uax:ExtensionObject>",
                                  value.encoding, value.body)});
    }

    /// A number with a unit is a Variable, since Properties have no properties of their own.
    void writeProperty(const SkillType& type, const std::string& parent,
                       const skill::TypeProperty& property) {
        const bool has_unit = property.unit.code != skill::kOne.code;
        const auto path = type.name + "/" + property.name;
        const auto [data_type, value] = std::visit(
            overloaded{[](bool truth) {
                           return std::pair(opcua::ids::kBoolean,
                                            fmt::format("<uax:Boolean>{}</uax:Boolean>", truth));
                       },
                       [](double number) {
                           return std::pair(opcua::ids::kDouble,
                                            fmt::format("<uax:Double>{}</uax:Double>", number));
                       },
                       [](const std::string& text) {
                           return std::pair(
                               opcua::ids::kString,
                               fmt::format("<uax:String>{}</uax:String>", escaped(text)));
                       }},
            property.value);
        add({.element = "UAVariable",
             .path = path,
             .name = ownName(property.name),
             .parent = parent,
             .reference = has_unit ? opcua::ids::kHasComponent : opcua::ids::kHasProperty,
             .type = has_unit ? kUnitType : opcua::ids::kPropertyType,
             // An instance of an extended type need not have what it did not know of.
             .rule = type.extends ? kOptionalRule : kMandatoryRule,
             .description = property.description,
             .attributes = fmt::format(" DataType=\"{}\"", names_.of(data_type)),
             .value = value});
        writeMeasure(path, property.unit, std::nullopt);
    }

    std::string entryReference(const std::string& term) {
        const auto uri = uriOfTerm(term);
        terms_.insert(uri);
        return fmt::format("\n      <Reference ReferenceType=\"{}\">{}</Reference>",
                           names_.of(kEntryOf), FileNames::own(uri));
    }

    /// Whether types that were declared before have made the node.
    bool isThere(const std::string& path) const {
        const auto index = nodes_.namespaceIndex(types_.uri);
        return index && nodes_.exists(NodeId(*index, path));
    }

    void writeTerms() {
        if (!terms_.empty() && !isThere("Dictionary")) {
            add({.element = "UAObject",
                 .path = "Dictionary",
                 .name = ownName(types_.uri),
                 .parent = names_.of(kDictionariesFolder),
                 .type = kDictionaryFolder,
                 .description = "What skill types are for."});
        }
        for (const auto& uri : terms_) {
            const auto& extended = extended_terms_[uri];
            if (isThere(uri)) {
                if (!extended.empty()) {
                    problems_.push_back(opcua::sanitise(uri) +
                                        ": declared before; extend a type where its terms are new");
                }
                continue;
            }
            std::string references;
            for (const auto& type : extended) {
                references += fmt::format(
                    "\n      <Reference ReferenceType=\"{}\" IsForward=\"false\">{}"
                    "</Reference>",
                    names_.of(kEntryOf), type);
            }
            add({.element = "UAObject",
                 .path = uri,
                 .name = ownName(uri),
                 .parent = FileNames::own("Dictionary"),
                 .type = kUriEntryType,
                 .references = references});
        }
    }

    std::string document() const {
        std::string uris;
        std::string required;
        for (const auto& uri : names_.uris()) {
            uris += fmt::format("    <Uri>{}</Uri>\n", escaped(uri));
            if (&uri != &names_.uris().front()) {
                required += fmt::format("      <RequiredModel ModelUri=\"{}\"/>\n", escaped(uri));
            }
        }
        return fmt::format(
            "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n"
            "<UANodeSet xmlns=\"http://opcfoundation.org/UA/2011/03/UANodeSet.xsd\"\n"
            "           xmlns:uax=\"http://opcfoundation.org/UA/2008/02/Types.xsd\">\n"
            "  <NamespaceUris>\n{}  </NamespaceUris>\n"
            "  <Models>\n    <Model ModelUri=\"{}\" Version=\"{}\">\n"
            "      <RequiredModel ModelUri=\"http://opcfoundation.org/UA/\"/>\n{}"
            "    </Model>\n  </Models>\n{}</UANodeSet>\n",
            uris, escaped(types_.uri), escaped(types_.version), required, nodes_text_);
    }

    const skill::SkillTypes& types_;
    const AddressSpace& nodes_;
    FileNames names_;
    ModelIds ids_;
    std::uint16_t di_ = 0;
    std::map<std::string, NodeId, std::less<>> known_;
    std::map<std::string, SkillLayout> layouts_;  ///< of types of the server
    std::set<std::string> folders_;
    std::set<std::string> terms_;
    std::map<std::string, std::vector<std::string>> extended_terms_;
    std::string nodes_text_;
    std::vector<std::string> problems_;
};

}  // namespace

Result<std::string> nodesetOf(const skill::SkillTypes& types, const AddressSpace& nodes) {
    METIER_ASSIGN(const auto table, nodes.read(opcua::ids::kNamespaceArray));
    METIER_ASSIGN(auto uris, table.value.as<std::vector<std::string>>());
    return TypesWriter(types, nodes, FileNames(types.uri, std::move(uris))).write();
}

Result<std::string> nodesetOf(const skill::SkillTypes& types) {
    opcua::ServerOptions options;
    options.nodesets = {"device", "robotics", "metier"};
    METIER_ASSIGN(const auto server, opcua::Server::create(std::move(options)));
    return nodesetOf(types, server->nodes());
}

Result<void> declareTypes(AddressSpace& nodes, const skill::SkillTypes& types) {
    METIER_ASSIGN(const auto text, nodesetOf(types, nodes));
    return nodes.addNodeset(text, types.uri);
}

bool hasSkillType(const AddressSpace& nodes, std::string_view name) {
    const auto ids = ModelIds::of(nodes);
    std::map<std::string, NodeId, std::less<>> types;
    return ids && collectSkillTypes(nodes, ids->skill_type, types) &&
           (types.contains(name) ||
            (name.ends_with("Type") && types.contains(name.substr(0, name.size() - 4))));
}

}  // namespace metier::opcua_skill
