#pragma once

#include <functional>
#include <optional>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "metier/skill/field.hpp"

namespace metier::skill {

namespace detail {

/// Type of a member without its std::optional, and whether it had one.
/// For a member without it, Null without a default is an error.
template <typename T>
struct StripOptional {
    using Type = T;
    static constexpr bool kOptional = false;
};
template <typename T>
struct StripOptional<std::optional<T>> {
    using Type = T;
    static constexpr bool kOptional = true;
};

}  // namespace detail

/// Declares the parameters or results of a skill once, as members of a plain struct:
///
///     const auto fields = FieldList<Grasp>().add(
///         &Grasp::force, {.name = "Force", .unit = kNewton, .default_value = 20.0});
///     Result<Grasp> grasp = fields.read({{"Force", 30.0}});
///
/// A member is one of Value's types, or std::optional of one for a field that may stay Null.
/// Threading: read-only use from any thread.
template <typename T>
class FieldList {
public:
    /// Declares the next field.
    /// Fields appear to clients in this order.
    /// Defaults and ranges are checked when a Program is made of the skill, not here.
    /// \param member must be of one of Value's types, or std::optional of one; else it does not
    ///               compile
    /// \param field  type and optional are overwritten: they follow from the member
    /// \return this list, for the next add()
    template <typename Member>
    FieldList& add(Member T::*member, Field field) {
        using Plain = typename detail::StripOptional<Member>::Type;
        field.type = typeOf(Value(std::in_place_type<Plain>));
        field.optional = detail::StripOptional<Member>::kOptional;
        fields_.push_back(std::move(field));
        accessors_.push_back({
            [member](T& target, const Value& value) { target.*member = std::get<Plain>(value); },
            [member](const T& source) { return toValue(source.*member); },
        });
        return *this;
    }

    /// All declared fields, in the order of add(). Valid until the next add().
    const std::vector<Field>& fields() const noexcept { return fields_; }

    /// Makes the struct from `values`. A name that is missing, or Null, means the default; names
    /// that are not declared are ignored. A member whose value stays Null keeps the struct's own
    /// initial value.
    /// Stops at the first field that is wrong, in the order of add(). Each check runs again, so
    /// that values may come from anywhere, not from a Program alone.
    /// Errors: as checkValue(); invalid_argument if a value without default is missing.
    Result<T> read(const ValueMap& values) const {
        T target{};
        for (std::size_t i = 0; i < fields_.size(); ++i) {
            const auto found = values.find(fields_[i].name);
            const Value& given = found == values.end() ? kNull : found->second;
            METIER_TRY(checkValue(fields_[i], given));
            METIER_ASSIGN(auto value, valueOrDefault(fields_[i], given));
            if (!isNull(value)) {
                accessors_[i].set(target, value);
            }
        }
        return target;
    }

    /// Returns the members by name, without checks; an empty optional gives Null.
    /// Each declared field has an entry, so the result of a skill is complete.
    ValueMap write(const T& source) const {
        ValueMap values;
        for (std::size_t i = 0; i < fields_.size(); ++i) {
            values.emplace(fields_[i].name, accessors_[i].get(source));
        }
        return values;
    }

private:
    /// Setter and getter of one member; accessors_ and fields_ have the same order. `set` expects
    /// the type that checkValue() has made sure of.
    struct Accessor {
        std::function<void(T&, const Value&)> set;
        std::function<Value(const T&)> get;
    };

    template <typename Plain>
    static Value toValue(const Plain& value) {
        return Value(std::in_place_type<Plain>, value);
    }
    template <typename Plain>
    static Value toValue(const std::optional<Plain>& value) {
        return value ? toValue(*value) : Value{};
    }

    inline static const Value kNull{};

    std::vector<Field> fields_;
    std::vector<Accessor> accessors_;
};

}  // namespace metier::skill
