#pragma once

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "metier/composition/definition_file.hpp"
#include "metier/composition/sequence_skill.hpp"
#include "metier/skill/program.hpp"
#include "metier/skill/testing/manual_executor.hpp"
#include "metier/skill/testing/recording_observer.hpp"
#include "scripted_used_skill.hpp"

namespace metier::composition::testing {

inline const skill::Caller kClient{"session", "client", "user"};

/// A skill that moves: one limited parameter, one result.
inline skill::SkillDescription moveDescription() {
    return {
        .name = "MoveSkill",
        .type = "MoveSkillType",
        .parameters = {{.name = "Target",
                        .type = skill::ValueType::number,
                        .unit = skill::kMetre,
                        .range = skill::Range{0.0, 10.0},
                        .default_value = 0.0},
                       {.name = "Pose", .type = skill::ValueType::frame, .optional = true},
                       {.name = "Joints",
                        .type = skill::ValueType::numbers,
                        .unit = skill::kRadian,
                        .length = skill::LengthLimit{2, 2},
                        .optional = true}},
        .results = {{.name = "Reached", .type = skill::ValueType::number, .unit = skill::kMetre},
                    {.name = "ReachedPose", .type = skill::ValueType::frame}}};
}

/// A skill that grasps: a parameter that must be given, two results.
inline skill::SkillDescription graspDescription() {
    return {.name = "GraspSkill",
            .type = "GraspSkillType",
            .parameters = {{.name = "Force",
                            .type = skill::ValueType::number,
                            .unit = skill::kNewton,
                            .range = skill::Range{0.0, 80.0}}},
            .results = {{.name = "Width", .type = skill::ValueType::number, .unit = skill::kMetre},
                        {.name = "Held", .type = skill::ValueType::boolean}}};
}

/// The head of a file that uses `a` and `b`, which move, and `grip`.
inline const std::string kHead = R"(
name = "TestSkill"
rest_time = 2
[uses.a]
type = "MoveSkillType"
[uses.b]
type = "MoveSkillType"
)";

inline const std::string kHeadWithGrip = kHead + R"(
[uses.grip]
type = "GraspSkillType"
)";

/// `a`, then `b`.
inline const std::string kTwoSteps = kHead + R"(
[[step]]
name = "first"
run = "a"
[[step]]
name = "second"
run = "b"
)";

/// One step that runs `b`, which may be reset.
inline const std::string kOneThatIsReset = R"(
name = "TestSkill"
rest_time = 2
[uses.b]
type = "MoveSkillType"
reset = true
[[step]]
name = "first"
run = "b"
)";

/// A composed skill over scripted used skills; the test moves the time and everything else.
class Bench {
public:
    /// \param text a composition file; what it uses by the type GraspSkillType grasps, all else
    ///             moves
    /// \param missing aliases that nothing serves
    explicit Bench(const std::string& text, const std::set<std::string>& missing = {}) {
        auto definition = parseDefinition(text, "test.toml");
        if (!definition) {
            throw std::invalid_argument(definition.error().message);
        }
        Descriptions descriptions;
        std::map<std::string, std::unique_ptr<UsedSkill>> used_skills;
        for (const auto& use : definition->uses) {
            if (missing.contains(use.alias)) {
                continue;
            }
            const auto description =
                use.type == "GraspSkillType" ? graspDescription() : moveDescription();
            auto used = std::make_unique<ScriptedUsedSkill>(description.name + " " + use.alias,
                                                            description);
            used->on_check = [](const auto& /*request*/) { return skill::CheckReport{}; };
            used_skills_[use.alias] = used.get();
            descriptions.emplace(use.alias, description);
            used_skills.emplace(use.alias, std::move(used));
        }
        const auto deadline = restDeadlineOf(*definition);
        auto composition = compose(std::move(*definition), descriptions);
        if (!composition) {
            throw std::invalid_argument(composition.error().message);
        }
        auto sequence = std::make_unique<SequenceSkill>(
            std::move(*composition), std::move(used_skills),
            SequenceSkill::Host{executor, executor->clock(), "here.TestSkill"});
        skill = sequence.get();
        program =
            std::make_unique<skill::Program>(skill::ProgramOptions{.rest_deadline = deadline},
                                             std::move(sequence), executor, executor->clock());
        program->attach(observer);
    }

    ScriptedUsedSkill& operator[](const std::string& alias) { return *used_skills_.at(alias); }

    /// Starts, and lets what follows happen.
    Result<void> start(skill::ValueMap parameters = {}) {
        auto started = program->startWith(kClient, {"run", std::move(parameters)});
        run();
        return started.map([](const std::string& /*id*/) {});
    }
    void run() { executor->run(); }
    void advance(std::chrono::nanoseconds step) { executor->advance(step); }
    Result<void> call(skill::Method method) {
        auto outcome = command(method);
        run();
        return outcome;
    }
    std::string state() const { return std::string(toString(program->state())); }
    const std::string& why() const { return program->reasonText(); }

    std::shared_ptr<skill::testing::ManualExecutor> executor =
        std::make_shared<skill::testing::ManualExecutor>();
    skill::testing::RecordingObserver observer;
    std::unique_ptr<skill::Program> program;
    SequenceSkill* skill = nullptr;  // the program's

private:
    Result<void> command(skill::Method method) {
        switch (method) {
            case skill::Method::suspend:
                return program->suspend(kClient);
            case skill::Method::resume:
                return program->resume(kClient);
            case skill::Method::halt:
                return program->halt(kClient);
            case skill::Method::reset:
                return program->reset(kClient);
            default:
                return program->start(kClient);
        }
    }

    std::map<std::string, ScriptedUsedSkill*> used_skills_;  // owned by the skill
};

}  // namespace metier::composition::testing
