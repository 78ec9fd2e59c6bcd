// Whatever the stack can decode is taken over, read as every type, printed, and given back.
#include <open62541/types.h>
#include <open62541/types_generated.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "common/convert.hpp"
#include "metier/opcua/value.hpp"

namespace {

using namespace metier::opcua;
using metier::UtcTime;

/// Checks a value that was read as a T: it can be printed and read again.
template <ValueType T>
void tryAs(const Value& value) {
    if (const auto read = value.as<T>()) {
        const auto again = Value::of(*read).template as<T>();
        if (!again) {
            std::abort();
        }
    } else if (read.error().message.empty()) {
        std::abort();
    }
}

template <ScalarType... T>
void tryAll(const Value& value) {
    (tryAs<T>(value), ...);
    (tryAs<std::vector<T>>(value), ...);
}

void use(const Value& value) {
    tryAll<bool, std::int8_t, std::uint8_t, std::int16_t, std::uint16_t, std::int32_t,
           std::uint32_t, std::int64_t, std::uint64_t, float, double, std::string, UtcTime, Guid,
           ByteString, NodeId, StatusCode, QualifiedName, LocalizedText, Range, EuInformation,
           ThreeDFrame, ThreeDCartesianCoordinates, ThreeDOrientation, ThreeDVector, Argument,
           KeyValue, ProgramDiagnostic>(value);
    static_cast<void>(value.asRows());
    static_cast<void>(value.typeName());
    static_cast<void>(value.dataType().toString());
    static_cast<void>(value.toString());
    if (!nlohmann::json::accept(value.toJson())) {
        std::abort();
    }
    const Value copy =
        value;  // NOLINT(performance-unnecessary-copy-initialization): it is what is tried
    if (!(copy == value) || copy.size() != value.size()) {
        std::abort();
    }
}

/// Content of a message as one of the stack's types; nothing if it cannot be decoded.
template <typename Native, typename Use>
void decoded(const UA_ByteString& bytes, const UA_DataType& type, Use use_it) {
    Owned<Native> native(type);
    if (UA_decodeBinary(&bytes, native.get(), &type, nullptr) == UA_STATUSCODE_GOOD) {
        use_it(*native);
    }
}

void useDiagnostic(const UA_ProgramDiagnostic2DataType& native) {
    use(Value::of(fromNative(native)));
}

}  // namespace

/// The first byte chooses what the rest is.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) {
        return 0;
    }
    std::vector<std::uint8_t> copy(data + 1, data + size);
    const UA_ByteString bytes{copy.size(), copy.data()};
    switch (data[0] % 4) {
        case 0:
            decoded<UA_DataValue>(bytes, UA_TYPES[UA_TYPES_DATAVALUE], [](const auto& native) {
                const auto value = fromNative(native);
                use(value.value);
                Owned<UA_DataValue> back(UA_TYPES[UA_TYPES_DATAVALUE]);
                toNative(value, *back);
            });
            break;
        case 1:
            decoded<UA_Argument>(bytes, UA_TYPES[UA_TYPES_ARGUMENT],
                                 [](const auto& native) { use(Value::of(fromNative(native))); });
            break;
        case 2:
            decoded<UA_ProgramDiagnostic2DataType>(
                bytes, UA_TYPES[UA_TYPES_PROGRAMDIAGNOSTIC2DATATYPE], useDiagnostic);
            break;
        default:
            decoded<UA_Variant>(bytes, UA_TYPES[UA_TYPES_VARIANT],
                                [](auto& native) { use(ValueAccess::take(native)); });
    }
    return 0;
}
