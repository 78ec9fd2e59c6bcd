#include "client/client_filters.hpp"

#include "common/convert.hpp"

namespace metier::opcua {

NativeEventFilter::NativeEventFilter(const EventFilter& filter) {
    paths_.reserve(filter.fields.size());
    for (const auto& field : filter.fields) {
        auto& path = paths_.emplace_back();
        for (const auto& name : field) {
            path.push_back(viewOf(name));
        }
        UA_SimpleAttributeOperand operand{};
        operand.typeDefinitionId = viewOf(ids::kBaseEventType);
        operand.browsePathSize = path.size();
        operand.browsePath = path.data();
        operand.attributeId = UA_ATTRIBUTEID_VALUE;
        fields_.push_back(operand);
    }
    native_.selectClausesSize = fields_.size();
    native_.selectClauses = fields_.data();
    if (filter.of_type) {
        ofType(*filter.of_type);
    }
}

void NativeEventFilter::ofType(const NodeId& type) {
    type_ = viewOf(type);
    UA_Variant_setScalar(&operand_.value, &type_, &UA_TYPES[UA_TYPES_NODEID]);
    UA_ExtensionObject_setValueNoDelete(&operand_object_, &operand_,
                                        &UA_TYPES[UA_TYPES_LITERALOPERAND]);
    element_.filterOperator = UA_FILTEROPERATOR_OFTYPE;
    element_.filterOperandsSize = 1;
    element_.filterOperands = &operand_object_;
    native_.whereClause.elementsSize = 1;
    native_.whereClause.elements = &element_;
}

}  // namespace metier::opcua
