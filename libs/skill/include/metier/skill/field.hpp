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

/// A unit of measure.
struct Unit {
    std::string_view symbol;  ///< as printed behind a number: "m/s"
    std::string_view name;    ///< "metre per second"
    std::string_view code;    ///< UNECE Recommendation 20 common code: "MTS"
    bool operator==(const Unit&) const = default;
};

inline constexpr Unit kOne{"", "one", "C62"};  ///< a number without unit
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

/// Place of a field below the skill's node.
enum class Place : std::uint8_t {
    parameter_set,  ///< a parameter that published clients know
    options,        ///< a parameter that they do not know
    final_result,
};

/// Time at which the value of a parameter is taken.
enum class Input : std::uint8_t {
    snapshot,  ///< once, at Start
    live,      ///< at Start, and every write while Running goes to the work
};

/// Number of elements that a list, or of characters that a text, may have.
struct LengthLimit {
    std::size_t least = 0;                                       ///< smallest number, included
    std::size_t most = std::numeric_limits<std::size_t>::max();  ///< largest number, included
};

/// Description of one parameter or result of a skill: its name and the values that it may hold.
struct Field {
    std::string name{};                   ///< BrowseName, unique within the skill
    std::string description{};            ///< one line for a person
    ValueType type = ValueType::null;     ///< FieldList::add() fills it from the member
    Unit unit = kOne;                     ///< unit of every number of the value
    std::optional<Range> range{};         ///< bounds every number of the value; not for frames
    std::optional<LengthLimit> length{};  ///< for lists and texts
    Value default_value{};                ///< used where the value is Null; Null: there is none
    bool optional = false;                ///< false: a parameter without default must be given
    Place place = Place::parameter_set;
    Input input = Input::snapshot;
    std::function<Result<void>(const Value&)>
        extra_check{};  ///< after the checks above, never Null
};

/// An ordered list of fields. Copies share the list, so that ten thousand skills of one type need
/// it only once.
///
/// Threading: as std::shared_ptr; the fields themselves do not change.
class Fields {
public:
    using const_iterator = std::vector<Field>::const_iterator;

    Fields() = default;
    Fields(std::initializer_list<Field> fields) : Fields(std::vector<Field>(fields)) {}
    Fields(std::vector<Field> fields)  // NOLINT: implicit, as a list of fields is meant
        : fields_(std::make_shared<const std::vector<Field>>(std::move(fields))) {}

    const_iterator begin() const noexcept { return fields_->begin(); }
    const_iterator end() const noexcept { return fields_->end(); }
    std::size_t size() const noexcept { return fields_->size(); }
    bool empty() const noexcept { return fields_->empty(); }
    const Field& operator[](std::size_t index) const noexcept { return (*fields_)[index]; }
    /// A copy that may be changed.
    std::vector<Field> toVector() const { return *fields_; }
    /// Changes this copy alone.
    void push_back(Field field) {
        auto fields = toVector();
        fields.push_back(std::move(field));
        *this = Fields(std::move(fields));
    }

private:
    std::shared_ptr<const std::vector<Field>> fields_ =
        std::make_shared<const std::vector<Field>>();
};

/// The field of that name in a list of fields, or nullptr.
template <typename List>
const Field* findField(const List& fields, std::string_view name) noexcept {
    const auto found = std::find_if(fields.begin(), fields.end(),
                                    [&](const Field& field) { return field.name == name; });
    return found == fields.end() ? nullptr : &*found;
}

/// Checks that `value` may be written to `field`. Null always may: it means the default.
/// Errors:  type_mismatch; out_of_range (not finite, out of range, wrong length), with value, limit
/// and unit; any error of extra_check. The text begins with the field's name.
/// Threads: any, if extra_check is pure.
Result<void> checkValue(const Field& field, const Value& value);

/// Returns `value`, or the field's default if `value` is Null.
/// Errors: invalid_argument if both are Null and the field is not optional.
Result<Value> valueOrDefault(const Field& field, const Value& value);

}  // namespace metier::skill
