#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/skill/value.hpp"

namespace metier::skill {

/// A unit of measure, as OPC UA's EngineeringUnits show it to clients (OPC 10000-8).
/// Texts are literals, valid for ever.
struct Unit {
    /// Symbol as printed behind a number: "m/s".
    std::string_view symbol;
    /// Name in words: "metre per second".
    std::string_view name;
    /// Common code of UNECE Recommendation 20: "MTS".
    std::string_view code;
    bool operator==(const Unit&) const = default;
};

/// A number without unit; the default of a field.
inline constexpr Unit kOne{"", "one", "C62"};
// Units of fields; all values are in SI units and radians, never in millimetres or degrees.
/// Length.
inline constexpr Unit kMetre{"m", "metre", "MTR"};
/// Angle; also joint positions of revolute axes.
inline constexpr Unit kRadian{"rad", "radian", "C81"};
inline constexpr Unit kSecond{"s", "second", "SEC"};
inline constexpr Unit kNewton{"N", "newton", "NEW"};
/// Torque.
inline constexpr Unit kNewtonMetre{"N m", "newton metre", "NU"};
/// Velocity of a tool frame, or of a gripper's jaws.
inline constexpr Unit kMetrePerSecond{"m/s", "metre per second", "MTS"};
/// Velocity of a joint.
inline constexpr Unit kRadianPerSecond{"rad/s", "radian per second", "2A"};
/// Acceleration of a tool frame.
inline constexpr Unit kMetrePerSecondSquared{"m/s²", "metre per second squared", "MSK"};
/// Acceleration of a joint.
inline constexpr Unit kRadianPerSecondSquared{"rad/s²", "radian per second squared", "2B"};
inline constexpr Unit kKilogram{"kg", "kilogram", "KGM"};

/// All units that fields have, kOne first.
inline constexpr std::array kUnits{kOne,
                                   kMetre,
                                   kRadian,
                                   kSecond,
                                   kNewton,
                                   kNewtonMetre,
                                   kMetrePerSecond,
                                   kRadianPerSecond,
                                   kMetrePerSecondSquared,
                                   kRadianPerSecondSquared,
                                   kKilogram};

/// Place of a field below the skill's node; it decides where clients look for the Variable.
enum class Place : std::uint8_t {
    /// A parameter of the published skill model, below ParameterSet.
    parameter_set,
    /// A parameter that metier has added, below Options: published clients do not know it.
    options,
    /// A result, below FinalResultData.
    final_result,
};

/// Time at which the value of a parameter is taken.
enum class Input : std::uint8_t {
    /// Taken once, at Start. A write while Running is refused with invalid_state.
    snapshot,
    /// Taken at Start, and every write while Running goes to ExecutionWork::input().
    live,
};

/// Number of elements that a list, or of characters that a text, may have.
struct LengthLimit {
    /// Smallest number, included.
    std::size_t least = 0;
    /// Largest number, included; the default is no limit.
    std::size_t most = std::numeric_limits<std::size_t>::max();
};

/// Description of one parameter or result of a skill: its name and the values that it may hold.
/// Usually declared by FieldList::add().
///
///     Field{.name = "Velocity",
///           .description = "Largest velocity of the tool frame",
///           .type = ValueType::number,
///           .unit = kMetrePerSecond,
///           .range = Range{0.001, 2.0},
///           .default_value = 0.25}
///
/// A value is checked for its type, then for range and length, then by extra_check; the first
/// failure is reported.
struct Field {
    /// BrowseName of its Variable, unique within the parameters and within the results of a skill.
    std::string name{};
    /// One line for a person.
    std::string description{};
    /// Type that a value must have; FieldList::add() fills it from the member.
    ValueType type = ValueType::null;
    /// Unit of every number of the value; the parts of a frame have [m] and [rad] of their own.
    Unit unit = kOne;
    /// Bounds every number of the value, both ends included; frames are only checked to be finite.
    /// None: any finite number.
    std::optional<Range> range{};
    /// Bounds the number of elements of a list, or of bytes of a text. None: any length.
    std::optional<LengthLimit> length{};
    /// Value that Null stands for; Null: there is none.
    Value default_value{};
    /// Whether the value may stay Null; false: a parameter without default must be given.
    bool optional = false;
    /// Place of the Variable; results of a TypedSkill get final_result.
    Place place = Place::parameter_set;
    /// Time at which a written value takes effect.
    Input input = Input::snapshot;
    std::function<Result<void>(const Value&)>
        /// Further check, called after those above and never with Null; called on the owner's
        /// thread, must not block. Its error text gets the field's name put in front.
        extra_check{};
};

/// An ordered list of fields. Copies share the list, so that ten thousand skills of one type need
/// it only once.
///
/// Threading: as std::shared_ptr: different copies may be used on different threads; the fields
/// themselves do not change.
class Fields {
public:
    using const_iterator = std::vector<Field>::const_iterator;

    /// An empty list.
    Fields() = default;
    /// A list in the given order; names are not compared here, a Program refuses doubles.
    Fields(std::initializer_list<Field> fields) : Fields(std::vector<Field>(fields)) {}
    /// A list with the elements of a vector; copies of it share them.
    Fields(std::vector<Field> fields)  // NOLINT: implicit, as a list of fields is meant
        : fields_(std::make_shared<const std::vector<Field>>(std::move(fields))) {}

    /// Iterators in the order of the list; valid as long as one copy of it.
    const_iterator begin() const noexcept { return fields_->begin(); }
    const_iterator end() const noexcept { return fields_->end(); }
    /// Number of fields.
    std::size_t size() const noexcept { return fields_->size(); }
    bool empty() const noexcept { return fields_->empty(); }
    /// The field at that place, counted from 0; `index` must be less than size(), which is not
    /// checked.
    const Field& operator[](std::size_t index) const noexcept { return (*fields_)[index]; }
    /// A copy that may be changed.
    std::vector<Field> toVector() const { return *fields_; }
    /// Appends a field to this copy alone; copies the whole list.
    void push_back(Field field) {
        auto fields = toVector();
        fields.push_back(std::move(field));
        *this = Fields(std::move(fields));
    }

private:
    // Never null. Shared by all copies; nobody changes it.
    std::shared_ptr<const std::vector<Field>> fields_ =
        std::make_shared<const std::vector<Field>>();
};

/// The field of that name in a list of fields, or nullptr. Valid as long as the list is not
/// changed.
/// \param name compared with upper and lower case
/// Threads: any; pure.
template <typename List>
const Field* findField(const List& fields, std::string_view name) noexcept {
    const auto found = std::find_if(fields.begin(), fields.end(),
                                    [&](const Field& field) { return field.name == name; });
    return found == fields.end() ? nullptr : &*found;
}

/// Checks that `value` may be written to `field`. Null always may: it means the default.
/// Errors: type_mismatch; out_of_range (not finite, out of range, wrong length, a range whose low
///         is over its high), with value, limit and unit; any error of extra_check. The text begins
///         with the field's name.
/// Threads: any, if extra_check is pure.
Result<void> checkValue(const Field& field, const Value& value);

/// Returns `value`, or the field's default if `value` is Null. Neither is checked.
/// Errors: invalid_argument if both are Null and the field is not optional.
/// Threads: any; pure.
Result<Value> valueOrDefault(const Field& field, const Value& value);

}  // namespace metier::skill
