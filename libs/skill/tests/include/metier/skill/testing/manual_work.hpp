#pragma once

#include "metier/base/error.hpp"
#include "metier/skill/execution_handle.hpp"
#include "metier/skill/lambda_skill.hpp"

namespace metier::skill::testing {

/// A skill that suspends and resumes at once, and whose work ends when the test says so: by
/// `execution`, which a start sets. It must outlive the skill.
inline SkillFunctions manualWork(ExecutionHandle& execution) {
    return {.start = [&execution](const ValueMap& /*parameters*/,
                                  const ExecutionHandle& started) { execution = started; },
            .suspend =
                [](const ExecutionHandle& stopped) {
                    stopped.atRest();
                    return Result<void>();
                },
            .resume = [](const ExecutionHandle& /*resumed*/) { return Result<void>(); }};
}

}  // namespace metier::skill::testing
