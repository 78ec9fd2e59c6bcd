#include "metier/opcua/types.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/convert.hpp"
#include "metier/base/text.hpp"
#include "metier/opcua/text.hpp"

namespace metier::opcua {

namespace {

/// Reports whether the numbers fit: the stack takes greater ones modulo 2^16 and 2^32, so they
/// would name another node, and takes no number as 0.
bool numbersFit(std::string_view text) {
    constexpr std::string_view kNamespace = "ns=";
    constexpr std::string_view kNumber = "i=";
    if (text.starts_with(kNamespace)) {
        const auto end = std::min(text.find(';'), text.size());
        if (!numberIn<std::uint16_t>(text.substr(kNamespace.size(), end - kNamespace.size()))) {
            return false;
        }
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return !text.starts_with(kNumber) || numberIn<std::uint32_t>(text.substr(kNumber.size()));
}

}  // namespace

Result<NodeId> NodeId::parse(std::string_view text) {
    Owned<UA_NodeId> native(UA_TYPES[UA_TYPES_NODEID]);
    if (!numbersFit(text) || UA_NodeId_parse(native.get(), viewOf(text)) != UA_STATUSCODE_GOOD) {
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
