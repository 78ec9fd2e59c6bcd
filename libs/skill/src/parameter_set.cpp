#include "metier/skill/parameter_set.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace metier::skill {

ParameterSet::ParameterSet(Fields fields) : fields_(std::move(fields)) {
    for (const auto& field : fields_) {
        values_.emplace(field.name, field.default_value);
    }
}

Result<const Field*> ParameterSet::field(std::string_view name) const {
    const auto* found = findField(fields_, name);
    return found == nullptr ? fail(Errc::not_found, fmt::format("no parameter {}", name))
                            : Result<const Field*>(found);
}

Result<void> ParameterSet::checkAccess(std::string_view session) const {
    if (!isBound() || isBoundTo(session)) {
        return {};
    }
    return fail(Errc::locked, "another session has configured the skill and not started it yet");
}

void ParameterSet::bind(std::string_view session) {
    session_ = session;
}

const std::shared_ptr<const ValueMap>& ParameterSet::snapshot() {
    if (!snapshot_) {
        snapshot_ = std::make_shared<const ValueMap>(values_);
    }
    return snapshot_;
}

void ParameterSet::write(const Field& field, const Value& value) {
    snapshot_.reset();
    values_.find(field.name)->second = isNull(value) ? field.default_value : value;
    if (std::find(written_.begin(), written_.end(), &field) == written_.end()) {
        written_.push_back(&field);
    }
}

Result<void> ParameterSet::checkComplete() const {
    return checkComplete(values_);
}

Result<void> ParameterSet::checkComplete(const ValueMap& values) const {
    std::string missing;
    for (const auto& field : fields_) {
        if (!field.optional && isNull(values.find(field.name)->second)) {
            missing += (missing.empty() ? "" : ", ") + field.name;
        }
    }
    if (missing.empty()) {
        return {};
    }
    return fail(Errc::invalid_argument, fmt::format("a value is needed for {}", missing));
}

Result<ValueMap> ParameterSet::snapshotOf(const ValueMap& given) const {
    ValueMap snapshot;
    for (const auto& field : fields_) {
        snapshot.emplace(field.name, field.default_value);
    }
    for (const auto& [name, value] : given) {
        const auto known = field(name);
        if (!known) {
            return fail(Errc::invalid_argument, known.error().message);
        }
        METIER_TRY(checkValue(**known, value));
        if (!isNull(value)) {
            snapshot.find(name)->second = value;
        }
    }
    METIER_TRY(checkComplete(snapshot));
    return snapshot;
}

ValueMap ParameterSet::written() const {
    ValueMap written;
    for (const Field* field : written_) {
        written.emplace(*values_.find(field->name));
    }
    return written;
}

void ParameterSet::release() {
    if (!written_.empty()) {
        snapshot_.reset();
    }
    for (const Field* field : written_) {
        values_.find(field->name)->second = field->default_value;
    }
    written_.clear();
    session_.reset();
}

}  // namespace metier::skill
