#include "handover.hpp"

#include <algorithm>
#include <utility>

#include "metier/edo_driver/encoder.hpp"

namespace metier::edo_driver {
namespace {

using namespace std::chrono_literals;

constexpr auto kAnswerTime = 2s;
constexpr auto kAgreeTime = 500ms;
// The algorithm state comes every 10 ms; after this silence it is not published any more.
constexpr auto kSilence = 50ms;
// States that may still be under way when control was taken.
constexpr int kMostContradictions = 20;

}  // namespace

void Handover::begin(const Generation& generation) noexcept {
    generation_ = generation;
    state_ = State::free;
    granted_ = false;
    algorithm_ = -1;
    refusal_.clear();
}

void Handover::take(SteadyTime now, Wire& wire) {
    state_ = State::taking;
    call(generation_.take_mode, now, wire);
}

void Handover::giveBack(SteadyTime now, Wire& wire) {
    leftover_ = state_ == State::free;
    state_ = State::giving_back;
    call(generation_.give_back_mode, now, wire);
}

void Handover::call(int mode, SteadyTime now, Wire& wire) {
    granted_ = false;
    refusal_.clear();
    contradictions_ = 0;
    id_ = fmt::format("metier-switch-{}", ++calls_);
    deadline_ = now + kAnswerTime;
    wire.send(controlSwitchCallText(id_, mode));
}

void Handover::onResponse(const ServiceResponse& response, SteadyTime now) {
    const bool pending = state_ == State::taking || state_ == State::giving_back;
    if (!pending || granted_ || response.id != id_) {
        return;
    }
    if (!response.ok || !response.result_code) {
        refusal_ = fmt::format("the service failed: {}", response.text);
    } else if (*response.result_code != 0 && state_ == State::taking) {
        refusal_ = fmt::format("refused with result {}", *response.result_code);
    } else {  // the service also refuses if there is nothing to give back: a brake gave it back
              // already
        granted_ = true;
        granted_at_ = now;
        deadline_ = now + kAgreeTime;
    }
}

void Handover::onAlgorithmState(const AlgorithmState& state, SteadyTime now) noexcept {
    algorithm_ = state.value;
    heard_at_ = now;
    contradictions_ = generation_.isTaken(algorithm_) ? 0 : contradictions_ + 1;
}

bool Handover::agrees(SteadyTime now) const noexcept {
    if (algorithm_ < 0) {
        return true;
    }
    const bool told = heard_at_ > granted_at_;
    if (state_ == State::giving_back) {
        return told && !generation_.isTaken(algorithm_);
    }
    const bool silent = generation_.kind == Generation::Kind::classic &&
                        now - std::max(heard_at_, granted_at_) >= kSilence;
    return silent || (told && generation_.isTaken(algorithm_));
}

Result<void> Handover::tick(SteadyTime now) {
    if (state_ == State::free) {
        return {};
    }
    if (state_ == State::taken) {
        return contradictions_ > kMostContradictions ? failed(disagreement()) : Result<void>{};
    }
    if (!refusal_.empty()) {
        return failed(std::exchange(refusal_, {}));
    }
    if (granted_ && agrees(now)) {
        state_ = state_ == State::taking ? State::taken : State::free;
        contradictions_ = 0;
        return {};
    }
    if (now >= deadline_) {
        return failed(granted_ ? disagreement() : "no answer of the service within 2 s");
    }
    return {};
}

std::string Handover::disagreement() const {
    return fmt::format("answered, but the algorithm state is {} ({} while control is taken)",
                       algorithm_, generation_.taken_state);
}

Result<void> Handover::failed(std::string_view problem) {
    const auto before = std::exchange(state_, State::free);
    if (before == State::giving_back && leftover_) {
        return {};
    }
    const std::string_view what = before == State::taking  ? "control was not handed over"
                                  : before == State::taken ? "control was taken away"
                                                           : "control was not taken back";
    return fail(Errc::device_fault, fmt::format("{}: {}", what, problem));
}

}  // namespace metier::edo_driver
