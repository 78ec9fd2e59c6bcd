#include "bare_filter.hpp"

#include "common/convert.hpp"

namespace metier::opcua::testing {

namespace {

template <typename Native>
UA_ExtensionObject objectOf(Native& content, std::size_t type) {
    UA_ExtensionObject object{};
    UA_ExtensionObject_setValueNoDelete(&object, &content, &UA_TYPES[type]);
    return object;
}

}  // namespace

BareFilter::BareFilter(const std::vector<Field>& selected) {
    for (const auto& field : selected) {
        select(field);
    }
}

void BareFilter::where(UA_FilterOperator kind, const std::vector<Operand>& operands) {
    auto& natives = operands_.emplace_back();
    for (const auto& operand : operands) {
        natives.push_back(nativeOf(operand));
    }
    where_.push_back({kind, natives.size(), natives.data()});
}

UA_EventFilter& BareFilter::native() {
    native_.selectClauses = selected_.data();
    native_.selectClausesSize = selected_.size();
    native_.whereClause = {where_.size(), where_.data()};
    return native_;
}

UA_SimpleAttributeOperand BareFilter::nativeOf(const Field& field) {
    const auto& kept = fields_.emplace_back(field);
    auto& path = paths_.emplace_back();
    for (const auto& name : kept.path) {
        path.push_back(viewOf(name));
    }
    return {viewOf(kept.type), path.size(), path.data(), UA_ATTRIBUTEID_VALUE, UA_STRING_NULL};
}

UA_ExtensionObject BareFilter::nativeOf(const Operand& operand) {
    if (const auto* element = std::get_if<Element>(&operand)) {
        return objectOf(elements_.emplace_back(UA_ElementOperand{element->index}),
                        UA_TYPES_ELEMENTOPERAND);
    }
    if (const auto* field = std::get_if<Field>(&operand)) {
        return objectOf(simple_.emplace_back(nativeOf(*field)), UA_TYPES_SIMPLEATTRIBUTEOPERAND);
    }
    const auto& value = values_.emplace_back(std::get<Value>(operand));
    return objectOf(literals_.emplace_back(UA_LiteralOperand{ValueAccess::native(value)}),
                    UA_TYPES_LITERALOPERAND);
}

}  // namespace metier::opcua::testing
