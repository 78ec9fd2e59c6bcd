#include "run.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "call_activity.hpp"
#include "execution_id.hpp"
#include "group_activities.hpp"

namespace metier::composition {

void StepTimer::start(std::chrono::nanoseconds delay, std::function<void()> due) {
    cancel();
    remaining_ = delay;
    due_ = std::move(due);
    run_.timers_.push_back(this);
    if (!run_.held()) {
        go();
    }
}

void StepTimer::cancel() {
    timer_.cancel();
    running_ = false;
    due_ = nullptr;
    std::erase(run_.timers_, this);
}

void StepTimer::pause() {
    if (running_) {
        remaining_ -= run_.setup_.clock.now() - since_;
        timer_.cancel();
        running_ = false;
    }
}

void StepTimer::go() {
    since_ = run_.setup_.clock.now();
    running_ = true;
    timer_ = run_.after(std::max(remaining_, std::chrono::nanoseconds(0)), [this] {
        auto due = std::move(due_);
        cancel();
        due();
    });
}

Run::Run(RunSetup setup, skill::ValueMap parameters)
    : setup_(std::move(setup)), scope_(std::move(parameters)) {}

Run::~Run() {
    *alive_ = false;
    due_.clear();
    root_.reset();
}

void Run::start(skill::ExecutionHandle execution) {
    execution_ = std::move(execution);
    enter([this] {
        const auto& root = setup_.composition.definition.root;
        root_ = std::make_unique<SequenceActivity>(
            *this, root, root.steps, "", [this](Outcome outcome) { ended(std::move(outcome)); });
        root_->start();
    });
}

void Run::enter(const std::function<void()>& work) {
    if (draining_) {
        due_.push_back(work);
        return;
    }
    draining_ = true;
    work();
    drain();
    draining_ = false;
}

void Run::drain() {
    while (!due_.empty()) {
        const auto work = std::move(due_.front());
        due_.pop_front();
        work();
    }
    report();
    checkRest();
}

void Run::nextTurn(std::function<void()> work) {
    setup_.executor->post([this, alive = alive_, work = std::move(work)] {
        if (*alive) {
            enter(work);
        }
    });
}

skill::Timer Run::after(std::chrono::nanoseconds delay, std::function<void()> due) {
    return setup_.executor->after(delay, [this, due = std::move(due)] { enter(due); });
}

void Run::finished(const std::string& path, std::chrono::nanoseconds time) {
    if (finished_.size() < kMostReportedSteps) {
        finished_.push_back(path);
        times_.push_back(std::chrono::duration<double>(time).count());
    }
}

skill::StartRequest Run::stepExecution(const std::string& step, const UsedSkill& used) {
    skill::StartRequest request{.parent = {.id = execution_.id()}};
    request.execution_id = stepExecutionId({setup_.origin, execution_.id(), step, ++begun_});
    execution_.started({request.execution_id, used.description().name, used.serverUrl()});
    return request;
}

void Run::suspend() {
    held_ = true;
    suspending_ = true;
    for (auto* timer : timers_) {
        timer->pause();
    }
    rest_timer_ = after(restTime(), [this] { restTimePassed(); });
    enter([this] {
        for (auto* call : calls_) {
            call->suspend();
        }
    });
}

Result<void> Run::resume() {
    bool first = true;
    for (auto* call : calls_) {
        if (!call->needsResume()) {
            continue;
        }
        auto resumed = call->resume();
        if (!resumed && first) {
            return resumed;
        }
        if (!resumed) {
            call->fail(resumed.error());
        }
        first = false;
    }
    held_ = false;
    const auto timers = timers_;
    for (auto* timer : timers) {
        timer->go();
    }
    enter([this] {
        const auto calls = calls_;
        for (auto* call : calls) {
            call->unpark();
        }
    });
    return {};
}

void Run::halt() {
    held_ = false;
    suspending_ = false;
    halting_ = true;
    enter([this] {
        if (over_) {
            execution_.atRest();
        } else {
            root_->halt();
        }
    });
}

void Run::forceStop() noexcept {
    for (auto* call : calls_) {
        call->forceStop();
    }
}

/// Suspended, once everything that runs is at rest.
void Run::checkRest() {
    const bool at_rest = std::all_of(calls_.begin(), calls_.end(),
                                     [](const CallActivity* call) { return call->atRest(); });
    if (suspending_ && (!over_ || tidying_) && at_rest) {
        suspending_ = false;
        rest_timer_.cancel();
        execution_.atRest();
    }
}

void Run::restTimePassed() {
    std::vector<std::string> names;
    for (const auto* call : calls_) {
        if (!call->atRest()) {
            names.push_back(call->describe());
        }
    }
    gave_up_ = StepFailure{
        skill::Reason::error,
        fmt::format("not at rest within {} s after Suspend, and halted: {}",
                    std::chrono::duration<double>(restTime()).count(), fmt::join(names, ", ")),
        StepFailure::Kind::final};
    suspending_ = false;
    root_->halt();
}

void Run::ended(Outcome outcome) {
    over_ = true;
    rest_timer_.cancel();
    if (gave_up_) {
        outcome = std::move(gave_up_);
    }
    if (halting_ && !(outcome && outcome->kind == StepFailure::Kind::final)) {
        execution_.atRest();
    } else if (outcome) {
        execution_.fail(outcome->reason, std::move(outcome->text));
    } else {
        // Resets what was halted on the way, such as background steps: the next execution finds it
        // Ready.
        tidying_ = true;
        resets_.start(setup_.used);
    }
}

void Run::finish() {
    tidying_ = false;
    scope_.setResult(std::string(kExecution),
                     {{std::string(kExecutionSteps), std::move(finished_)},
                      {std::string(kExecutionDurations), std::move(times_)}});
    skill::ValueMap result;
    for (const auto& declared : setup_.composition.definition.results) {
        auto value = scope_.evaluate(declared.from, declared.field.type);
        if (!value && declared.field.optional && value.error().code == Errc::invalid_argument) {
            continue;  // the used skill left it Null
        }
        if (!value) {
            execution_.fail(skill::Reason::error, value.error().message);
            return;
        }
        result.emplace(declared.field.name, std::move(*value));
    }
    execution_.finish(std::move(result));
}

std::string Run::stepNames() const {
    std::vector<std::string_view> paths;
    for (const auto* call : calls_) {
        paths.push_back(call->path());
    }
    return fmt::format("{}", fmt::join(paths, ", "));
}

/// Tells step and progress where they have changed.
void Run::report() {
    if (over_ || !root_) {
        return;
    }
    if (auto step = stepNames(); step != reported_step_ && !step.empty()) {
        reported_step_ = std::move(step);
        execution_.step(reported_step_);
    }
    if (const auto progress = root_->progress(); progress != published_progress_) {
        published_progress_ = progress;
        execution_.progress(progress);
    }
}

}  // namespace metier::composition
