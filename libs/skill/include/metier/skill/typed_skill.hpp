#pragma once

#include <memory>
#include <utility>

#include "metier/skill/field_list.hpp"
#include "metier/skill/skill.hpp"

namespace metier::skill {

/// A skill whose parameters and results are plain structs; derive from it and override plan():
///
///     struct Grasp { double force = 20.0; };
///     struct Grasped { double width = 0.0; };
///     class GraspSkill final : public TypedSkill<Grasp, Grasped> { ... };
///
/// Threading: as Skill.
///
/// A skill that closes a gripper, with a parameter and a result:
///
///     class GraspSkill final : public TypedSkill<Grasp, Grasped> {
///     public:
///         explicit GraspSkill(device::Gripper& gripper)
///             : TypedSkill({.name = "GraspSkill", .type = "GraspSkillType"},
///                          FieldList<Grasp>().add(&Grasp::force, {.name = "Force"}),
///                          FieldList<Grasped>().add(&Grasped::width, {.name = "Width"})),
///               gripper_(gripper) {}
///
///     private:
///         Result<std::unique_ptr<ExecutionWork>> plan(const Grasp& grasp) override;
///         device::Gripper& gripper_;
///     };
template <typename Parameters, typename Results>
class TypedSkill : public Skill {
public:
    /// \param description its parameters and results are replaced by those of the lists
    /// \param results     their fields get Place::final_result
    TypedSkill(SkillDescription description, FieldList<Parameters> parameters,
               FieldList<Results> results)
        : description_(std::move(description)),
          parameters_(std::move(parameters)),
          results_(std::move(results)) {
        description_.parameters = parameters_.fields();
        auto results_in_place = results_.fields();
        for (auto& result : results_in_place) {
            result.place = Place::final_result;
        }
        description_.results = std::move(results_in_place);
    }

    /// Complete once the constructor has returned; does not change.
    const SkillDescription& description() const final { return description_; }

    /// Makes the struct and calls plan(). Errors: as FieldList::read() and plan().
    Result<std::unique_ptr<ExecutionWork>> prepare(const ValueMap& snapshot) final {
        METIER_ASSIGN(auto parameters, parameters_.read(snapshot));
        return plan(parameters);
    }

    /// Makes the struct and calls assess(). Errors: as FieldList::read() and assess().
    Result<CheckReport> check(const ValueMap& snapshot) final {
        METIER_ASSIGN(auto parameters, parameters_.read(snapshot));
        return assess(parameters);
    }

    /// Makes the struct and calls assessFrom(). Errors, given to `done`: as FieldList::read() and
    /// assessFrom().
    void checkFrom(const ArmPositions& starts, const ValueMap& snapshot, CheckDone done) final {
        const auto parameters = parameters_.read(snapshot);
        if (parameters) {
            assessFrom(starts, *parameters, std::move(done));
        } else {
            done(fail(parameters.error()));
        }
    }

    /// Result fields, for work: `execution.finish(skill.results().write(result))`. Lives as long
    /// as the skill.
    const FieldList<Results>& results() const noexcept { return results_; }

protected:
    /// Makes all checks of Start, planning included; as Skill::prepare().
    /// \param parameters in the units of their fields; valid during the call, so copy what the work
    ///                   needs
    virtual Result<std::unique_ptr<ExecutionWork>> plan(const Parameters& parameters) = 0;

    /// Answers Check, as Skill::check(). The default only reports whether plan() succeeds.
    /// Override it in a skill that knows its duration, stopping distance or path.
    virtual Result<CheckReport> assess(const Parameters& parameters) {
        METIER_TRY(plan(parameters));
        return CheckReport{};
    }
    /// Answers Check for arms that may stand elsewhere by then, as Skill::checkFrom(). Override it
    /// in a skill that moves an arm, or that must ask others. The default calls assess().
    /// \param parameters valid during the call, as is `starts`
    virtual void assessFrom(const ArmPositions& starts, const Parameters& parameters,
                            CheckDone done) {
        static_cast<void>(starts);
        done(assess(parameters));
    }

private:
    // Its fields are those of the two lists, in their order.
    SkillDescription description_;
    FieldList<Parameters> parameters_;
    FieldList<Results> results_;
};

}  // namespace metier::skill
