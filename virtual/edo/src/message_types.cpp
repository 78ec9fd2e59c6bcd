#include "message_types.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base64.hpp"

namespace metier::virtual_edo {
namespace {

struct IntegerType {
    std::string_view name;
    std::int64_t low;
    std::uint64_t high;
};

constexpr std::array kIntegers{
    IntegerType{"int8", INT8_MIN, INT8_MAX},    IntegerType{"uint8", 0, UINT8_MAX},
    IntegerType{"int16", INT16_MIN, INT16_MAX}, IntegerType{"uint16", 0, UINT16_MAX},
    IntegerType{"int32", INT32_MIN, INT32_MAX}, IntegerType{"uint32", 0, UINT32_MAX},
    IntegerType{"int64", INT64_MIN, INT64_MAX}, IntegerType{"uint64", 0, UINT64_MAX},
};

const IntegerType* integerType(std::string_view name) {
    const auto* const type = std::ranges::find(kIntegers, name, &IntegerType::name);
    return type == kIntegers.end() ? nullptr : type;
}

bool isFloat(std::string_view type) {
    return type == "float32" || type == "float64";
}

/// Most elements that an array of a client may have.
constexpr std::size_t kLongestArray = 10'000;

/// The Python type that rosbridge would name.
std::string_view pythonType(const Json& value) {
    switch (value.type()) {
        case Json::value_t::object:
            return "<type 'dict'>";
        case Json::value_t::array:
            return "<type 'list'>";
        case Json::value_t::string:
            return "<type 'unicode'>";
        case Json::value_t::boolean:
            return "<type 'bool'>";
        case Json::value_t::number_integer:
        case Json::value_t::number_unsigned:
            return "<type 'int'>";
        case Json::value_t::number_float:
            return "<type 'float'>";
        default:
            return "<type 'NoneType'>";
    }
}

tl::unexpected<Error> mismatch(std::string_view root, const std::string& field,
                               std::string_view type, const Json& found) {
    if (field.empty()) {
        return fail(Errc::type_mismatch,
                    fmt::format("Expected a JSON object for type {} but received a {}", type,
                                pythonType(found)));
    }
    return fail(Errc::type_mismatch,
                fmt::format("{} message requires a {} for field {}, but got a {}", root, type,
                            field, pythonType(found)));
}

tl::unexpected<Error> outOfRange(std::string_view root, const std::string& field,
                                 std::string_view type, const Json& found) {
    return fail(Errc::type_mismatch, fmt::format("{} message: {} is beyond the range of {} {}",
                                                 root, found.dump(), type, field));
}

bool isWithin(const IntegerType& type, const Json& value) {
    if (value.is_number_unsigned()) {
        return value.get<std::uint64_t>() <= type.high;
    }
    const auto number = value.get<std::int64_t>();
    return number >= type.low && (number < 0 || static_cast<std::uint64_t>(number) <= type.high);
}

}  // namespace

Json finiteOrNull(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

MessageTypes::MessageTypes(const Software& software) : types_(definitionsFor(software)) {}

Result<Json> MessageTypes::complete(std::string_view type, const Json& message) const {
    if (!has(type)) {
        return fail(Errc::not_found,
                    fmt::format("Unable to load the manifest or type of {}", type));
    }
    return completeObject(type, message, {.root = type, .field = {}});
}

Result<Json> MessageTypes::completeArguments(std::string_view type, const Json& arguments) const {
    if (!arguments.is_array() || !has(type)) {
        return complete(type, arguments.is_null() ? Json::object() : arguments);
    }
    const auto& fields = types_.find(type)->second;
    if (arguments.size() > fields.size()) {
        return fail(Errc::type_mismatch, fmt::format("{} has {} fields, but got {} arguments", type,
                                                     fields.size(), arguments.size()));
    }
    Json named = Json::object();
    for (std::size_t i = 0; i < arguments.size(); ++i) {
        named[fields[i].name] = arguments[i];
    }
    return complete(type, named);
}

Result<Json> MessageTypes::completeValue(std::string_view type, const Json& value,
                                         const Place& place) const {
    if (type.ends_with(']')) {
        return completeArray(type, value, place);
    }
    if (const auto* integer = integerType(type)) {
        if (!value.is_number_integer()) {
            return mismatch(place.root, place.field, type, value);
        }
        return isWithin(*integer, value) ? Result<Json>(value)
                                         : outOfRange(place.root, place.field, type, value);
    }
    if (isFloat(type)) {
        if (!value.is_number()) {
            return mismatch(place.root, place.field, type, value);
        }
        const bool fits =
            type == "float64" || std::abs(value.get<double>()) <= std::numeric_limits<float>::max();
        return fits ? Result<Json>(value.get<double>())
                    : outOfRange(place.root, place.field, type, value);
    }
    if (type == "string" || type == "bool") {
        const bool fits = type == "string" ? value.is_string() : value.is_boolean();
        return fits ? Result<Json>(value) : mismatch(place.root, place.field, type, value);
    }
    return completeObject(type, value, place);
}

Result<Json> MessageTypes::completeArray(std::string_view type, const Json& value,
                                         const Place& place) const {
    const auto bracket = type.find('[');
    const auto element = type.substr(0, bracket);
    if (element == "uint8" && value.is_string()) {
        const auto bytes = fromBase64(value.get_ref<const std::string&>());
        return bytes ? Result<Json>(Json(*bytes)) : mismatch(place.root, place.field, type, value);
    }
    if (!value.is_array() || value.size() > kLongestArray) {
        return mismatch(place.root, place.field, type, value);
    }
    const bool fixed = type != std::string(element) + "[]";
    if (fixed && value.size() != defaultOf(type).size()) {
        return fail(Errc::type_mismatch,
                    fmt::format("{} message: field {} must be of length {}, but got {} values",
                                place.root, place.field, defaultOf(type).size(), value.size()));
    }
    Json list = Json::array();
    for (const auto& item : value) {
        METIER_ASSIGN(auto completed, completeValue(element, item, place));
        list.push_back(std::move(completed));
    }
    return list;
}

Result<Json> MessageTypes::completeObject(std::string_view type, const Json& value,
                                          const Place& place) const {
    if (!value.is_object()) {
        return mismatch(place.root, place.field, type, value);
    }
    const std::string prefix = place.field.empty() ? "" : place.field + ".";
    Json whole = defaultOf(type);
    const auto& fields = types_.find(type)->second;
    for (const auto& member : value.items()) {
        const std::string& name = member.key();
        const auto field = std::find_if(fields.begin(), fields.end(),
                                        [&](const auto& known) { return known.name == name; });
        if (field == fields.end()) {
            return fail(Errc::type_mismatch,
                        fmt::format("Message type {} does not have a field {}{}", place.root,
                                    prefix, name));
        }
        METIER_ASSIGN(auto completed, completeValue(field->type, member.value(),
                                                    {.root = place.root, .field = prefix + name}));
        whole[name] = std::move(completed);
    }
    return whole;
}

Json MessageTypes::defaultOf(std::string_view type) const {
    if (type.ends_with(']')) {
        const auto bracket = type.find('[');
        Json list = Json::array();
        if (type.substr(bracket) == "[7]") {
            list = Json(std::vector<Json>(7, defaultOf(type.substr(0, bracket))));
        }
        return list;
    }
    if (integerType(type) != nullptr) {
        return 0;
    }
    if (isFloat(type)) {
        return 0.0;
    }
    if (type == "string") {
        return "";
    }
    if (type == "bool") {
        return false;
    }
    Json object = Json::object();
    for (const auto& field : types_.find(type)->second) {
        object[field.name] = defaultOf(field.type);
    }
    return object;
}

}  // namespace metier::virtual_edo
