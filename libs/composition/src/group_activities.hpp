#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "activity.hpp"

namespace metier::composition {

/// Runs other activities, one at a time.
class NestingActivity : public Activity {
public:
    using Activity::Activity;

    void halt() override {
        halting_ = true;
        if (inner_) {
            inner_->halt();
        }
    }
    double progress() const override { return inner_ ? inner_->progress() : 0.0; }

protected:
    void begin(std::unique_ptr<Activity> inner) {
        inner_ = std::move(inner);
        inner_->start();
    }

    std::unique_ptr<Activity> inner_;  // null: none runs
    bool halting_ = false;
};

/// Steps one after the other; the first failure is the whole's.
class SequenceActivity final : public NestingActivity {
public:
    SequenceActivity(Run& run, const Step& step, const std::vector<Step>& steps, std::string path,
                     OnEnd on_end)
        : NestingActivity(run, step, std::move(path), std::move(on_end)), steps_(steps) {}

    void start() override { next(); }
    double progress() const override;

private:
    void next();

    const std::vector<Step>& steps_;
    std::size_t index_ = 0;
};

/// Steps at the same time.
class ParallelActivity final : public Activity {
public:
    using Activity::Activity;

    void start() override;
    void halt() override;
    double progress() const override;

private:
    void branchEnded(std::size_t index, Outcome outcome);
    void decide(Outcome outcome);
    void haltOthers();

    struct Branch {
        std::unique_ptr<Activity> activity;
        bool ended = false;
    };
    std::vector<Branch> branches_;
    std::size_t open_ = 0;
    std::size_t awaited_ = 0;  // of the open branches, those that are not in the background
    bool deciding_ = true;     // false once the outcome is known
    Outcome outcome_;
    std::string failures_;  // texts of failures that did not decide the outcome
};

/// The first step that succeeds.
class FallbackActivity final : public NestingActivity {
public:
    using NestingActivity::NestingActivity;

    void start() override { next(); }

private:
    void next();

    std::size_t index_ = 0;
    std::string failures_;
};

/// Some steps if a condition holds, else others.
class ChoiceActivity final : public NestingActivity {
public:
    using NestingActivity::NestingActivity;

    void start() override;
};

/// Fails at once.
class FailureActivity final : public Activity {
public:
    using Activity::Activity;

    void start() override { end(failed(step_.text)); }
    void halt() override {}
    double progress() const override { return 0.0; }
};

/// Steps again and again.
class LoopActivity final : public NestingActivity {
public:
    using NestingActivity::NestingActivity;

    void start() override;
    double progress() const override;

private:
    void nextRound();
    void roundEnded(Outcome outcome);
    /// Whether another round begins.
    /// Errors: the loop failed.
    Result<bool> goesOn() const;

    std::optional<std::uint64_t> times_;
    std::uint64_t round_ = 0;
};

}  // namespace metier::composition
