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
/// A whole number may stand where a Double is needed; a list of six numbers may be a frame [m,
/// rad], one of three a vector.
using Literal = std::variant<bool, std::int64_t, double, std::string, std::vector<double>,
                             std::vector<std::string>, std::vector<std::vector<double>>>;

/// Reference to a parameter of the composed skill, or to a result of an earlier step.
struct Reference {
    /// Name of the step whose result it is; empty: a parameter of the composed skill.
    std::string step{};
    /// Name of the parameter or result.
    std::string name{};
    /// Index of one number of it, counted from 0; a frame has x, y, z, a, b, c in this order.
    std::optional<std::size_t> element{};
};

/// One number of a list.
/// Its value is `constant`, or the number behind `from` times `factor`.
struct Term {
    /// The number, if there is no reference, in the unit of its target.
    double constant = 0.0;
    /// Reference that is used instead of the constant.
    std::optional<Reference> from{};
    /// Factor of the referenced value.
    double factor = 1.0;
};

/// Axes along which a frame is shifted: those of the frame in which it is given, or its own.
enum class ShiftAxes { base, own };

/// Checked against its target by compose(); `line` and `key` are for its messages.
/// Source of a value.
struct Binding {
    /// Line in the file.
    std::uint32_t line = 0;
    /// Place in the file: "step[1].with.Force".
    std::string key{};
    /// A constant, a reference, or a list of numbers that may each be a reference.
    std::variant<Literal, Reference, std::vector<Term>> source{};
    /// Added number by number; to a frame, along the axes of the frame in which it is given [m].
    std::vector<Term> shift{};
    /// Axes along which a frame is shifted.
    ShiftAxes shift_axes = ShiftAxes::base;
    /// The Literal in the type of its target; Null before compose().
    skill::Value constant{};
    /// Whether it is left out if the called skill has no such parameter; of an argument.
    bool optional = false;
};

/// A condition of a choice or a loop.
struct Condition {
    /// Three comparisons of `subject` with `operand`, and three ways to count `parts`.
    enum class Kind { is, less, greater, all, any, negation };
    /// Comparison, or the way in which `parts` count together.
    Kind kind = Kind::is;
    /// Place in the file.
    std::uint32_t line = 0;
    /// Key in the file, for messages.
    std::string key{};
    /// Compared value; for is, less, greater.
    Reference subject{};
    /// Value with which it is compared; for is, less, greater.
    Binding operand{};
    /// Inner conditions; for all, any, negation (one).
    std::vector<Condition> parts{};
};

/// A parameter of the called skill, with its value.
struct Argument {
    /// BrowseName of the parameter.
    std::string name{};
    /// Its value.
    Binding value{};
};

/// Further attempts after a failed one.
/// The first attempt does not count: at most `times` + 1 attempts are made.
struct Retry {
    /// Number of further attempts, 1 to 1000.
    std::uint32_t times = 1;
    /// Pause before each further attempt.
    std::chrono::nanoseconds pause{0};
};

/// Kind of a step, by the key that it has in the file.
enum class StepKind {
    /// Runs a used skill.
    call,
    /// Runs one step after the other; the first failure fails it.
    sequence,
    /// Runs all steps at the same time.
    parallel,
    /// Runs one step after the other until one succeeds.
    fallback,
    /// Runs `steps` if the condition holds, else `otherwise`.
    choice,
    /// Runs its steps in rounds.
    loop,
    /// Fails with the text that the file gives.
    failure,
};

/// Number of parallel steps that must succeed.
enum class WaitFor {
    /// One failure fails the whole and halts the others.
    all,
    /// One success ends the whole with success and halts the others.
    any,
};

/// A step of a composition, with the steps below it.
/// Members that the kind does not use keep their defaults.
struct Step {
    /// Line in the file.
    std::uint32_t line = 0;
    /// Place in the file: "step[1].parallel[0]".
    std::string key{};
    /// Name for references and reports; at most kLongestStepName bytes; empty: it has none.
    std::string name{};
    /// Kind, which decides the members that count.
    StepKind kind = StepKind::call;
    /// Alias of the called skill; of a call.
    std::string use{};
    /// Parameters of the called skill; of a call.
    std::vector<Argument> arguments{};
    /// Text for a person; of a failure.
    std::string text{};
    /// Inner steps; of all others.
    std::vector<Step> steps{};
    /// Steps if the condition does not hold; of a choice.
    std::vector<Step> otherwise{};
    /// Number of steps that must succeed; of a parallel.
    WaitFor wait_for = WaitFor::all;
    /// Whether a step within a parallel that waits for all is halted once all other steps have
    /// ended; its failure fails the parallel.
    bool background = false;
    /// Condition of a choice; of a loop, it must hold before each round.
    std::optional<Condition> condition{};
    /// Condition that ends a loop after a round.
    std::optional<Condition> until{};
    /// Number of rounds of a loop.
    std::optional<Binding> times{};
    /// Largest number of rounds of a loop, 1 to 1,000,000; one more is a failure.
    std::optional<std::uint32_t> at_most{};
    /// Further attempts if the step fails; none: one attempt.
    std::optional<Retry> retry{};
    /// Longest time of each attempt, up to 7 days; then the step is halted and has failed. None: no
    /// limit.
    std::optional<std::chrono::nanoseconds> timeout{};
};

/// A skill that the steps use, and the conditions for finding it.
struct Use {
    /// Line in the file.
    std::uint32_t line = 0;
    /// Name that the steps use.
    std::string alias{};
    /// BrowseName of its type: "GraspGripperSkillType".
    std::string type{};
    /// Name of its server; empty: any.
    std::string server{};
    /// Name of its controller; empty: any.
    std::string controller{};
    /// Least reach of the arm that it moves [m]; none: any.
    std::optional<double> reach{};
    /// Least mass that the arm may carry [kg]; none: any.
    std::optional<double> payload{};
    /// Whether the skill may be reset even if the composed skill did not halt it.
    bool reset = false;
    /// Whether its steps are left out if nothing serves it.
    bool optional = false;
    /// Name of a force of the component that ends it, too (limitForce()); empty: none.
    std::string force{};
};

/// A parameter or result of the composed skill.
struct Declaration {
    /// Line in the file.
    std::uint32_t line = 0;
    /// Name, type, unit and range.
    skill::Field field{};
    /// Source of the value; only of a result. A constant, after compose(), for an optional result
    /// that the used skill does not give.
    Binding from{};
};

/// Content of a composition file: the composed skill, the used skills, the steps.
struct Definition {
    /// Name under which it was opened, for messages.
    std::string file{};
    /// Text of the file, comments included.
    std::string text{};
    /// BrowseNames of the composed skill and of its type, at most 80 bytes.
    std::string name{};
    /// BrowseName of the type of the composed skill, at most 80 bytes.
    std::string type{};
    /// Namespace of the type, if no model has it: "urn:metier:composition:TYPE" unless the file
    /// says otherwise.
    std::string type_namespace{};
    /// BrowseName of the type above it.
    std::string base = "SequenceSkillType";
    /// Tasks of the skill: terms of metier's dictionary, such as "grasp", or URIs; of its type.
    std::vector<std::string> terms{};
    /// One line for a person.
    std::string description{};
    /// Values that a client may give.
    std::vector<Declaration> parameters{};
    /// Values that an execution leaves.
    std::vector<Declaration> results{};
    /// Skills that the steps run.
    std::vector<Use> uses{};
    /// All steps: a sequence without name.
    Step root{};
    /// Longest time that the used skills may take to come to rest, over 0, up to an hour; 6 s
    /// unless the file says otherwise.
    std::chrono::nanoseconds rest_time{};
    /// Action when the owner of an execution is lost.
    skill::OwnerLossAction on_owner_loss = skill::OwnerLossAction::halt;
};

/// Name that a reference of a result may use instead of a step: the execution itself. Its values
/// are kExecutionSteps, the paths of the finished steps in order, and kExecutionDurations, the time
/// that each took [s]; of the first kMostReportedSteps.
inline constexpr std::string_view kExecution = "execution";
/// Name of the paths of the finished steps.
inline constexpr std::string_view kExecutionSteps = "Steps";
/// Name of the times of these steps [s].
inline constexpr std::string_view kExecutionDurations = "Durations";
/// Largest number of steps in these lists; later ones are left out.
inline constexpr std::size_t kMostReportedSteps = 1'000;

/// Longest text of attempt and step for which an execution id has room.
inline constexpr std::size_t kLongestStepName = 40;

/// Calls visit(step) for all calls below a step, itself included, in the order of the file.
/// Threads: any.
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
