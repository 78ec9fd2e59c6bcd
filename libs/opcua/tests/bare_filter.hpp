#pragma once

#include <open62541/types_generated.h>

#include <cstdint>
#include <deque>
#include <variant>
#include <vector>

#include "metier/opcua/address_space.hpp"

namespace metier::opcua::testing {

/// A field of an event, as a SimpleAttributeOperand names it.
struct Field {
    NodeId type;  ///< TypeDefinition
    BrowsePath path;

    friend bool operator==(const Field&, const Field&) = default;
};

/// Number of an element of the where clause.
struct Element {
    std::uint32_t index;
};

using Operand = std::variant<Element, Value, Field>;

/// Any event filter, also a wrong one, in the stack's form.
class BareFilter {
public:
    BareFilter() = default;
    explicit BareFilter(const std::vector<Field>& selected);
    BareFilter(const BareFilter&) = delete;
    BareFilter& operator=(const BareFilter&) = delete;

    void select(const Field& field) { selected_.push_back(nativeOf(field)); }
    void where(UA_FilterOperator kind, const std::vector<Operand>& operands);
    /// Valid until the filter changes.
    UA_EventFilter& native();

private:
    UA_SimpleAttributeOperand nativeOf(const Field& field);
    UA_ExtensionObject nativeOf(const Operand& operand);

    // Deques keep the addresses of what they hold.
    std::deque<Field> fields_;
    std::deque<std::vector<UA_QualifiedName>> paths_;
    std::deque<Value> values_;
    std::deque<UA_SimpleAttributeOperand> simple_;
    std::deque<UA_LiteralOperand> literals_;
    std::deque<UA_ElementOperand> elements_;
    std::deque<std::vector<UA_ExtensionObject>> operands_;
    std::vector<UA_SimpleAttributeOperand> selected_;
    std::vector<UA_ContentFilterElement> where_;
    UA_EventFilter native_{};
};

}  // namespace metier::opcua::testing
