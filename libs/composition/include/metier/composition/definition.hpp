#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "metier/skill/field.hpp"
#include "metier/skill/skill.hpp"
#include "metier/skill/value.hpp"

namespace metier::composition {

// What a composition file says (docs/guide/compose.md). Lines count from 1 and are for messages.

/// A constant as the file has it; its type follows from where it goes.
using Literal = std::variant<bool, std::int64_t, double, std::string, std::vector<double>,
                             std::vector<std::string>, std::vector<std::vector<double>>>;

/// Names a parameter of the composed skill, or a result of a step before.
struct Reference {
    std::string step{};  ///< empty: a parameter
    std::string name{};
    /// One number of it, from 0; of a frame x, y, z, a, b, c in this order.
    std::optional<std::size_t> element{};
};

/// One number of a list.
struct Term {
    double constant = 0.0;
    std::optional<Reference> from{};  ///< instead of the constant
    double factor = 1.0;              ///< of what comes from there
};

/// Along which axes a frame is shifted.
enum class ShiftAxes { base, own };

/// Where a value comes from.
struct Binding {
    std::uint32_t line = 0;
    std::string key{};  ///< where it stands: "step[1].with.Force"
    std::variant<Literal, Reference, std::vector<Term>> source{};
    /// Added number by number; to a frame, along the axes of the frame that it is given in [m].
    std::vector<Term> shift{};
    ShiftAxes shift_axes = ShiftAxes::base;  ///< own: along the axes of the shifted frame itself
    /// The Literal in the type of its target; Null before compose().
    skill::Value constant{};
};

struct Condition {
    enum class Kind { is, less, greater, all, any, negation };
    Kind kind = Kind::is;
    std::uint32_t line = 0;
    std::string key{};
    Reference subject{};             ///< of is, less, greater
    Binding operand{};               ///< of is, less, greater
    std::vector<Condition> parts{};  ///< of all, any, negation
};

/// A parameter of the called skill with its value.
struct Argument {
    std::string name{};
    Binding value{};
};

/// Further attempts after one that failed.
struct Retry {
    std::uint32_t times = 1;
    std::chrono::nanoseconds pause{0};  ///< before each further attempt
};

enum class StepKind {
    call,
    sequence,
    parallel,  ///< all at the same time
    fallback,  ///< the first that succeeds
    choice,    ///< `steps` if the condition holds, else `otherwise`
    loop,
    failure,  ///< fails, in the file's words
};

enum class WaitFor {
    all,  ///< one failure fails the whole, and halts the others
    any,  ///< one success is the whole's, and halts the others
};

struct Step {
    std::uint32_t line = 0;
    std::string key{};  ///< where it stands: "step[1].parallel[0]"
    std::string name{};
    StepKind kind = StepKind::call;
    std::string use{};                  ///< of a call
    std::vector<Argument> arguments{};  ///< of a call
    std::string text{};                 ///< of a failure
    std::vector<Step> steps{};          ///< of all others
    std::vector<Step> otherwise{};      ///< of a choice
    WaitFor wait_for = WaitFor::all;    ///< of a parallel
    /// Of a step within a parallel: nobody waits for its end; it is halted with the others.
    bool background = false;
    std::optional<Condition> condition{};    ///< of a choice; of a loop, holds before each round
    std::optional<Condition> until{};        ///< of a loop, ends it after a round
    std::optional<Binding> times{};          ///< of a loop
    std::optional<std::uint32_t> at_most{};  ///< rounds of a loop; one more is a failure
    std::optional<Retry> retry{};
    std::optional<std::chrono::nanoseconds> timeout{};  ///< of each attempt
};

/// A skill that the steps use, and how it is found.
struct Use {
    std::uint32_t line = 0;
    std::string alias{};
    std::string type{};               ///< BrowseName of its type, as "GraspGripperSkillType"
    std::string server{};             ///< name of its server; empty: any
    std::string controller{};         ///< name of its controller; empty: any
    std::optional<double> reach{};    ///< least reach of the arm that it moves [m]
    std::optional<double> payload{};  ///< least mass that the arm may carry [kg]
    /// Whether it may be reset although it was not halted by the composed skill.
    bool reset = false;
};

/// A parameter or result of the composed skill.
struct Declaration {
    std::uint32_t line = 0;
    skill::Field field{};
    Binding from{};  ///< of a result
};

struct Definition {
    std::string file{};  ///< as it was opened
    std::string name{};
    std::string type{};
    std::string description{};
    std::vector<Declaration> parameters{};
    std::vector<Declaration> results{};
    std::vector<Use> uses{};
    Step root{};  ///< a sequence without name
    /// How long the used skills may take to come to rest.
    std::chrono::nanoseconds rest_time{};
    skill::OwnerLossAction on_owner_loss = skill::OwnerLossAction::halt;
};

/// In a reference of a result instead of a step: the execution itself. Its values are
/// kExecutionSteps, the paths of the steps that have finished, in order, and kExecutionDurations,
/// how long each took [s]; of the first kMostReportedSteps.
inline constexpr std::string_view kExecution = "execution";
inline constexpr std::string_view kExecutionSteps = "Steps";
inline constexpr std::string_view kExecutionDurations = "Durations";
inline constexpr std::size_t kMostReportedSteps = 1'000;

/// The longest text of one attempt and step that an execution id has room for.
inline constexpr std::size_t kLongestStepName = 40;

/// Of all calls below a step, itself included, in the order of the file.
template <typename Visit>
void forEachCall(const Step& step, const Visit& visit) {
    if (step.kind == StepKind::call) {
        visit(step);
    }
    for (const auto* steps : {&step.steps, &step.otherwise}) {
        for (const auto& inner : *steps) {
            forEachCall(inner, visit);
        }
    }
}

}  // namespace metier::composition
