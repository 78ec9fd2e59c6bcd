#pragma once

#include <open62541/types_generated.h>

#include <vector>

#include "metier/opcua/client.hpp"

namespace metier::opcua {

/// The stack's form of an EventFilter; a view of it, as long as both live and do not move.
class NativeEventFilter {
public:
    explicit NativeEventFilter(const EventFilter& filter);
    NativeEventFilter(const NativeEventFilter&) = delete;
    NativeEventFilter& operator=(const NativeEventFilter&) = delete;

    UA_EventFilter* get() noexcept { return &native_; }

private:
    void ofType(const NodeId& type);

    std::vector<std::vector<UA_QualifiedName>> paths_;
    std::vector<UA_SimpleAttributeOperand> fields_;
    UA_NodeId type_{};
    UA_LiteralOperand operand_{};
    UA_ExtensionObject operand_object_{};
    UA_ContentFilterElement element_{};
    UA_EventFilter native_{};
};

}  // namespace metier::opcua
