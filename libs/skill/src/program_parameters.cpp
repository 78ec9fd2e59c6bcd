#include <fmt/format.h>

#include <string>
#include <utility>

#include "metier/skill/program.hpp"
#include "program_call.hpp"

namespace metier::skill {

Result<Value> Program::read(std::string_view parameter) const {
    const auto found = parameters_.values().find(parameter);
    if (found == parameters_.values().end()) {
        return metier::fail(Errc::not_found, fmt::format("no parameter {}", parameter));
    }
    return found->second;
}

Result<void> Program::write(const Caller& caller, std::string_view parameter, Value value,
                            std::optional<UtcTime> meant_for) {
    METIER_ASSIGN(const auto field, parameters_.field(parameter));
    if (busy_) {
        return metier::fail(Errc::invalid_state,
                            fmt::format("{} written from inside a notification", parameter));
    }
    const Call call(*this);
    if (state_ == State::ready) {
        return writeReady(caller, *field, std::move(value));
    }
    if (field->input == Input::live && sub_state_ == SubState::executing) {
        return writeLive(caller, *field, {std::move(value), meant_for});
    }
    return metier::fail(Errc::invalid_state, fmt::format("{} cannot be written while {}{}",
                                                         parameter, toString(state_), wayOut()));
}

Result<void> Program::writeReady(const Caller& caller, const Field& field, Value value) {
    METIER_TRY(checkControl(caller));
    METIER_TRY(parameters_.checkAccess(caller.session_id));
    METIER_TRY(checkValue(field, value));
    parameters_.write(field, value);
    last_write_ = clock_.now();
    if (!parameters_.isBound()) {
        parameters_.bind(caller.session_id);
        armConfigurationTimeout(options_.configuration_timeout);
        setSubState(SubState::ready_configured);
    }
    return {};
}

Result<void> Program::writeLive(const Caller& caller, const Field& field, const LiveValue& live) {
    if (caller.session_id != owner_session_) {
        return metier::fail(Errc::locked, "another session has started the skill");
    }
    METIER_TRY(checkControl(caller));
    if (!work_started_) {
        return metier::fail(Errc::invalid_state,
                            "the execution has not begun: its name is not on disk yet");
    }
    auto taken = takeLive(field, live);
    if (!taken) {
        static_cast<void>(guarded([&] { work_->inputRefused(field.name, taken.error()); }));
        return metier::fail(std::move(taken.error()));
    }
    parameters_.write(field, *taken);
    return {};
}

/// \return the value that the work has taken
Result<Value> Program::takeLive(const Field& field, const LiveValue& live) {
    METIER_TRY(checkValue(field, live.value));
    METIER_ASSIGN(auto used, valueOrDefault(field, live.value));
    LiveValue given{std::move(used), live.meant_for};
    METIER_TRY(guarded([&] { return work_->input(field.name, given); }));
    return std::move(given.value);
}

void Program::armConfigurationTimeout(std::chrono::nanoseconds delay) {
    configuration_timer_ =
        executor_->after(delay, [this] { inCall([this] { configurationTimedOut(); }); });
}

void Program::configurationTimedOut() {
    const auto left = last_write_ + options_.configuration_timeout - clock_.now();
    if (left > std::chrono::nanoseconds(0)) {
        armConfigurationTimeout(left);
    } else {
        endConfiguration();
    }
}

/// Ends the binding to a session; the state stays Ready.
void Program::endConfiguration() {
    releaseParameters();
    setSubState(SubState::ready_not_configured);
}

void Program::releaseParameters() {
    configuration_timer_.cancel();
    parameters_.release();
}

void Program::sessionClosed(std::string_view session_id) {
    onControlLost(session_id, OwnerLossAction::skill_default,
                  "the session of its client has ended");
}

}  // namespace metier::skill
