#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "metier/base/error.hpp"
#include "metier/skill/value.hpp"

namespace metier::skill {

/// A unit of measure.
struct Unit {
    std::string_view symbol;  ///< as printed behind a number: "m/s"
    std::string_view name;    ///< "metre per second"
    std::string_view code;    ///< UNECE Recommendation 20 common code: "MTS"
    bool operator==(const Unit&) const = default;
};

inline constexpr Unit kOne{"", "one", "C62"};
inline constexpr Unit kMetre{"m", "metre", "MTR"};
inline constexpr Unit kRadian{"rad", "radian", "C81"};
inline constexpr Unit kSecond{"s", "second", "SEC"};
inline constexpr Unit kNewton{"N", "newton", "NEW"};
inline constexpr Unit kNewtonMetre{"N m", "newton metre", "NU"};
inline constexpr Unit kMetrePerSecond{"m/s", "metre per second", "MTS"};
inline constexpr Unit kRadianPerSecond{"rad/s", "radian per second", "2A"};
inline constexpr Unit kMetrePerSecondSquared{"m/s²", "metre per second squared", "MSK"};
inline constexpr Unit kRadianPerSecondSquared{"rad/s²", "radian per second squared", "2B"};
inline constexpr Unit kKilogram{"kg", "kilogram", "KGM"};

/// Where a field hangs below the skill's node.
enum class Place : std::uint8_t {
    parameter_set,  ///< a parameter that published clients know
    options,        ///< a parameter that they do not know
    final_result,
};

/// When a parameter is taken.
enum class Input : std::uint8_t {
    snapshot,  ///< once, at Start
    live,      ///< at Start, and every write while Running goes to the body
};

/// How many elements a list (or characters a text) may have.
struct LengthLimit {
    std::size_t least = 0;
    std::size_t most = std::numeric_limits<std::size_t>::max();
};

/// One parameter or result of a skill: what it is called, what it may hold.
struct Field {
    std::string name{};                ///< BrowseName, unique within the skill
    std::string description{};         ///< one line for a person
    ValueType type = ValueType::null;  ///< FieldList::add() fills it from the member
    Unit unit = kOne;
    std::optional<Range> range{};         ///< for every number of the value; not for frames
    std::optional<LengthLimit> length{};  ///< for lists and texts
    Value default_value{};                ///< Null: a parameter that must be given before Start,
    bool optional = false;                ///< unless it may stay Null
    Place place = Place::parameter_set;
    Input input = Input::snapshot;
    std::function<Result<void>(const Value&)>
        extra_check{};  ///< after the checks above, never Null
};

/// Whether `value` may be written to `field`. Null always may: it stands for the default.
/// Errors:  type_mismatch; out_of_range (not finite, out of range, wrong length), with value, limit
///          and unit; whatever extra_check says. The text begins with the field's name.
/// Threads: any, if extra_check is pure.
Result<void> checkValue(const Field& field, const Value& value);

/// The value to use: `value`, or the default if it is Null.
/// Errors: invalid_argument if both are Null and the field is not optional.
Result<Value> valueOrDefault(const Field& field, const Value& value);

}  // namespace metier::skill
