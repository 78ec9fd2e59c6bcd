#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "activity.hpp"

namespace metier::composition {

/// Steps one after the other; the first failure is the whole's.
class SequenceActivity final : public Activity {
public:
    SequenceActivity(Run& run, const Step& step, const std::vector<Step>& steps, std::string path,
                     OnEnd on_end)
        : Activity(run, step, std::move(path), std::move(on_end)), steps_(steps) {}

    void start() override { next(); }
    void halt() override;
    double progress() const override;

private:
    void next();

    const std::vector<Step>& steps_;
    std::size_t index_ = 0;
    bool halting_ = false;
    std::unique_ptr<Activity> current_;
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
class FallbackActivity final : public Activity {
public:
    using Activity::Activity;

    void start() override { next(); }
    void halt() override;
    double progress() const override { return current_ ? current_->progress() : 0.0; }

private:
    void next();

    std::size_t index_ = 0;
    bool halting_ = false;
    std::string failures_;
    std::unique_ptr<Activity> current_;
};

/// Some steps if a condition holds, else others.
class ChoiceActivity final : public Activity {
public:
    using Activity::Activity;

    void start() override;
    void halt() override;
    double progress() const override { return chosen_ ? chosen_->progress() : 0.0; }

private:
    std::unique_ptr<Activity> chosen_;
};

/// Fails at once.
class FailureActivity final : public Activity {
public:
    using Activity::Activity;

    void start() override;
    void halt() override {}
    double progress() const override { return 0.0; }
};

/// Steps again and again.
class LoopActivity final : public Activity {
public:
    using Activity::Activity;

    void start() override;
    void halt() override;
    double progress() const override;

private:
    void nextRound();
    void roundEnded(Outcome outcome);
    /// Whether another round begins.
    /// Errors: the loop failed.
    Result<bool> goesOn() const;

    std::optional<std::uint64_t> times_;
    std::uint64_t round_ = 0;
    bool halting_ = false;
    std::unique_ptr<Activity> work_;
};

}  // namespace metier::composition
