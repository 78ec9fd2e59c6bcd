#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/opcua/node_id.hpp"
#include "metier/opcua/status_code.hpp"
#include "metier/opcua/types.hpp"

namespace metier::opcua {

struct KeyValue;
struct ProgramDiagnostic;
struct ValueAccess;

template <typename T, typename... Types>
concept OneOf = (std::same_as<T, Types> || ...);

/// Scalar types that a Value can hold. An enumeration of OPC UA travels as std::int32_t.
template <typename T>
concept ScalarType =
    OneOf<T, bool, std::int8_t, std::uint8_t, std::int16_t, std::uint16_t, std::int32_t,
          std::uint32_t, std::int64_t, std::uint64_t, float, double, std::string, UtcTime, Guid,
          ByteString, NodeId, StatusCode, QualifiedName, LocalizedText, Range, EuInformation,
          ThreeDFrame, ThreeDCartesianCoordinates, ThreeDOrientation, ThreeDVector, Argument,
          KeyValue, ProgramDiagnostic>;

template <typename T>
struct IsVectorOfScalars : std::false_type {};
template <ScalarType T>
struct IsVectorOfScalars<std::vector<T>> : std::true_type {};

/// Types that a Value can hold: a scalar or a one-dimensional array of scalars.
template <typename T>
concept ValueType = ScalarType<T> || IsVectorOfScalars<T>::value;

/// Any value of a Variable, argument or event field; owns what it holds.
///
/// Structures that this program does not know keep their encoded form: they can be copied,
/// compared, passed on and printed, but not taken apart.
///
/// Threading: a value type; may be handed from thread to thread.
class Value {
public:
    /// The empty value, Null.
    Value() noexcept;
    ~Value();
    Value(const Value& other);
    Value& operator=(const Value& other);
    Value(Value&& other) noexcept;
    Value& operator=(Value&& other) noexcept;

    template <ValueType T>
    static Value of(const T& value);
    /// An array of values of any types (BaseDataType[]).
    static Value ofMixed(const std::vector<Value>& values);
    /// A Double matrix; the rows have the same length. Null without a row.
    static Value ofRows(const std::vector<std::vector<double>>& rows);
    static Value of(std::string_view value);
    static Value of(const char* value) { return of(std::string_view(value)); }

    /// Returns the content if it is of type T or of a subtype of a built-in type (Duration is read
    /// as double); numbers are not converted. An enumeration is read as std::int32_t; an array
    /// without elements or type is read as any vector.
    /// Errors: type_mismatch, naming both types.
    template <ValueType T>
    Result<T> as() const;

    /// Rows of a Double matrix; none for Null.
    /// Errors: type_mismatch.
    Result<std::vector<std::vector<double>>> asRows() const;

    bool isEmpty() const noexcept;
    bool isArray() const noexcept;
    /// Number of elements of an array, 1 for a scalar, 0 when empty.
    std::size_t size() const noexcept;
    /// The data type, e.g. `i=11` for Double; null when empty.
    NodeId dataType() const;
    /// Type for messages: `Double`, `Double[6]`, `Null`.
    std::string typeName() const;
    /// Text for people: a string without quotes, everything else as toJson(). Always printable.
    std::string toString() const;
    /// JSON (OPC 10000-6, 5.4, not reversible); always well-formed.
    std::string toJson() const;

    /// Same type and same content; NaN equals NaN.
    friend bool operator==(const Value& left, const Value& right) noexcept {
        return left.equals(right);
    }

private:
    friend struct ValueAccess;
    bool equals(const Value& other) const noexcept;

    static constexpr std::size_t kNativeSize = 48;
    alignas(std::max_align_t) std::byte native_[kNativeSize];
};

/// An entry of a list of named values.
struct KeyValue {
    QualifiedName key;
    Value value;

    friend bool operator==(const KeyValue&, const KeyValue&) = default;
};

/// Creator and last call of a Program (ProgramDiagnostic2DataType of OPC 10000-10, 5.2.8).
struct ProgramDiagnostic {
    NodeId create_session_id;
    std::string create_client_name;
    UtcTime invocation_creation_time{};
    UtcTime last_transition_time{};
    std::string last_method_call;
    NodeId last_method_session_id;
    std::vector<Argument> last_method_input_arguments;
    std::vector<Argument> last_method_output_arguments;
    std::vector<Value> last_method_input_values;
    std::vector<Value> last_method_output_values;
    UtcTime last_method_call_time{};
    StatusCode last_method_return_status;

    friend bool operator==(const ProgramDiagnostic&, const ProgramDiagnostic&) = default;
};

/// A value with its status and times.
struct DataValue {
    Value value;
    StatusCode status{};
    UtcTime source_time{};  ///< time at which it was true; UtcTime{} if not given
    UtcTime server_time{};  ///< time at which the server got it; UtcTime{} if not given

    friend bool operator==(const DataValue&, const DataValue&) = default;
};

}  // namespace metier::opcua
