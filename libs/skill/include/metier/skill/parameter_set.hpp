#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/skill/field.hpp"
#include "metier/skill/value.hpp"

namespace metier::skill {

/// The parameter values of one skill, and the session to which they are bound before a Start.
///
/// Threading: the owner's thread.
class ParameterSet {
public:
    /// Every parameter begins with its default, and the set is free.
    /// \param fields as declared; their names must differ
    explicit ParameterSet(Fields fields);

    /// Looks up the field of that name; it is valid as long as this set.
    /// Errors: not_found.
    Result<const Field*> field(std::string_view name) const;
    /// Present value of each parameter; Null if it has neither a value nor a default. Valid as long
    /// as this set; its content follows the writes.
    const ValueMap& values() const noexcept { return values_; }
    /// Same values, to be shared: the snapshot never changes; a new one is made after a write. The
    /// reference is valid until the next write() or release().
    const std::shared_ptr<const ValueMap>& snapshot();

    /// Whether the set is bound to any session.
    bool isBound() const noexcept { return session_.has_value(); }
    /// Whether the set is bound to this session.
    bool isBoundTo(std::string_view session) const noexcept { return session_ == session; }
    /// Checks that `session` may write and start.
    /// Errors: locked, if the set is bound to another session.
    Result<void> checkAccess(std::string_view session) const;

    /// Binds the set to a session. Nothing is checked: call checkAccess() before.
    void bind(std::string_view session);
    /// Takes a value that checkValue() has accepted; Null means the default.
    /// \param field one that field() has returned
    void write(const Field& field, const Value& value);
    /// Returns a value for every parameter: the given one, or its default. The values of this set
    /// are not used and not changed.
    /// Errors: as checkValue(); invalid_argument, with the name that is unknown or those that need
    ///         a value.
    Result<ValueMap> snapshotOf(const ValueMap& given) const;
    /// Checks that every parameter that needs a value has one.
    /// Errors: invalid_argument, with the names that are missing.
    Result<void> checkComplete() const;
    /// Parameters that were written since the last release(), with their present values.
    ValueMap written() const;

    /// Ends the binding; written values fall back to their defaults.
    void release();

private:
    Result<void> checkComplete(const ValueMap& values) const;

    const Fields fields_;
    ValueMap values_;
    std::shared_ptr<const ValueMap> snapshot_;  // null: not of these values
    std::vector<const Field*> written_;
    std::optional<std::string> session_;
};

}  // namespace metier::skill
