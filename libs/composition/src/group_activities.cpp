#include "group_activities.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "rounds.hpp"
#include "run.hpp"

namespace metier::composition {

void SequenceActivity::next() {
    if (index_ == steps_.size()) {
        end(std::nullopt);
        return;
    }
    begin(makeActivity(run_, steps_[index_], path_, [this](Outcome outcome) {
        inner_.reset();
        ++index_;
        if (outcome) {
            end(std::move(outcome));
        } else if (halting_) {
            end(cancelled());
        } else {
            next();
        }
    }));
}

double SequenceActivity::progress() const {
    if (steps_.empty()) {
        return 1.0;
    }
    return (static_cast<double>(index_) + NestingActivity::progress()) /
           static_cast<double>(steps_.size());
}

void ParallelActivity::start() {
    open_ = step_.steps.size();
    awaited_ = static_cast<std::size_t>(std::count_if(
        step_.steps.begin(), step_.steps.end(), [](const Step& step) { return !step.background; }));
    for (std::size_t i = 0; i < step_.steps.size(); ++i) {
        branches_.push_back({makeActivity(run_, step_.steps[i], path_, [this, i](Outcome outcome) {
            branchEnded(i, std::move(outcome));
        })});
    }
    for (const auto& branch : branches_) {
        branch.activity->start();
    }
}

void ParallelActivity::branchEnded(std::size_t index, Outcome outcome) {
    using Kind = StepFailure::Kind;
    branches_[index].ended = true;
    --open_;
    awaited_ -= step_.steps[index].background ? 0 : 1;
    const bool all = step_.wait_for == WaitFor::all;
    if (!deciding_) {
        // A skill that does not come to rest outranks an earlier decision.
        if (outcome && outcome->kind == Kind::final) {
            outcome_ = std::move(outcome);
        }
    } else if (outcome && (all || outcome->kind != Kind::failed)) {
        decide(std::move(outcome));
    } else if (!outcome && (!all || awaited_ == 0)) {
        decide(std::nullopt);
    } else if (outcome) {
        failures_ += (failures_.empty() ? "" : "; ") + outcome->text;
        if (open_ == 0) {
            decide(failed("no branch succeeded: " + failures_, outcome->reason));
        }
    }
    if (open_ == 0) {
        end(std::move(outcome_));
    }
}

void ParallelActivity::decide(Outcome outcome) {
    deciding_ = false;
    outcome_ = std::move(outcome);
    haltOthers();
}

void ParallelActivity::haltOthers() {
    for (const auto& branch : branches_) {
        if (!branch.ended) {
            branch.activity->halt();
        }
    }
}

void ParallelActivity::halt() {
    decide(deciding_ ? cancelled() : std::move(outcome_));
}

double ParallelActivity::progress() const {
    double sum = 0.0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < branches_.size(); ++i) {
        if (!step_.steps[i].background) {
            sum += branches_[i].ended ? 1.0 : branches_[i].activity->progress();
            ++count;
        }
    }
    return count == 0 ? 0.0 : sum / static_cast<double>(count);
}

void FallbackActivity::next() {
    begin(makeActivity(run_, step_.steps[index_], path_, [this](Outcome outcome) {
        inner_.reset();
        ++index_;
        if (!outcome || outcome->kind != StepFailure::Kind::failed) {
            end(std::move(outcome));
            return;
        }
        if (halting_) {
            end(cancelled());
            return;
        }
        failures_ += (failures_.empty() ? "" : "; ") + outcome->text;
        if (index_ == step_.steps.size()) {
            end(failed("nothing is left to try: " + failures_, outcome->reason));
        } else {
            next();
        }
    }));
}

void ChoiceActivity::start() {
    const auto held = run_.scope().holds(*step_.condition);
    if (!held) {
        end(failed(held.error().message));
        return;
    }
    begin(std::make_unique<SequenceActivity>(run_, step_, *held ? step_.steps : step_.otherwise,
                                             path_,
                                             [this](Outcome outcome) { end(std::move(outcome)); }));
}

void LoopActivity::start() {
    if (step_.times) {
        const auto times = run_.scope().number(*step_.times).and_then(wholeRounds);
        if (!times) {
            end(failed(times.error().message));
            return;
        }
        times_ = *times;
    }
    nextRound();
}

Result<bool> LoopActivity::goesOn() const {
    if (times_ && round_ == *times_) {
        return false;
    }
    if (step_.condition) {
        auto held = run_.scope().holds(*step_.condition);
        if (!held || !*held) {
            return held;
        }
    }
    if (step_.until && round_ > 0) {
        auto done = run_.scope().holds(*step_.until);
        if (!done || *done) {
            return done ? Result<bool>(false) : done;
        }
    }
    if (step_.at_most && round_ == *step_.at_most) {
        return fail(Errc::out_of_range, fmt::format("not done after {} rounds", round_));
    }
    return true;
}

void LoopActivity::nextRound() {
    const auto more = goesOn();
    if (!more) {
        end(failed(more.error().message));
        return;
    }
    if (halting_ || !*more) {
        end(halting_ ? Outcome(cancelled()) : std::nullopt);
        return;
    }
    ++round_;
    begin(std::make_unique<SequenceActivity>(
        run_, step_, step_.steps, fmt::format("{}[{}]", path_, round_),
        [this](Outcome outcome) { roundEnded(std::move(outcome)); }));
}

void LoopActivity::roundEnded(Outcome outcome) {
    inner_.reset();
    if (outcome) {
        end(std::move(outcome));
    } else {
        run_.nextTurn([this] { nextRound(); });
    }
}

double LoopActivity::progress() const {
    const auto rounds = times_ ? *times_ : step_.at_most.value_or(1);
    const auto done = static_cast<double>(round_) - (inner_ ? 1.0 : 0.0);
    return rounds == 0
               ? 1.0
               : std::min(1.0, (done + NestingActivity::progress()) / static_cast<double>(rounds));
}

}  // namespace metier::composition
