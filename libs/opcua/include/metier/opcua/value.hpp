#pragma once

#include <array>
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

/// Whether T is one of Types, exactly: no conversion, no base class.
template <typename T, typename... Types>
concept OneOf = (std::same_as<T, Types> || ...);

/// Scalar types that a Value can hold. An enumeration of OPC UA travels as std::int32_t.
/// A type that is missing here does not compile with Value::of() and as().
template <typename T>
concept ScalarType =
    OneOf<T, bool, std::int8_t, std::uint8_t, std::int16_t, std::uint16_t, std::int32_t,
          std::uint32_t, std::int64_t, std::uint64_t, float, double, std::string, UtcTime, Guid,
          ByteString, NodeId, StatusCode, QualifiedName, LocalizedText, Range, EuInformation,
          ThreeDFrame, ThreeDCartesianCoordinates, ThreeDOrientation, ThreeDVector, Argument,
          KeyValue, ProgramDiagnostic>;

/// Tests for std::vector of a ScalarType; vectors of vectors are not among them, see
/// Value::ofRows().
template <typename T>
struct IsVectorOfScalars : std::false_type {};
template <ScalarType T>
struct IsVectorOfScalars<std::vector<T>> : std::true_type {};

/// Types that a Value can hold: a scalar or a one-dimensional array of scalars.
template <typename T>
concept ValueType = ScalarType<T> || IsVectorOfScalars<T>::value;

/// Any value of a Variable, argument or event field; owns what it holds.
///
///     const auto joints = Value::of(std::vector<double>{0.0, -1.57});
///     const auto numbers = joints.as<std::vector<double>>();  // a Result
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

    /// A scalar, or a one-dimensional array of a std::vector.
    /// Copies the value. An empty vector gives an array without elements, which is not Null.
    template <ValueType T>
    static Value of(const T& value);
    /// An array of values of any types (BaseDataType[]).
    /// Each element keeps its own type. as() has no type for such an array; toJson() shows it.
    static Value ofMixed(const std::vector<Value>& values);
    /// A Double matrix; the rows have the same length. Null without a row.
    /// Throws std::invalid_argument if the rows differ in length. Rows without numbers give Null,
    /// too.
    static Value ofRows(const std::vector<std::vector<double>>& rows);
    /// A String.
    static Value of(std::string_view value);
    /// \param value ends with a zero byte; not null
    static Value of(const char* value) { return of(std::string_view(value)); }

    /// Returns the content if it is of type T or of a subtype of a built-in type (Duration is read
    /// as double); numbers are not converted. An enumeration is read as std::int32_t; an array
    /// without elements or type is read as any vector.
    /// Errors: type_mismatch, naming both types.
    ///
    ///     value.as<double>();                    // no Float, no Int32
    ///     value.as<std::vector<std::string>>();  // no scalar String, no matrix
    template <ValueType T>
    Result<T> as() const;

    /// Rows of a Double matrix; none for Null.
    /// An array of one dimension is no matrix, also if it has one row.
    /// Errors: type_mismatch.
    Result<std::vector<std::vector<double>>> asRows() const;

    /// Whether it is Null.
    bool isEmpty() const noexcept;
    /// Whether it is an array, of one or more dimensions; also one without elements.
    bool isArray() const noexcept;
    /// Number of elements of an array, 1 for a scalar, 0 when empty.
    /// Of a matrix: the number of all its elements.
    std::size_t size() const noexcept;
    /// The data type, e.g. `i=11` for Double; null when empty.
    NodeId dataType() const;
    /// Type for messages: `Double`, `Double[6]`, `Null`.
    std::string typeName() const;
    /// Text for people: a string without quotes, everything else as toJson(). Always printable.
    std::string toString() const;
    /// JSON (OPC 10000-6, 5.4, not reversible); always well-formed.
    /// A matrix is written as one flat list. What the encoder cannot write becomes a string that
    /// says so.
    std::string toJson() const;

    /// Same type and same content; NaN equals NaN.
    friend bool operator==(const Value& left, const Value& right) noexcept {
        return left.equals(right);
    }

private:
    friend struct ValueAccess;
    /// Compares by the stack's own order, which also orders structures that are kept encoded.
    bool equals(const Value& other) const noexcept;

    // A UA_Variant in place, so that no header of the stack is needed here; its size is checked at
    // compile time in value.cpp.
    static constexpr std::size_t kNativeSize = 48;
    alignas(std::max_align_t) std::array<std::byte, kNativeSize> native_;
};

/// An entry of a list of named values.
/// OPC 10000-5 (KeyValuePair).
struct KeyValue {
    /// Name of the entry.
    QualifiedName key;
    /// Its value; Null is allowed.
    Value value;

    friend bool operator==(const KeyValue&, const KeyValue&) = default;
};

/// Creator and last call of a Program (ProgramDiagnostic2DataType of OPC 10000-10, 5.2.8).
struct ProgramDiagnostic {
    /// Session that made the Program; null: the server.
    NodeId create_session_id;
    /// Application name of that session.
    std::string create_client_name;
    /// Times by the server's wall clock.
    /// Time at which the Program was made.
    UtcTime invocation_creation_time{};
    /// Time of its last change of state.
    UtcTime last_transition_time{};
    /// Name of the Method that was called last, and the session that called it.
    std::string last_method_call;
    NodeId last_method_session_id;
    /// Description and values of its arguments and results.
    std::vector<Argument> last_method_input_arguments;
    std::vector<Argument> last_method_output_arguments;
    std::vector<Value> last_method_input_values;
    std::vector<Value> last_method_output_values;
    /// Time and outcome of the call; refused calls count, too.
    UtcTime last_method_call_time{};
    StatusCode last_method_return_status;

    friend bool operator==(const ProgramDiagnostic&, const ProgramDiagnostic&) = default;
};

/// A value with its status and times.
///
/// Test `status` before `value`: a server may send the last known value with an Uncertain or Bad
/// one.
struct DataValue {
    /// Null if there is none, such as with a Bad status.
    Value value;
    /// Quality of the value.
    StatusCode status{};
    /// Time at which it was true, by its source's clock; UtcTime{} if not given.
    UtcTime source_time{};
    /// Time at which the server got it, by the server's clock; UtcTime{} if not given.
    UtcTime server_time{};

    friend bool operator==(const DataValue&, const DataValue&) = default;
};

}  // namespace metier::opcua
