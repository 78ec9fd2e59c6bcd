#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "metier/skill/program.hpp"
#include "metier/skill/testing/manual_executor.hpp"
#include "metier/skill/testing/recording_observer.hpp"

namespace metier::skill::testing {

inline const Caller kAlice{"alice", "Alice's client", "alice"};
inline const Caller kBob{"bob", "Bob's client", "bob"};

/// Behaviour of a ScriptedWork, and the calls that it got; shared with the test.
struct Script {
    /// Results of prepare() and reset().
    Result<void> prepared{};
    Result<void> reset{};
    Result<void> suspended{};
    Result<void> resumed{};
    Result<void> input_taken{};
    /// Called inside start(), if set.
    std::function<void(const ExecutionHandle&)> on_start{};
    /// Called inside suspend() and halt(), if set; else the test answers.
    std::function<void(const ExecutionHandle&)> on_stop{};

    std::vector<std::string> calls{};
    std::vector<std::string> refusals{};  ///< of refused live values
    std::optional<UtcTime> meant_for{};   ///< of the last live value
    ValueMap snapshot{};
    ExecutionHandle execution{};
    int bodies_alive = 0;
};

class ScriptedWork final : public ExecutionWork {
public:
    explicit ScriptedWork(std::shared_ptr<Script> script) : script_(std::move(script)) {
        ++script_->bodies_alive;
    }
    ~ScriptedWork() override {
        --script_->bodies_alive;
        script_->calls.emplace_back("destroyed");
    }
    ScriptedWork(const ScriptedWork&) = delete;
    ScriptedWork& operator=(const ScriptedWork&) = delete;

    void start(ExecutionHandle execution) override {
        script_->calls.emplace_back("start");
        script_->execution = std::move(execution);
        if (script_->on_start) {
            script_->on_start(script_->execution);
        }
    }
    Result<void> suspend() override {
        stop("suspend");
        return script_->suspended;
    }
    Result<void> resume() override {
        script_->calls.emplace_back("resume");
        return script_->resumed;
    }
    void halt() override { stop("halt"); }
    void forceStop() noexcept override { script_->calls.emplace_back("forceStop"); }
    Result<void> input(std::string_view parameter, const LiveValue& live) override {
        script_->calls.push_back(std::string(parameter) + " = " + toString(live.value));
        script_->meant_for = live.meant_for;
        return script_->input_taken;
    }
    void inputRefused(std::string_view parameter, const Error& why) override {
        script_->refusals.push_back(std::string(parameter) + " refused: " + why.message);
    }

private:
    void stop(std::string call) {
        script_->calls.push_back(std::move(call));
        if (script_->on_stop) {
            script_->on_stop(script_->execution);
        }
    }

    // Shared with the test, which reads it after the work was destroyed.
    std::shared_ptr<Script> script_;
};

class ScriptedSkill final : public Skill {
public:
    ScriptedSkill(SkillDescription description, std::shared_ptr<Script> script)
        : description_(std::move(description)), script_(std::move(script)) {}

    const SkillDescription& description() const override { return description_; }
    Result<std::unique_ptr<ExecutionWork>> prepare(const ValueMap& snapshot) override {
        script_->snapshot = snapshot;
        if (!script_->prepared) {
            return metier::fail(script_->prepared.error());
        }
        return std::make_unique<ScriptedWork>(script_);
    }
    Result<void> reset() override {
        script_->calls.emplace_back("reset");
        return script_->reset;
    }

private:
    SkillDescription description_;
    std::shared_ptr<Script> script_;
};

/// A skill that welds: one limited parameter, one with default, one live, two results.
inline SkillDescription weldDescription() {
    return {
        .name = "WeldSkill",
        .type = "WeldSkillType",
        .parameters =
            {
                {.name = "Speed",
                 .type = ValueType::number,
                 .unit = kMetrePerSecond,
                 .range = Range{0.0, 2.0},
                 .default_value = 0.5},
                {.name = "Seam", .type = ValueType::text, .default_value = std::string("straight")},
                {.name = "Offset",
                 .type = ValueType::number,
                 .unit = kMetre,
                 .range = Range{-0.1, 0.1},
                 .default_value = 0.0,
                 .input = Input::live},
            },
        .results = {{.name = "Length", .type = ValueType::number, .unit = kMetre},
                    {.name = "Good", .type = ValueType::boolean}},
        .on_owner_loss = OwnerLossAction::halt,
    };
}

/// A Program with a scripted skill, an executor and an observer; the test moves all of them.
struct ProgramBench {
    explicit ProgramBench(ProgramOptions options = {}, SkillDescription what = weldDescription(),
                          std::shared_ptr<ManualExecutor> on = std::make_shared<ManualExecutor>())
        : executor(std::move(on)),
          program(std::make_unique<Program>(
              std::move(options), std::make_unique<ScriptedSkill>(std::move(what), script),
              executor, executor->clock())) {
        program->attach(observer);
    }

    /// Brings the Program into `state`, from Ready; the log is empty then.
    void enter(State state) {
        if (state != State::ready && state != State::halted) {
            static_cast<void>(program->start(kAlice));
        }
        if (state == State::suspended) {
            static_cast<void>(program->suspend(kAlice));
            script->execution.atRest();
        }
        if (state == State::halted) {
            static_cast<void>(program->halt(kAlice));
        }
        executor->run();
        forget();
    }
    void forget() {
        observer.clear();
        script->calls.clear();
    }
    Result<void> call(Method method, const Caller& caller = kAlice) const {
        switch (method) {
            case Method::start:
                return program->start(caller);
            case Method::start_with:
                return program->startWith(caller, {}).map([](const std::string& /*id*/) {});
            case Method::suspend:
                return program->suspend(caller);
            case Method::resume:
                return program->resume(caller);
            case Method::halt:
                return program->halt(caller);
            case Method::reset:
                return program->reset(caller);
        }
        return metier::fail(Errc::internal, "no such method");
    }
    /// Runs the posted reports of work.
    void run() const { executor->run(); }

    std::shared_ptr<ManualExecutor> executor;
    std::shared_ptr<Script> script = std::make_shared<Script>();
    RecordingObserver observer;
    std::unique_ptr<Program> program;
};

}  // namespace metier::skill::testing
