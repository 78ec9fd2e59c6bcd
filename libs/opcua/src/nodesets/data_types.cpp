#include "nodesets/data_types.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "common/convert.hpp"
#include "metier/base/text.hpp"
#include "metier/opcua/standard_ids.hpp"
#include "metier/opcua/text.hpp"

namespace metier::opcua {

namespace {

constexpr std::size_t kPointer = sizeof(void*);
constexpr std::size_t kLargestStructure = std::numeric_limits<std::uint16_t>::max();
constexpr int kDeepestStructure = 100;
constexpr std::size_t kMostMembers = std::numeric_limits<std::uint8_t>::max();

std::size_t roundedUp(std::size_t size, std::size_t alignment) {
    return (size + alignment - 1) / alignment * alignment;
}

std::size_t alignmentOf(const UA_DataType& type);

std::size_t alignmentOf(const UA_DataTypeMember& member) {
    return member.isArray || member.isOptional ? kPointer : alignmentOf(*member.memberType);
}

/// Alignment of the C type that a description stands for.
std::size_t alignmentOf(const UA_DataType& type) {
    if (isStructured(type)) {
        std::size_t largest = type.typeKind == UA_DATATYPEKIND_STRUCTURE ? 1 : sizeof(UA_UInt32);
        for (std::size_t i = 0; i < type.membersSize; ++i) {
            largest = std::max(largest, alignmentOf(type.members[i]));
        }
        return largest;
    }
    if (type.typeKind == UA_DATATYPEKIND_GUID) {
        return alignof(UA_Guid);
    }
    return std::min<std::size_t>(type.memSize, kPointer);
}

bool isPlain(const UA_DataTypeMember& member) {
    return !member.isArray && !member.isOptional && member.memberType->pointerFree;
}

/// Sets the paddings of members in the order of the structure.
/// \return the size of the structure
std::size_t layOutInOrder(std::vector<UA_DataTypeMember>& members) {
    std::size_t end = 0;
    std::size_t alignment = 1;
    for (auto& member : members) {
        const auto place = roundedUp(end, alignmentOf(member));
        member.padding = static_cast<UA_Byte>(place - end) & 0x3FU;
        end = place + sizeOf(member);
        alignment = std::max(alignment, alignmentOf(member));
    }
    return roundedUp(end, alignment);
}

/// The same for a union: all members are at one place, after the number of the one that is set.
std::size_t layOutAsUnion(std::vector<UA_DataTypeMember>& members) {
    std::size_t alignment = sizeof(UA_UInt32);
    std::size_t largest = 0;
    for (const auto& member : members) {
        alignment = std::max(alignment, alignmentOf(member));
        largest = std::max(largest, sizeOf(member));
    }
    const auto place = roundedUp(sizeof(UA_UInt32), alignment);
    for (auto& member : members) {
        member.padding = static_cast<UA_Byte>(place) & 0x3FU;
    }
    return roundedUp(place + largest, alignment);
}

/// BrowseName without the index of its namespace.
std::string_view nameOf(const pugi::xml_node& element) {
    const std::string_view name = element.attribute("BrowseName").value();
    const auto colon = name.find(':');
    return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

bool isTrue(const pugi::xml_attribute& attribute) {
    return attribute.as_bool(false);
}

/// The built-in type of that id; null if it is none.
const UA_DataType* simpleType(const NodeId& id) {
    const auto* number = std::get_if<std::uint32_t>(&id.identifier());
    const bool is_one = id.namespaceIndex() == 0 && number != nullptr && *number >= 1 &&
                        *number <= UA_DATATYPEKIND_DIAGNOSTICINFO + 1U;
    return is_one ? &UA_TYPES[*number - 1] : nullptr;
}

}  // namespace

const UA_EnumDefinition* DataTypeStore::enumeration(const NodeId& data_type) const noexcept {
    const auto found = enumerations_.find(data_type);
    return found == enumerations_.end() ? nullptr : found->second.get();
}

std::span<UA_EnumField> DataTypeStore::defineEnumeration(const NodeId& data_type,
                                                         std::size_t fields) {
    auto& definition =
        *enumerations_.try_emplace(data_type, UA_TYPES[UA_TYPES_ENUMDEFINITION]).first->second;
    UA_clear(&definition, &UA_TYPES[UA_TYPES_ENUMDEFINITION]);  // of a file that was refused
    definition.fields = static_cast<UA_EnumField*>(
        checkAllocated(UA_Array_new(fields, &UA_TYPES[UA_TYPES_ENUMFIELD])));
    definition.fieldsSize = fields;
    return {definition.fields, fields};
}

bool isStructured(const UA_DataType& type) noexcept {
    return type.typeKind == UA_DATATYPEKIND_STRUCTURE ||
           type.typeKind == UA_DATATYPEKIND_OPTSTRUCT || type.typeKind == UA_DATATYPEKIND_UNION;
}

std::size_t sizeOf(const UA_DataTypeMember& member) noexcept {
    if (member.isArray) {
        return sizeof(std::size_t) + kPointer;
    }
    return member.isOptional ? kPointer : member.memberType->memSize;
}

bool DataTypeBuilder::refuse(std::string why) {
    why_ = std::move(why);
    return false;
}

const UA_DataType* DataTypeBuilder::find(const NodeId& data_type) const {
    auto each = data_type.isNull() ? std::nullopt : std::optional(data_type);
    while (each) {
        if (const auto* simple = simpleType(*each)) {
            return *each == ids::kStructure ? nullptr : simple;
        }
        const UA_NodeId id = viewOf(*each);
        if (const auto* known = UA_Server_findDataType(server_, &id)) {
            return known;
        }
        if (*each == ids::kEnumeration) {
            return &UA_TYPES[UA_TYPES_INT32];
        }
        // A structure without a description is not the one above it.
        each = tree_.isA(*each, ids::kStructure) ? std::nullopt : tree_.above(*each);
    }
    return nullptr;
}

void DataTypeBuilder::begin(const std::vector<DataTypeElement>& elements) {
    slots_.clear();
    described_.clear();
    group_ = &store_.groups_.emplace_back();
    const auto is_structure = [&](const auto& each) { return tree_.isA(each.id, ids::kStructure); };
    group_->structures.resize(
        static_cast<std::size_t>(std::count_if(elements.begin(), elements.end(), is_structure)));
    std::size_t next = 0;
    for (const auto& element : elements) {
        const bool structure = is_structure(element);
        slots_.emplace(element.id, Slot{&element, structure ? &group_->structures[next] : nullptr});
        next += structure ? 1 : 0;
    }
}

std::vector<std::string> DataTypeBuilder::build(const std::vector<DataTypeElement>& elements,
                                                const NodesetIds& names) {
    begin(elements);
    std::vector<std::string> refused;
    for (const auto& element : elements) {
        auto& slot = slots_.at(element.id);
        if (slot.type != nullptr && describe(slot, names) == nullptr) {
            refused.push_back(fmt::format("{}: {}", sanitise(nameOf(element.element)), why_));
        }
    }
    hideFailed();
    auto* config = UA_Server_getConfig(server_);
    group_->array.emplace(UA_DataTypeArray{config->customDataTypes, group_->structures.size(),
                                           group_->structures.data(), false});
    config->customDataTypes = &*group_->array;
    return refused;
}

/// A null id would be that of an empty ExtensionObject.
void DataTypeBuilder::hideFailed() {
    for (auto& [id, slot] : slots_) {
        if (slot.type != nullptr && slot.state == State::failed) {
            *slot.type = {};
            slot.type->typeId =
                viewOf(group_->ids.emplace_back(std::numeric_limits<std::uint16_t>::max(),
                                                static_cast<std::uint32_t>(group_->ids.size())));
            slot.type->binaryEncodingId = slot.type->typeId;
        }
    }
}

const UA_DataType* DataTypeBuilder::describe(Slot& slot, const NodesetIds& names) {
    if (slot.state != State::waiting) {
        return slot.state == State::described ? slot.type : nullptr;
    }
    slot.state = State::open;
    ++depth_;
    const auto first_within = described_.size();
    auto& members = group_->members.emplace_back();
    const bool described = depth_ <= kDeepestStructure
                               ? readMembers(slot, names, members) && fits(slot, members)
                               : refuse("structures within structures, too deeply");
    --depth_;
    if (described) {
        slot.state = State::described;
        described_.push_back(&slot);
        return slot.type;
    }
    slot.state = State::failed;
    if (slot.lent) {  // others point to what there is not
        for (auto each = first_within; each < described_.size(); ++each) {
            *described_[each]->type = {};
            described_[each]->state = State::failed;
        }
        described_.resize(first_within);
    }
    return nullptr;
}

UA_DataTypeKind DataTypeBuilder::kindOf(const Slot& slot,
                                        const std::vector<UA_DataTypeMember>& members) {
    if (isTrue(childNamed(slot.element->element, "Definition").attribute("IsUnion"))) {
        return UA_DATATYPEKIND_UNION;
    }
    const bool optional = std::any_of(members.begin(), members.end(),
                                      [](const auto& member) { return member.isOptional; });
    return optional ? UA_DATATYPEKIND_OPTSTRUCT : UA_DATATYPEKIND_STRUCTURE;
}

/// Completes the description, unless the stack has no room for it.
bool DataTypeBuilder::fits(Slot& slot, std::vector<UA_DataTypeMember>& members) {
    const auto kind = kindOf(slot, members);
    const auto size =
        kind == UA_DATATYPEKIND_UNION ? layOutAsUnion(members) : layOutInOrder(members);
    if (size > kLargestStructure || members.size() > kMostMembers) {
        return refuse(fmt::format("{} byte in {} fields, over the stack's {} byte or {} fields",
                                  size, members.size(), kLargestStructure, kMostMembers));
    }
    auto& type = *slot.type;
    type.typeName = group_->names.emplace_back(nameOf(slot.element->element)).c_str();
    type.typeId = viewOf(group_->ids.emplace_back(slot.element->id));
    const auto& encoding = slot.element->binary_encoding;
    type.binaryEncodingId =
        encoding.isNull() ? type.typeId : viewOf(group_->ids.emplace_back(encoding));
    type.memSize = static_cast<UA_UInt16>(std::max<std::size_t>(size, 1));
    type.typeKind = kind & 0x3FU;
    type.pointerFree =
        kind == UA_DATATYPEKIND_STRUCTURE && std::all_of(members.begin(), members.end(), isPlain);
    type.overlayable = false;
    type.membersSize = static_cast<UA_Byte>(members.size());
    type.members = members.data();
    return true;
}

bool DataTypeBuilder::readMembers(Slot& slot, const NodesetIds& names,
                                  std::vector<UA_DataTypeMember>& members) {
    const auto above = tree_.above(slot.element->id);
    const bool is_union_base = above == NodeId(0, std::uint32_t{UA_NS0ID_UNION});
    if (above && *above != ids::kStructure && !is_union_base) {
        const auto* base = slots_.contains(*above) ? ofFile(*above, names, false) : find(*above);
        if (base == nullptr || !isStructured(*base)) {
            return refuse("the structure above it is not described");
        }
        members.assign(base->members, base->members + base->membersSize);
    }
    for (const auto& field : childNamed(slot.element->element, "Definition").children()) {
        if (localName(field) == "Field" && !readField(field, names, members)) {
            return false;
        }
    }
    return true;
}

bool DataTypeBuilder::readField(const pugi::xml_node& field, const NodesetIds& names,
                                std::vector<UA_DataTypeMember>& members) {
    const auto* const name = field.attribute("Name").value();
    const auto id = names.nodeId(field.attribute("DataType").as_string("i=24"));
    const int rank = field.attribute("ValueRank").as_int(UA_VALUERANK_SCALAR);
    if (!id || (rank != UA_VALUERANK_SCALAR && rank != UA_VALUERANK_ONE_DIMENSION)) {
        return refuse(fmt::format("field {}: {}", sanitise(name),
                                  id ? fmt::format("ValueRank {}", rank) : id.error().message));
    }
    UA_DataTypeMember member{};
    member.isArray = rank == UA_VALUERANK_ONE_DIMENSION;
    member.isOptional = isTrue(field.attribute("IsOptional"));
    member.memberType = fieldType(field, *id, names);
    if (member.memberType == nullptr) {
        return refuse(fmt::format("field {}: no description of its data type", sanitise(name)));
    }
    member.memberName = group_->names.emplace_back(name).c_str();
    members.push_back(member);
    return true;
}

const UA_DataType* DataTypeBuilder::fieldType(const pugi::xml_node& field, const NodeId& id,
                                              const NodesetIds& names) {
    const bool by_pointer =
        field.attribute("ValueRank").as_int(-1) == 1 || isTrue(field.attribute("IsOptional"));
    const bool structure = tree_.isA(id, ids::kStructure);
    const bool open = isTrue(field.attribute("AllowSubTypes"));
    if (id == ids::kStructure || (open && structure)) {
        return &UA_TYPES[UA_TYPES_EXTENSIONOBJECT];
    }
    if (open) {
        return &UA_TYPES[UA_TYPES_VARIANT];
    }
    if (id != ids::kEnumeration && tree_.isA(id, ids::kEnumeration)) {
        return enumeration(id);
    }
    const auto* type = structure && slots_.contains(id) ? ofFile(id, names, by_pointer) : find(id);
    const bool empty = type != nullptr && isStructured(*type) && type->membersSize == 0;
    // The description of a structure that is still open has no members yet.
    const bool is_open = slots_.contains(id) && slots_.at(id).state == State::open;
    return empty && !is_open ? &UA_TYPES[UA_TYPES_EXTENSIONOBJECT] : type;
}

const UA_DataType* DataTypeBuilder::ofFile(const NodeId& id, const NodesetIds& names,
                                           bool by_pointer) {
    auto& slot = slots_.at(id);
    if (slot.state == State::open) {
        slot.lent = slot.lent || by_pointer;
        slot.type->typeKind = UA_DATATYPEKIND_STRUCTURE;
        return by_pointer ? slot.type : nullptr;
    }
    return describe(slot, names);
}

const UA_DataType* DataTypeBuilder::enumeration(const NodeId& id) {
    const UA_NodeId native = viewOf(id);
    if (const auto* known = UA_Server_findDataType(server_, &native)) {
        return known;
    }
    for (const auto& made : group_->enumerations) {
        if (UA_NodeId_equal(&made.typeId, &native)) {
            return &made;
        }
    }
    auto& made = group_->enumerations.emplace_back(UA_TYPES[UA_TYPES_INT32]);
    made.typeId = viewOf(group_->ids.emplace_back(id));
    made.typeKind = UA_DATATYPEKIND_ENUM;
    return &made;
}

}  // namespace metier::opcua
