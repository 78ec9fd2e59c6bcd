#pragma once

#include <memory>
#include <utility>

#include "metier/skill/field_list.hpp"
#include "metier/skill/skill.hpp"

namespace metier::skill {

/// A skill whose parameters and results are plain structs; derive from it and override plan().
template <typename Parameters, typename Results>
class TypedSkill : public Skill {
public:
    /// \param description its parameters and results are replaced by those of the lists
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

    const SkillDescription& description() const final { return description_; }

    Result<std::unique_ptr<ExecutionWork>> prepare(const ValueMap& snapshot) final {
        METIER_ASSIGN(auto parameters, parameters_.read(snapshot));
        return plan(parameters);
    }

    Result<CheckReport> check(const ValueMap& snapshot) final {
        METIER_ASSIGN(auto parameters, parameters_.read(snapshot));
        return assess(parameters);
    }

    /// Result fields, for work: `execution.finish(skill.results().write(result))`. Lives as long
    /// as the skill.
    const FieldList<Results>& results() const noexcept { return results_; }

protected:
    /// Makes all checks of Start, planning included; as Skill::prepare().
    virtual Result<std::unique_ptr<ExecutionWork>> plan(const Parameters& parameters) = 0;

    /// Answers Check, as Skill::check(). The default only reports whether plan() succeeds.
    virtual Result<CheckReport> assess(const Parameters& parameters) {
        METIER_TRY(plan(parameters));
        return CheckReport{};
    }

private:
    SkillDescription description_;
    FieldList<Parameters> parameters_;
    FieldList<Results> results_;
};

}  // namespace metier::skill
