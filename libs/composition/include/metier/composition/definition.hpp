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

// Content of a composition file (docs/guide/compose.md). Lines count from 1 and are for messages.

/// A constant as written in the file; its type follows from its target.
using Literal = std::variant<bool, std::int64_t, double, std::string, std::vector<double>,
                             std::vector<std::string>, std::vector<std::vector<double>>>;

/// Reference to a parameter of the composed skill, or to a result of an earlier step.
struct Reference {
    std::string step{};  ///< empty: a parameter
    std::string name{};
    /// Index of one number of it, counted from 0; a frame has x, y, z, a, b, c in this order.
    std::optional<std::size_t> element{};
};

/// One number of a list.
struct Term {
    double constant = 0.0;            ///< the number, if there is no reference
    std::optional<Reference> from{};  ///< used instead of the constant
    double factor = 1.0;              ///< multiplies the referenced value
};

/// Axes along which a frame is shifted.
enum class ShiftAxes { base, own };

/// Source of a value.
struct Binding {
    std::uint32_t line = 0;
    std::string key{};  ///< its place in the file: "step[1].with.Force"
    std::variant<Literal, Reference, std::vector<Term>> source{};
    /// Added number by number; to a frame, along the axes of the frame in which it is given [m].
    std::vector<Term> shift{};
    ShiftAxes shift_axes = ShiftAxes::base;  ///< own: along the axes of the shifted frame itself
    /// The Literal in the type of its target; Null before compose().
    skill::Value constant{};
};

/// A condition of a choice or a loop.
struct Condition {
    enum class Kind { is, less, greater, all, any, negation };
    Kind kind = Kind::is;
    std::uint32_t line = 0;
    std::string key{};
    Reference subject{};             ///< for is, less, greater
    Binding operand{};               ///< for is, less, greater
    std::vector<Condition> parts{};  ///< for all, any, negation
};

/// A parameter of the called skill, with its value.
struct Argument {
    std::string name{};
    Binding value{};
};

/// Further attempts after a failed one.
struct Retry {
    std::uint32_t times = 1;            ///< number of further attempts
    std::chrono::nanoseconds pause{0};  ///< before each further attempt
};

/// Kind of a step, by the key that it has in the file.
enum class StepKind {
    call,
    sequence,
    parallel,  ///< runs all steps at the same time
    fallback,  ///< runs one step after the other until one succeeds
    choice,    ///< `steps` if the condition holds, else `otherwise`
    loop,
    failure,  ///< fails with the text that the file gives
};

/// Number of parallel steps that must succeed.
enum class WaitFor {
    all,  ///< one failure fails the whole and halts the others
    any,  ///< one success ends the whole with success and halts the others
};

/// A step of a composition, with the steps below it.
struct Step {
    std::uint32_t line = 0;
    std::string key{};  ///< its place in the file: "step[1].parallel[0]"
    std::string name{};
    StepKind kind = StepKind::call;
    std::string use{};                  ///< alias of the called skill; of a call
    std::vector<Argument> arguments{};  ///< of a call
    std::string text{};                 ///< of a failure
    std::vector<Step> steps{};          ///< of all others
    std::vector<Step> otherwise{};      ///< of a choice
    WaitFor wait_for = WaitFor::all;    ///< of a parallel
    /// For a step within a parallel: it is halted once all other steps have ended, and its failure
    /// fails the parallel.
    /// end.
    bool background = false;
    std::optional<Condition> condition{};  ///< of a choice; of a loop, holds before each round
    std::optional<Condition> until{};      ///< of a loop, ends it after a round
    std::optional<Binding> times{};        ///< of a loop
    /// Largest number of rounds of a loop; one more is a failure
    std::optional<std::uint32_t> at_most{};
    std::optional<Retry> retry{};
    std::optional<std::chrono::nanoseconds> timeout{};  ///< for each attempt
};

/// A skill that the steps use, and the conditions for finding it.
struct Use {
    std::uint32_t line = 0;
    std::string alias{};              ///< name that the steps use
    std::string type{};               ///< BrowseName of its type, as "GraspGripperSkillType"
    std::string server{};             ///< name of its server; empty: any
    std::string controller{};         ///< name of its controller; empty: any
    std::optional<double> reach{};    ///< least reach of the arm that it moves [m]
    std::optional<double> payload{};  ///< least mass that the arm may carry [kg]
    /// Whether the skill may be reset even if the composed skill did not halt it.
    bool reset = false;
};

/// A parameter or result of the composed skill.
struct Declaration {
    std::uint32_t line = 0;
    skill::Field field{};
    Binding from{};  ///< only of a result
};

/// Content of a composition file: the composed skill, the used skills, the steps.
struct Definition {
    std::string file{};  ///< name under which it was opened
    std::string name{};
    std::string type{};
    std::string description{};
    std::vector<Declaration> parameters{};
    std::vector<Declaration> results{};
    std::vector<Use> uses{};
    Step root{};  ///< a sequence without name
    /// Longest time that the used skills may take to come to rest.
    std::chrono::nanoseconds rest_time{};
    skill::OwnerLossAction on_owner_loss = skill::OwnerLossAction::halt;
};

/// Name that a reference of a result may use instead of a step: the execution itself. Its values
/// are kExecutionSteps, the paths of the finished steps in order, and kExecutionDurations, the time
/// that each took [s]; of the first kMostReportedSteps.
inline constexpr std::string_view kExecution = "execution";
inline constexpr std::string_view kExecutionSteps = "Steps";
inline constexpr std::string_view kExecutionDurations = "Durations";
inline constexpr std::size_t kMostReportedSteps = 1'000;

/// Longest text of attempt and step for which an execution id has room.
inline constexpr std::size_t kLongestStepName = 40;

/// Calls visit(step) for all calls below a step, itself included, in the order of the file.
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
