#include "call_activity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace metier::composition {

using skill::Reason;
using skill::State;

namespace {

using namespace std::chrono_literals;

// As the command `metier reset`: longer than any controller takes to release its brakes.
constexpr auto kLongestReset = 30s;
constexpr auto kResetPause = 100ms;

}  // namespace

CallActivity::~CallActivity() {
    if (stage_ == Stage::resetting || stage_ == Stage::runs) {
        used().release();
    }
    run_.detach(*this);
}

std::string CallActivity::describe() const {
    return fmt::format("step {}: {}", path_, used().name());
}

StepFailure CallActivity::failure(Reason reason, const std::string& text,
                                  StepFailure::Kind kind) const {
    return {reason, fmt::format("{} {}", describe(), text), kind};
}

void CallActivity::start() {
    run_.attach(*this);
    if (run_.held()) {
        stage_ = Stage::parked;
    } else {
        launch();
    }
}

void CallActivity::unpark() {
    if (stage_ == Stage::parked) {
        launch();
    }
}

void CallActivity::launch() {
    reset_pause_.cancel();
    const auto& bound = run_.used(step_.use);
    if (const auto available = used().available(); !available) {
        over(failure(Reason::device_lost, "cannot be reached: " + available.error().message));
    } else if (used().state() != State::halted) {
        begin();
    } else if (bound.mayReset()) {
        askReset();
    } else {
        over(failure(Reason::error,
                     fmt::format("is Halted: {}; reset it, or write reset = true in [uses.{}]",
                                 used().reasonText(), step_.use)));
    }
}

void CallActivity::askReset() {
    stage_ = Stage::resetting;
    if (!reset_limit_.running()) {
        reset_begun_ = run_.now();
        reset_limit_.start(kLongestReset, [this] { resetTimePassed(); });
    }
    if (const auto asked = used().reset(*this); !asked) {
        resetRefused(asked.error());
    }
}

/// A device that takes longer than its server waits for it is asked again, and for a while an arm
/// that has yet to come to rest.
void CallActivity::resetRefused(const Error& error) {
    used().release();
    const bool comes_to_rest =
        error.code == Errc::resource_unavailable && run_.now() - reset_begun_ < run_.restTime();
    if (error.code != Errc::timeout && !comes_to_rest) {
        over(failure(Reason::error, "refused Reset: " + error.message));
        return;
    }
    refusal_ = error.message;
    stage_ = Stage::parked;
    reset_pause_.start(kResetPause, [this] { launch(); });
}

void CallActivity::resetTimePassed() {
    used().release();
    over(failure(Reason::error,
                 fmt::format("was not Ready within {} s after Reset{}", kLongestReset.count(),
                             refusal_.empty() ? std::string() : fmt::format(" ({})", refusal_))));
}

void CallActivity::onReset(const Result<void>& outcome) {
    run_.enter([this, outcome] {
        if (stage_ != Stage::resetting) {
            return;
        }
        if (halting_) {
            used().release();
            over(cancelled());
        } else if (!outcome) {
            resetRefused(outcome.error());
        } else {
            used().release();
            stage_ = Stage::parked;
            if (!run_.held()) {
                begin();
            }
        }
    });
}

void CallActivity::begin() {
    reset_limit_.cancel();
    refusal_.clear();
    auto parameters = run_.scope().arguments(step_, used().description());
    if (!parameters) {
        over(failure(Reason::error, parameters.error().message));
        return;
    }
    auto request = run_.stepExecution(step_.name, used());
    request.parameters = std::move(*parameters);
    request.on_owner_loss = run_.onOwnerLoss();
    stage_ = Stage::runs;
    begun_ = run_.now();
    run_.used(step_.use).halted_by_us = false;
    used().begin(std::move(request), *this);
}

void CallActivity::halt() {
    if (halting_ || stage_ == Stage::ended) {
        return;
    }
    halting_ = true;
    if (stage_ == Stage::parked) {
        over(cancelled());
        return;
    }
    haltUsed();
}

void CallActivity::haltUsed() {
    reset_limit_.cancel();
    rest_timer_ = run_.after(run_.restTime(), [this] { restTimePassed(); });
    if (stage_ == Stage::runs) {
        run_.used(step_.use).halted_by_us = true;
        used().halt();
    }
}

void CallActivity::restTimePassed() {
    const double limit = std::chrono::duration<double>(run_.restTime()).count();
    auto text = fmt::format("did not end within {} s after Halt", limit);
    if (!refusal_.empty()) {
        text += " (" + refusal_ + ")";
    }
    used().release();
    over(failure(Reason::error, text, StepFailure::Kind::final));
}

void CallActivity::suspend() {
    if (stage_ != Stage::runs || halting_ || stopping_ || suspended_) {
        return;
    }
    if (const auto asked = used().suspend(); !asked) {
        refusal_ = asked.error().message;
    }
}

Result<void> CallActivity::resume() {
    auto resumed = used().resume();
    if (resumed) {
        suspended_ = false;
    }
    return resumed;
}

void CallActivity::fail(const Error& error) {
    if (halting_) {
        return;
    }
    halting_ = true;
    failure_ = failure(Reason::error, "refused Resume: " + error.message, StepFailure::Kind::final);
    haltUsed();
}

void CallActivity::forceStop() noexcept {
    if (stage_ == Stage::runs && !halting_) {
        run_.used(step_.use).halted_by_us = true;
        used().halt();
    }
}

bool CallActivity::atRest() const noexcept {
    return stage_ == Stage::parked || stage_ == Stage::ended ||
           (stage_ == Stage::runs && suspended_);
}

void CallActivity::onStopping(const UsedSkillStop& stop) {
    run_.enter([this, stop] {
        if (stage_ != Stage::runs || halting_ || stop.to != State::suspended) {
            return;
        }
        stopping_ = true;
        if (!run_.held()) {
            run_.suspendedByOther(fmt::format("{} was suspended {}", describe(), stop.text));
        }
    });
}

void CallActivity::onSuspended() {
    run_.enter([this] {
        stopping_ = false;
        suspended_ = true;
        if (!run_.held() && !halting_) {
            run_.suspendedByOther(fmt::format("{} was suspended", describe()));
        }
    });
}

void CallActivity::onResumed() {
    run_.enter([this] {
        stopping_ = suspended_ = false;
        if (run_.held()) {
            suspend();  // another client resumed it, but the whole is to stand still
        }
    });
}

void CallActivity::onProgress(const skill::Value& intermediate) {
    const auto* fraction = std::get_if<double>(&intermediate);
    if (fraction != nullptr && *fraction >= 0.0 && *fraction <= 1.0) {
        run_.enter([this, fraction = *fraction] { progress_ = fraction; });
    }
}

void CallActivity::onRefused(skill::Method method, const Error& error) {
    run_.enter([this, method, error] {
        if (method == skill::Method::resume) {
            suspended_ = true;
            fail(error);
        } else {
            refusal_ = fmt::format("{} was refused: {}", skill::toString(method), error.message);
        }
    });
}

Outcome CallActivity::outcomeOf(UsedSkillEnd& end) {
    if (failure_) {
        return std::move(failure_);
    }
    switch (end.kind) {
        case UsedSkillEnd::Kind::finished:
            return std::nullopt;
        case UsedSkillEnd::Kind::refused:
            return failure(end.reason, "refused Start: " + end.text);
        case UsedSkillEnd::Kind::lost:
            // Its server halts it, or it is halted once it can be reached: either is by us.
            run_.used(step_.use).halted_by_us = true;
            return failure(Reason::device_lost, "is lost: " + end.text);
        case UsedSkillEnd::Kind::halted:
            break;
    }
    if (halting_) {
        return cancelled();
    }
    const bool final = end.reason == Reason::by_client || end.reason == Reason::owner_lost;
    return failure(end.reason,
                   fmt::format("was Halted ({}){}{}", skill::toString(end.reason),
                               end.text.empty() ? "" : ": ", end.text),
                   final ? StepFailure::Kind::final : StepFailure::Kind::failed);
}

void CallActivity::onEnd(UsedSkillEnd end) {
    run_.enter([this, end = std::move(end)]() mutable {
        used().release();
        if (end.kind == UsedSkillEnd::Kind::finished) {
            progress_ = 1.0;
            run_.finished(path_, run_.now() - begun_);
            run_.scope().setResult(step_.name, std::move(end.result));
        }
        over(outcomeOf(end));
    });
}

void CallActivity::over(Outcome outcome) {
    stage_ = Stage::ended;
    rest_timer_.cancel();
    reset_limit_.cancel();
    reset_pause_.cancel();
    run_.detach(*this);
    this->end(std::move(outcome));
}

}  // namespace metier::composition
