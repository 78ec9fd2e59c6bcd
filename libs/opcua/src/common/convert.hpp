#pragma once

// The border between our value types and those of the stack: private to this library.

#include <open62541/types.h>
#include <open62541/types_generated.h>

#include <new>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "metier/opcua/value.hpp"

namespace metier::opcua {

/// A value of the stack that is cleared at the end of its scope.
template <typename Native>
class Owned {
public:
    explicit Owned(const UA_DataType& type) : type_(&type) {}
    Owned(Native value, const UA_DataType& type) : value_(value), type_(&type) {}
    ~Owned() { UA_clear(&value_, type_); }
    Owned(const Owned&) = delete;
    Owned& operator=(const Owned&) = delete;

    Native* get() noexcept { return &value_; }
    const Native* get() const noexcept { return &value_; }
    Native& operator*() noexcept { return value_; }
    Native* operator->() noexcept { return &value_; }

private:
    Native value_{};
    const UA_DataType* type_;
};

/// Throws std::bad_alloc when the stack reports that memory ran out.
inline void checkAllocated(UA_StatusCode code) {
    if (code != UA_STATUSCODE_GOOD) {
        throw std::bad_alloc();
    }
}

/// Memory that the stack has allocated; throws std::bad_alloc if there was none.
template <typename Native>
Native* checkAllocated(Native* memory) {
    return memory == nullptr ? throw std::bad_alloc() : memory;
}

/// Runs steps that call the stack until one fails, and returns the code of the last one that ran.
template <typename... Steps>
UA_StatusCode inOrder(const Steps&... steps) {
    UA_StatusCode code = UA_STATUSCODE_GOOD;
    static_cast<void>((((code = steps()) == UA_STATUSCODE_GOOD) && ...));
    return code;
}

/// Content of an ExtensionObject, or null unless it was decoded as that type.
template <typename Native>
Native* decodedAs(const UA_ExtensionObject& object, const UA_DataType& type) noexcept {
    const bool has_content = object.encoding == UA_EXTENSIONOBJECT_DECODED ||
                             object.encoding == UA_EXTENSIONOBJECT_DECODED_NODELETE;
    const auto& decoded = object.content.decoded;
    return has_content && decoded.type == &type ? static_cast<Native*>(decoded.data) : nullptr;
}

/// Path for messages, `2:Skills/2:Move`.
std::string textOf(std::span<const QualifiedName> path);

/// The stack's view of our text or id; valid as long as what it was made from.
UA_String viewOf(std::string_view text) noexcept;
/// As they are; valid as long as the bytes.
std::string_view bytesOf(const UA_ByteString& bytes) noexcept;
UA_NodeId viewOf(const NodeId& id) noexcept;
UA_QualifiedName viewOf(const QualifiedName& name) noexcept;
UA_LocalizedText viewOf(const LocalizedText& text) noexcept;
UA_BrowseDirection nativeOf(BrowseDirection direction) noexcept;

/// Text as it came, unchecked: use sanitise() before it is shown.
std::string textFrom(const UA_String& text);

UtcTime timeFrom(UA_DateTime time) noexcept;
UA_DateTime nativeTime(UtcTime time) noexcept;

// fromNative() copies; toNative() fills `target`, whose old content must not own anything.
NodeId fromNative(const UA_NodeId& id);
QualifiedName fromNative(const UA_QualifiedName& name);
LocalizedText fromNative(const UA_LocalizedText& text);
Guid fromNative(const UA_Guid& guid) noexcept;
ByteString bytesFrom(const UA_ByteString& bytes);
Argument fromNative(const UA_Argument& argument);
Reference fromNative(const UA_ReferenceDescription& reference);
DataValue fromNative(const UA_DataValue& value);
ProgramDiagnostic fromNative(const UA_ProgramDiagnostic2DataType& diagnostic);
void toNative(const NodeId& id, UA_NodeId& target);
void toNative(const Guid& guid, UA_Guid& target) noexcept;
void toNative(std::string_view text, UA_String& target);
void toNative(const QualifiedName& name, UA_QualifiedName& target);
void toNative(const LocalizedText& text, UA_LocalizedText& target);
void toNative(const Argument& argument, UA_Argument& target);
void toNative(const DataValue& value, UA_DataValue& target);
void toNative(const ProgramDiagnostic& diagnostic, UA_ProgramDiagnostic2DataType& target);

/// Door to what a Value holds.
struct ValueAccess {
    static UA_Variant& native(Value& value) noexcept;
    static const UA_Variant& native(const Value& value) noexcept;
    /// A Value with a copy of the variant's content.
    static Value copyOf(const UA_Variant& variant);
    /// A Value that takes the variant's content over; the variant is empty afterwards.
    static Value take(UA_Variant& variant) noexcept;
};

}  // namespace metier::opcua
