#include "metier/opcua/types.hpp"

#include <fmt/format.h>

#include "common/convert.hpp"
#include "metier/opcua/text.hpp"

namespace metier::opcua {

Result<NodeId> NodeId::parse(std::string_view text) {
    Owned<UA_NodeId> native(UA_TYPES[UA_TYPES_NODEID]);
    if (UA_NodeId_parse(native.get(), viewOf(text)) != UA_STATUSCODE_GOOD) {
        return fail(Errc::invalid_argument,
                    fmt::format("'{}' is not a NodeId such as ns=2;i=5", sanitise(text)));
    }
    return fromNative(*native);
}

bool NodeId::isNull() const {
    const UA_NodeId view = viewOf(*this);
    return UA_NodeId_isNull(&view);
}

std::string NodeId::toString() const {
    const UA_NodeId view = viewOf(*this);
    Owned<UA_String> text(UA_TYPES[UA_TYPES_STRING]);
    checkAllocated(UA_NodeId_print(&view, text.get()));
    return sanitise(textFrom(*text));
}

std::size_t NodeId::hash() const noexcept {
    const UA_NodeId view = viewOf(*this);
    return UA_NodeId_hash(&view);
}

std::string QualifiedName::toString() const {
    return fmt::format("{}:{}", namespace_index, sanitise(name));
}

}  // namespace metier::opcua
