#include "skill_nodes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "foreign_types.hpp"
#include "metier/opcua/text.hpp"
#include "metier/opcua_skill/values.hpp"
#include "questions.hpp"

namespace metier::client {
namespace {

using opcua::Answer;
using opcua::AttributeId;
using opcua::Client;
using opcua::NodeClass;
using opcua::NodeId;
using opcua::Reference;
using skill::Field;
using skill::Place;

constexpr std::array kMethods{skill::Method::start, skill::Method::suspend, skill::Method::resume,
                              skill::Method::halt, skill::Method::reset};

constexpr std::int32_t kScalar = -1;

const Reference* findNamed(const std::vector<Reference>& references, std::string_view name) {
    const auto found = std::find_if(references.begin(), references.end(),
                                    [&](const auto& r) { return r.browse_name.name == name; });
    return found == references.end() ? nullptr : &*found;
}

}  // namespace

skill::Value FieldNode::received(const opcua::Value& value) const {
    const auto taken = foreign_type.isNull() ? opcua_skill::fromOpcua(value, field.type)
                                             : fromForeign(value, foreign_type);
    return taken.value_or(skill::Value{});
}

Result<opcua::Value> FieldNode::sent(const skill::Value& value) const {
    if (foreign_type.isNull()) {
        return opcua_skill::toOpcua(value);
    }
    return toForeign(value, foreign_type).map_error([&](Error error) {
        error.message = fmt::format("{}: {}", field.name, error.message);
        return error;
    });
}

const Reference* methodAmong(const std::vector<Reference>& children, skill::Method method) {
    const auto name = toString(method);
    const Reference* found = nullptr;
    for (const auto& child : children) {
        const bool fits =
            child.node_class == opcua::NodeClass::method && child.browse_name.name == name;
        if (fits && (found == nullptr ||
                     child.browse_name.namespace_index < found->browse_name.namespace_index)) {
            found = &child;
        }
    }
    return found;
}

namespace {

Answer<std::vector<Reference>> childrenOf(Questions& questions, const NodeId& node) {
    return questions.browse({.node = node, .node_classes = {}});
}

/// Reads a field from the attributes and properties of its Variable.
class FieldReader {
public:
    FieldReader(Questions& questions, Place place) : questions_(questions), place_(place) {}

    /// All fields directly below `folder`; none of types that skills do not have.
    Answer<std::vector<FieldNode>> read(const NodeId& folder) {
        METIER_ASSIGN(auto variables,
                      questions_.browse({.node = folder, .node_classes = {NodeClass::variable}}));
        std::vector<FieldNode> fields;
        for (const auto& variable : variables) {
            METIER_ASSIGN(auto field, readOne(variable));
            if (field.field.type != skill::ValueType::null) {
                fields.push_back(std::move(field));
            }
        }
        return fields;
    }

private:
    Answer<FieldNode> readOne(const Reference& variable) {
        const auto& node = variable.target;
        METIER_ASSIGN(auto attributes, questions_.readMany({{node, AttributeId::value},
                                                            {node, AttributeId::description},
                                                            {node, AttributeId::data_type},
                                                            {node, AttributeId::value_rank}}));
        FieldNode result{{.name = opcua::sanitise(variable.browse_name.name), .place = place_},
                         node};
        auto& field = result.field;
        const auto& value = attributes[0].value;
        field.type = typeOf(value, attributes[2].value, attributes[3].value);
        if (field.type == skill::ValueType::null && !value.isArray()) {
            result.foreign_type = attributes[2].value.as<NodeId>().value_or(NodeId());
            field.type = standInFor(result.foreign_type);
        }
        field.default_value = result.received(value);
        if (const auto text = attributes[1].value.as<opcua::LocalizedText>()) {
            field.description = opcua::sanitise(text->text);
        }
        METIER_TRY(readProperties(node, field));
        return result;
    }

    /// The declared type, unless there is a value that is an array where none is declared, or none
    /// where one is: some servers declare a rank that their values do not have.
    static skill::ValueType typeOf(const opcua::Value& value, const opcua::Value& data_type,
                                   const opcua::Value& rank) {
        const auto type = data_type.as<NodeId>();
        const auto declared_rank = rank.as<std::int32_t>();
        const bool other_rank =
            !value.isEmpty() && declared_rank && value.isArray() != (*declared_rank > kScalar);
        if (other_rank) {
            return opcua_skill::valueTypeOf(value);
        }
        // "Any rank" (-2) and "scalar or one dimension" (-3) are taken as scalar.
        const auto declared = type && declared_rank ? opcua_skill::valueTypeOf(opcua::VariableShape{
                                                          *type, std::max(*declared_rank, kScalar)})
                                                    : skill::ValueType::null;
        return declared != skill::ValueType::null ? declared : opcua_skill::valueTypeOf(value);
    }

    Answer<> readProperties(const NodeId& variable, Field& field) {
        METIER_ASSIGN(const auto children, childrenOf(questions_, variable));
        if (const auto* range = findNamed(children, "EURange")) {
            const auto value = questions_.read(range->target);
            if (const auto read = value ? value->as<opcua::Range>() : Result<opcua::Range>{}) {
                field.range = skill::Range{read->low, read->high};
            }
        }
        if (const auto* unit = findNamed(children, "EngineeringUnits")) {
            const auto value = questions_.read(unit->target);
            const auto read =
                value ? value->as<opcua::EuInformation>() : Result<opcua::EuInformation>{};
            field.unit = read ? unitOf(*read) : skill::kOne;
        }
        return {};
    }

    static skill::Unit unitOf(const opcua::EuInformation& unit) {
        const auto symbol = opcua_skill::symbolOf(unit);
        const auto found = std::find_if(skill::kUnits.begin(), skill::kUnits.end(),
                                        [&](const auto& known) { return known.symbol == symbol; });
        return found == skill::kUnits.end() ? skill::kOne : *found;
    }

    Questions& questions_;
    Place place_;
};

Answer<> appendFields(Questions& questions, const Reference* folder, Place place,
                      std::vector<FieldNode>& fields) {
    if (folder == nullptr) {
        return {};
    }
    METIER_ASSIGN(auto read, FieldReader(questions, place).read(folder->target));
    std::move(read.begin(), read.end(), std::back_inserter(fields));
    return {};
}

tl::unexpected<opcua::Failure> lacks(const SkillAddress& address, std::string_view what) {
    return opcua::failed(opcua::status::kBadNoMatch, address.name + " has no " + std::string(what));
}

Answer<> findNodes(Client& client, const SkillAddress& address,
                   const std::vector<Reference>& children, SkillNodes& nodes) {
    for (const auto method : kMethods) {
        if (const auto* found = methodAmong(children, method)) {
            nodes.methods.at(static_cast<std::size_t>(method)) = found->target;
        }
    }
    if (nodes.methods.at(static_cast<std::size_t>(skill::Method::start)).isNull()) {
        return lacks(address, "Start");
    }
    METIER_ASSIGN(nodes.program, findProgramNodes(client, address.node));
    if (nodes.program.state.isNull()) {
        return lacks(address, "CurrentState");
    }
    const std::array<std::pair<std::string_view, NodeId*>, 6> optional{
        {{"ReasonText", &nodes.reason_text},
         {"ExecutionId", &nodes.execution_id},
         {"StartWith", &nodes.start_with},
         {"Check", &nodes.check},
         {"GetExecution", &nodes.get_execution},
         {"ExecutionRecords", &nodes.records}}};
    for (const auto& [name, node] : optional) {
        if (const auto* found = findNamed(children, name)) {
            *node = found->target;
        }
    }
    nodes.methods.at(static_cast<std::size_t>(skill::Method::start_with)) = nodes.start_with;
    nodes.runs_others =
        findNamed(children, "Steps") != nullptr || findNamed(children, "UsedSkills") != nullptr;
    return {};
}

}  // namespace

std::vector<Field> fieldsOf(const std::vector<FieldNode>& nodes) {
    std::vector<Field> fields;
    for (const auto& node : nodes) {
        fields.push_back(node.field);
    }
    return fields;
}

std::vector<Lack> SkillNodes::lacks() const {
    if (knowsExecutions()) {
        return {};
    }
    return lock.isThere() ? std::vector{Lack::dead_man}
                          : std::vector{Lack::atomic_start, Lack::dead_man};
}

Answer<std::vector<Lack>> readLacks(Client& client, const SkillAddress& skill) {
    Questions questions(client);
    METIER_ASSIGN(const auto children, childrenOf(questions, skill.node));
    SkillNodes nodes;
    for (const auto& [name, node] :
         {std::pair{"StartWith", &nodes.start_with}, {"GetExecution", &nodes.get_execution}}) {
        const auto* found = findNamed(children, name);
        *node = found == nullptr ? NodeId() : found->target;
    }
    if (!nodes.knowsExecutions()) {
        METIER_ASSIGN(nodes.lock, findLock(client, skill));
    }
    return nodes.lacks();
}

Answer<SkillNodes> readSkillNodes(Client& client, const SkillAddress& address) {
    Questions questions(client);
    METIER_ASSIGN(const auto children, childrenOf(questions, address.node));
    SkillNodes nodes;
    METIER_TRY(findNodes(client, address, children, nodes));
    if (const auto* suspendable = findNamed(children, "Suspendable")) {
        const auto value = questions.read(suspendable->target);
        nodes.suspendable = (value ? value->as<bool>() : Result<bool>(true)).value_or(true);
    }
    const auto& suspend = nodes.methods.at(static_cast<std::size_t>(skill::Method::suspend));
    nodes.suspendable = nodes.suspendable && !suspend.isNull();
    if (!nodes.knowsExecutions()) {
        METIER_ASSIGN(nodes.lock, findLock(client, address));
    }
    struct Folder {
        std::string_view name;
        Place place;
        std::vector<FieldNode>& fields;
    };
    for (const auto& folder : {Folder{"ParameterSet", Place::parameter_set, nodes.parameters},
                               Folder{"Options", Place::options, nodes.parameters},
                               Folder{"FinalResultData", Place::final_result, nodes.results}}) {
        METIER_TRY(
            appendFields(questions, findNamed(children, folder.name), folder.place, folder.fields));
    }
    return nodes;
}

}  // namespace metier::client
