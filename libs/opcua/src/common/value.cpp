#include "metier/opcua/value.hpp"

#include <fmt/format.h>

#include <memory>
#include <new>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "common/convert.hpp"
#include "common/dimensions.hpp"
#include "common/native.hpp"
#include "metier/opcua/text.hpp"

namespace metier::opcua {

namespace {

constexpr std::size_t kMatrixRank = 2;

template <typename T>
const UA_DataType& nativeType() noexcept {
    return UA_TYPES[Native<T>::kIndex];
}

/// Memory of the stack that is freed unless it was handed over.
struct ArrayDeleter {
    std::size_t size;
    const UA_DataType* type;
    void operator()(void* array) const noexcept { UA_Array_delete(array, size, type); }
};
using ArrayOwner = std::unique_ptr<void, ArrayDeleter>;

ArrayOwner newArray(std::size_t size, const UA_DataType& type) {
    return {checkAllocated(UA_Array_new(size, &type)), ArrayDeleter{size, &type}};
}

template <ScalarType T>
void fill(const T& value, UA_Variant& target) {
    auto memory = newArray(1, nativeType<T>());
    Native<T>::write(value, *static_cast<typename Native<T>::Type*>(memory.get()));
    UA_Variant_setScalar(&target, memory.release(), &nativeType<T>());
}

template <typename T>
void fill(const std::vector<T>& values, UA_Variant& target) {
    auto memory = newArray(values.size(), nativeType<T>());
    auto* array = static_cast<typename Native<T>::Type*>(memory.get());
    for (std::size_t i = 0; i < values.size(); ++i) {
        Native<T>::write(values[i], array[i]);
    }
    UA_Variant_setArray(&target, memory.release(), values.size(), &nativeType<T>());
}

bool isEnumeration(const UA_DataType& type) noexcept {
    return type.typeKind == UA_DATATYPEKIND_ENUM;
}

/// Whether values of `type` are laid out as those of T: it is the same, an enumeration where a
/// number is asked for, or a subtype of a built-in type, such as Duration of Double.
template <ScalarType T>
bool holds(const UA_DataType& type) noexcept {
    const auto& wanted = nativeType<T>();
    return &type == &wanted || (std::same_as<T, std::int32_t> && isEnumeration(type)) ||
           (type.typeKind == wanted.typeKind && wanted.typeKind <= UA_DATATYPEKIND_DIAGNOSTICINFO);
}

/// Element `index` of what the variant holds, a scalar being its own element 0.
template <ScalarType T>
const typename Native<T>::Type* element(const UA_Variant& variant, std::size_t index) noexcept {
    using Type = typename Native<T>::Type;
    if (holds<T>(*variant.type)) {
        return static_cast<const Type*>(variant.data) + index;
    }
    if (variant.type == &UA_TYPES[UA_TYPES_EXTENSIONOBJECT]) {
        return decodedAs<const Type>(static_cast<const UA_ExtensionObject*>(variant.data)[index],
                                     nativeType<T>());
    }
    return nullptr;
}

template <ScalarType T>
bool extract(const UA_Variant& variant, T& result) {
    if (variant.type == nullptr || !UA_Variant_isScalar(&variant)) {
        return false;
    }
    const auto* native = element<T>(variant, 0);
    if (native == nullptr) {
        return false;
    }
    result = Native<T>::read(*native);
    return true;
}

template <ScalarType T>
bool extract(const UA_Variant& variant, std::vector<T>& result) {
    if (variant.type == nullptr || UA_Variant_isScalar(&variant) ||
        variant.arrayDimensionsSize > 1) {
        return false;
    }
    if (variant.arrayLength == 0) {
        return holds<T>(*variant.type) || variant.type == &UA_TYPES[UA_TYPES_EXTENSIONOBJECT];
    }
    result.reserve(variant.arrayLength);
    for (std::size_t i = 0; i < variant.arrayLength; ++i) {
        const auto* native = element<T>(variant, i);
        if (native == nullptr) {
            return false;
        }
        result.push_back(Native<T>::read(*native));
    }
    return true;
}

template <ScalarType T>
std::string requestedName(const T&) {
    return nativeType<T>().typeName;
}

template <ScalarType T>
std::string requestedName(const std::vector<T>&) {
    return fmt::format("{}[]", nativeType<T>().typeName);
}

std::string inQuotes(const std::string& text) {
    return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string unprintable(const UA_DataType& type) {
    return inQuotes(fmt::format("unprintable {}", type.typeName));
}

/// For people, unless the stack can write only the reversible form: it has no names of namespaces,
/// and leaves them out where a Variant holds a NodeId, so that what it writes is no JSON.
std::string encoded(const void* data, const UA_DataType& type) {
    for (const bool reversible : {false, true}) {
        UA_EncodeJsonOptions options{};
        options.useReversible = reversible;
        Owned<UA_ByteString> json(UA_TYPES[UA_TYPES_BYTESTRING]);
        if (UA_encodeJson(data, &type, json.get(), &options) != UA_STATUSCODE_GOOD) {
            continue;
        }
        if (auto text = sanitise(textFrom(*json)); nlohmann::json::accept(text)) {
            return text;
        }
    }
    return unprintable(type);
}

std::string jsonOf(const void* data, const UA_DataType& type) {
    if (type.typeKind == UA_DATATYPEKIND_STRING) {
        return inQuotes(sanitise(textFrom(*static_cast<const UA_String*>(data))));
    }
    if (type.typeKind == UA_DATATYPEKIND_NODEID) {
        return inQuotes(fromNative(*static_cast<const UA_NodeId*>(data)).toString());
    }
    return dimensionsFit(data, type) ? encoded(data, type) : unprintable(type);
}

}  // namespace

static_assert(sizeof(UA_Variant) == 48, "Value::kNativeSize must follow the stack");

UA_Variant& ValueAccess::native(Value& value) noexcept {
    return *std::launder(reinterpret_cast<UA_Variant*>(value.native_.data()));
}

const UA_Variant& ValueAccess::native(const Value& value) noexcept {
    return *std::launder(reinterpret_cast<const UA_Variant*>(value.native_.data()));
}

Value ValueAccess::copyOf(const UA_Variant& variant) {
    Value value;
    checkAllocated(UA_Variant_copy(&variant, &native(value)));
    return value;
}

Value ValueAccess::take(UA_Variant& variant) noexcept {
    Value value;
    native(value) = std::exchange(variant, UA_Variant{});
    return value;
}

Value::Value() noexcept {  // NOLINT(cppcoreguidelines-pro-type-member-init): made in place
    ::new (static_cast<void*>(native_.data())) UA_Variant{};
}

Value::~Value() {
    UA_Variant_clear(&ValueAccess::native(*this));
}

Value::Value(const Value& other) : Value() {
    checkAllocated(UA_Variant_copy(&ValueAccess::native(other), &ValueAccess::native(*this)));
}

Value& Value::operator=(const Value& other) {
    return *this = Value(other);
}

Value::Value(Value&& other) noexcept : Value() {
    std::swap(ValueAccess::native(*this), ValueAccess::native(other));
}

Value& Value::operator=(Value&& other) noexcept {
    std::swap(ValueAccess::native(*this), ValueAccess::native(other));
    return *this;
}

template <ValueType T>
Value Value::of(const T& value) {
    Value result;
    fill(value, ValueAccess::native(result));
    return result;
}

Value Value::ofMixed(const std::vector<Value>& values) {
    Value result;
    fill(values, ValueAccess::native(result));
    return result;
}

Value Value::ofRows(const std::vector<std::vector<double>>& rows) {
    if (rows.empty() || rows.front().empty()) {
        return {};  // an array with a dimension of 0 cannot be sent
    }
    const std::size_t width = rows.front().size();
    std::vector<double> flat;
    flat.reserve(rows.size() * width);
    for (const auto& row : rows) {
        flat.insert(flat.end(), row.begin(), row.end());
    }
    if (flat.size() != rows.size() * width) {
        throw std::invalid_argument("a matrix has rows of one length");
    }
    Value result = of(flat);
    auto& variant = ValueAccess::native(result);
    toNative(std::vector{static_cast<UA_UInt32>(rows.size()), static_cast<UA_UInt32>(width)},
             variant.arrayDimensions, variant.arrayDimensionsSize);
    return result;
}

Result<std::vector<std::vector<double>>> Value::asRows() const {
    const auto& variant = ValueAccess::native(*this);
    std::vector<std::vector<double>> rows;
    if (isEmpty()) {
        return rows;
    }
    if (!holds<double>(*variant.type) || variant.arrayDimensionsSize != kMatrixRank ||
        std::size_t{variant.arrayDimensions[0]} * variant.arrayDimensions[1] !=
            variant.arrayLength) {
        return fail(Errc::type_mismatch, "Double matrix expected, " + typeName() + " given");
    }
    const std::size_t width = variant.arrayDimensions[1];
    const auto* flat = static_cast<const double*>(variant.data);
    for (std::size_t row = 0; row < variant.arrayDimensions[0]; ++row) {
        rows.emplace_back(flat + row * width, flat + (row + 1) * width);
    }
    return rows;
}

Value Value::of(std::string_view value) {
    return of(std::string(value));
}

template <ValueType T>
Result<T> Value::as() const {
    T result{};
    if (!extract(ValueAccess::native(*this), result)) {
        return fail(Errc::type_mismatch,
                    fmt::format("{} expected, {} given", requestedName(T{}), typeName()));
    }
    return result;
}

bool Value::isEmpty() const noexcept {
    return ValueAccess::native(*this).type == nullptr;
}

bool Value::isArray() const noexcept {
    return !isEmpty() && !UA_Variant_isScalar(&ValueAccess::native(*this));
}

std::size_t Value::size() const noexcept {
    if (isEmpty()) {
        return 0;
    }
    return isArray() ? ValueAccess::native(*this).arrayLength : 1;
}

NodeId Value::dataType() const {
    return isEmpty() ? NodeId() : fromNative(ValueAccess::native(*this).type->typeId);
}

std::string Value::typeName() const {
    if (isEmpty()) {
        return "Null";
    }
    const char* name = ValueAccess::native(*this).type->typeName;
    return isArray() ? fmt::format("{}[{}]", name, size()) : name;
}

std::string Value::toString() const {
    const UA_Variant& variant = ValueAccess::native(*this);
    if (!isEmpty() && !isArray() && variant.type->typeKind == UA_DATATYPEKIND_STRING) {
        return sanitise(textFrom(*static_cast<const UA_String*>(variant.data)));
    }
    return toJson();
}

std::string Value::toJson() const {
    const UA_Variant& variant = ValueAccess::native(*this);
    if (isEmpty()) {
        return "null";
    }
    if (!isArray()) {
        return jsonOf(variant.data, *variant.type);
    }
    std::string json = "[";
    const auto* data = static_cast<const std::byte*>(variant.data);
    for (std::size_t i = 0; i < variant.arrayLength; ++i) {
        json += i == 0 ? "" : ",";
        json += jsonOf(data + i * variant.type->memSize, *variant.type);
    }
    return json + "]";
}

bool Value::equals(const Value& other) const noexcept {
    return UA_order(&ValueAccess::native(*this), &ValueAccess::native(other),
                    &UA_TYPES[UA_TYPES_VARIANT]) == UA_ORDER_EQ;
}

// NOLINTBEGIN(bugprone-macro-parentheses): T is a type.
#define METIER_INSTANTIATE(T)                                        \
    template Value Value::of<T>(const T&);                           \
    template Result<T> Value::as<T>() const;                         \
    template Value Value::of<std::vector<T>>(const std::vector<T>&); \
    template Result<std::vector<T>> Value::as<std::vector<T>>() const;
// NOLINTEND(bugprone-macro-parentheses)

METIER_INSTANTIATE(bool)
METIER_INSTANTIATE(std::int8_t)
METIER_INSTANTIATE(std::uint8_t)
METIER_INSTANTIATE(std::int16_t)
METIER_INSTANTIATE(std::uint16_t)
METIER_INSTANTIATE(std::int32_t)
METIER_INSTANTIATE(std::uint32_t)
METIER_INSTANTIATE(std::int64_t)
METIER_INSTANTIATE(std::uint64_t)
METIER_INSTANTIATE(float)
METIER_INSTANTIATE(double)
METIER_INSTANTIATE(std::string)
METIER_INSTANTIATE(UtcTime)
METIER_INSTANTIATE(Guid)
METIER_INSTANTIATE(ByteString)
METIER_INSTANTIATE(NodeId)
METIER_INSTANTIATE(StatusCode)
METIER_INSTANTIATE(QualifiedName)
METIER_INSTANTIATE(LocalizedText)
METIER_INSTANTIATE(Range)
METIER_INSTANTIATE(EuInformation)
METIER_INSTANTIATE(ThreeDFrame)
METIER_INSTANTIATE(ThreeDCartesianCoordinates)
METIER_INSTANTIATE(ThreeDOrientation)
METIER_INSTANTIATE(ThreeDVector)
METIER_INSTANTIATE(Argument)
METIER_INSTANTIATE(KeyValue)
METIER_INSTANTIATE(ProgramDiagnostic)

#undef METIER_INSTANTIATE

}  // namespace metier::opcua
