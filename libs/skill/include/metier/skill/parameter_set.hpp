#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/skill/field.hpp"
#include "metier/skill/value.hpp"

namespace metier::skill {

/// The parameter values of one skill, and the session that they are bound to while it configures.
///
/// Threading: the owner's thread.
class ParameterSet {
public:
    /// \param fields as declared
    explicit ParameterSet(Fields fields);

    /// The field of that name.
    /// Errors: not_found.
    Result<const Field*> field(std::string_view name) const;
    /// The present value of each parameter; Null if it has neither a value nor a default.
    const ValueMap& values() const noexcept { return values_; }
    /// The same, to be shared: does not change, and is the same one while the values are.
    const std::shared_ptr<const ValueMap>& snapshot();

    /// The session that the set is bound to; empty if to none.
    const std::string& boundSession() const noexcept { return session_; }
    bool isBound() const noexcept { return bound_; }
    /// Whether `session` may write and start.
    /// Errors: locked, if the set is bound to another session.
    Result<void> checkAccess(std::string_view session) const;

    /// Makes the set the session's own.
    void bind(std::string_view session);
    /// Takes a checked value; Null means the default.
    /// \return the value that holds now
    const Value& write(const Field& field, Value value);
    /// A value for every parameter: the given one, or its default.
    /// Errors: as checkValue(); invalid_argument with the names that there are none of, or that
    ///         need a value.
    Result<ValueMap> snapshotOf(const ValueMap& given) const;
    /// Whether every parameter that needs a value has one.
    /// Errors: invalid_argument, with the names that are missing.
    Result<void> checkComplete() const;
    /// The parameters that were written since the last release.
    ValueMap written() const;

    /// Ends the binding; the values fall back to their defaults.
    /// \return the names of those that changed
    std::vector<std::string_view> release();

private:
    Result<void> checkComplete(const ValueMap& values) const;

    const Fields fields_;
    ValueMap values_;
    std::shared_ptr<const ValueMap> snapshot_;  // null: not of these values
    std::vector<const Field*> written_;
    std::string session_;
    bool bound_ = false;
};

}  // namespace metier::skill
