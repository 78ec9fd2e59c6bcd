#include "activity.hpp"

#include <fmt/format.h>

#include <cmath>

#include "call_activity.hpp"
#include "group_activities.hpp"
#include "run.hpp"

namespace metier::composition {

namespace {

std::unique_ptr<Activity> makePlain(Run& run, const Step& step, std::string path, OnEnd on_end) {
    switch (step.kind) {
        case StepKind::call:
            return std::make_unique<CallActivity>(run, step, std::move(path), std::move(on_end));
        case StepKind::sequence:
            break;
        case StepKind::parallel:
            return std::make_unique<ParallelActivity>(run, step, std::move(path),
                                                      std::move(on_end));
        case StepKind::fallback:
            return std::make_unique<FallbackActivity>(run, step, std::move(path),
                                                      std::move(on_end));
        case StepKind::choice:
            return std::make_unique<ChoiceActivity>(run, step, std::move(path), std::move(on_end));
        case StepKind::failure:
            return std::make_unique<FailureActivity>(run, step, std::move(path), std::move(on_end));
        case StepKind::loop:
            return std::make_unique<LoopActivity>(run, step, std::move(path), std::move(on_end));
    }
    return std::make_unique<SequenceActivity>(run, step, step.steps, std::move(path),
                                              std::move(on_end));
}

/// The attempts of one step, each with its time limit.
class AttemptsActivity final : public Activity {
public:
    using Activity::Activity;

    void start() override {
        ++attempt_;
        timed_out_ = false;
        inner_ = makePlain(run_, step_, path_,
                           [this](Outcome outcome) { attemptEnded(std::move(outcome)); });
        if (step_.timeout) {
            limit_.start(*step_.timeout, [this] {
                timed_out_ = true;
                inner_->halt();
            });
        }
        inner_->start();
    }

    void halt() override {
        if (halting_) {
            return;
        }
        halting_ = true;
        limit_.cancel();
        if (inner_) {
            inner_->halt();
        } else {
            pause_.cancel();
            end(cancelled());
        }
    }

    double progress() const override { return inner_ ? inner_->progress() : 0.0; }

private:
    void attemptEnded(Outcome outcome) {
        limit_.cancel();
        const bool stuck = outcome && outcome->kind == StepFailure::Kind::final;
        if (timed_out_ && !halting_ && !stuck) {
            outcome = failed(fmt::format("not done within {} s",
                                         std::chrono::duration<double>(*step_.timeout).count()));
        }
        const auto further = step_.retry ? step_.retry->times : 0U;
        const bool retries = outcome && outcome->kind == StepFailure::Kind::failed &&
                             attempt_ <= further && !halting_;
        if (!retries) {
            if (outcome && further > 0) {
                outcome->text += fmt::format(" (attempt {} of {})", attempt_, further + 1);
            }
            end(std::move(outcome));
            return;
        }
        inner_.reset();
        pause_.start(step_.retry->pause, [this] { start(); });
    }

    std::unique_ptr<Activity> inner_;  // nothing during a pause
    std::uint32_t attempt_ = 0;
    bool timed_out_ = false;
    bool halting_ = false;
    StepTimer limit_{run_};
    StepTimer pause_{run_};
};

}  // namespace

void Activity::end(Outcome outcome) {
    run_.later([on_end = std::move(on_end_), outcome = std::move(outcome)]() mutable {
        on_end(std::move(outcome));
    });
}

StepFailure Activity::failed(std::string_view why, skill::Reason reason) const {
    return {reason, fmt::format("step {}: {}", path_, why)};
}

std::string pathOf(const std::string& above, const std::string& name) {
    return above.empty() ? name : fmt::format("{}/{}", above, name);
}

std::unique_ptr<Activity> makeActivity(Run& run, const Step& step, const std::string& above,
                                       OnEnd on_end) {
    auto path = pathOf(above, step.name);
    if (step.retry || step.timeout) {
        return std::make_unique<AttemptsActivity>(run, step, std::move(path), std::move(on_end));
    }
    return makePlain(run, step, std::move(path), std::move(on_end));
}

}  // namespace metier::composition
