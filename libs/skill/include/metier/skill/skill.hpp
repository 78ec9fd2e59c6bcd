#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/skill/execution_handle.hpp"
#include "metier/skill/field.hpp"
#include "metier/skill/state.hpp"
#include "metier/skill/value.hpp"

namespace metier::skill {

/// Facts that clients may know of a skill before they use it. Does not change.
struct SkillDescription {
    /// BrowseName of the instance, unique among the skills of a controller:
    /// "CartesianPtpMoveSkill".
    std::string name{};
    /// BrowseName of its type: "CartesianPtpMoveSkillType".
    std::string type{};
    /// One line for a person.
    std::string description{};
    /// Values that a client may give; a value that a skill needs has no default and is not
    /// optional.
    Fields parameters{};
    /// Values of a finished execution; one that the work leaves out is Null.
    Fields results{};
    /// Names of a sequence's steps, in order; empty: it has none.
    std::vector<std::string> steps{};
    /// Whether the work can be suspended; false: Suspend is refused with not_supported.
    bool suspendable = true;
    /// Action when the owner of an execution is gone, unless the Start or the lease says otherwise.
    /// Skills that move an arm halt.
    OwnerLossAction on_owner_loss = OwnerLossAction::keep_going;
};

/// Joint positions of arms [rad], axis 1 first. The key is the address of the arm's server; empty:
/// the arm of the skill's own server. An arm without values stands at an unknown place;
/// kEveryOtherArm is the key of all arms that are not named.
using ArmPositions = std::map<std::string, std::vector<double>, std::less<>>;
/// Key of ArmPositions that stands for all arms that are not named.
inline constexpr std::string_view kEveryOtherArm = "*";

/// Question of Check.
struct CheckRequest {
    /// Parameters by name; those not named take their defaults.
    ValueMap parameters{};
    /// Places where arms stand when the skill begins; an arm that is not named stands where it is.
    ArmPositions starts{};

    /// Whether both ask the same.
    bool operator==(const CheckRequest&) const = default;
};

/// Answer of Check: whether Start would succeed, and the motion that it would make.
struct CheckReport {
    /// Whether Start would succeed now.
    bool possible = true;
    /// Reason why it is not possible, with value, limit and unit; empty if it is.
    std::string reason{};
    /// Kind of the reason: the name of an Errc, such as "unreachable". Empty if it is possible, or
    /// if the server does not report it.
    std::string code{};
    /// Fraction of the path up to the first place that fails, 0 to 1; 1 if nothing fails, 0 if the
    /// values themselves are refused.
    double first_failing_fraction = 1.0;
    /// Duration of the motion [s]; 0 if the skill does not know it.
    double planned_duration = 0.0;
    /// Longest time until the set-points stand that a Halt could need at any time of the motion
    /// [s]; 0 if the skill does not know it.
    double stopping_time = 0.0;
    /// Longest way of the tool frame during such a stop [m]; 0 if the skill does not know it.
    double stopping_distance = 0.0;
    /// Joint positions along the path, one row per sample, axis 1 first [rad]; empty if the skill
    /// moves no arm.
    std::vector<std::vector<double>> joint_path{};
    /// Places where the arms that it moves stand at the end; empty if it moves none.
    ArmPositions ends{};
    /// Whether `ends` names all arms that it moves. If not, they may be anywhere at its end.
    bool ends_known = false;
    /// Parts of the execution that could not be checked, each with the reason, for a person.
    std::vector<std::string> notes{};
};

/// Receiver of the answer of Check. Errors: timeout: the answer is not known, ask again; any other:
/// Start would be refused with it.
using CheckDone = std::function<void(Result<CheckReport>)>;

/// A value of an Input::live parameter that was written while the skill runs.
struct LiveValue {
    /// Value in the unit of its field; never Null for a field that has a default.
    Value value;
    /// Time for which it is meant, by the writer's clock (SourceTimestamp); none if it was not
    /// sent.
    std::optional<UtcTime> meant_for{};
};

/// One execution of a skill, made by Skill::prepare().
///
/// The Program destroys it once the execution has ended. The destructor releases the device, which
/// then stands still (or was stopped by forceStop()), and waits for the work's own threads.
/// Threading: all calls come from the owner's thread and must not block; no call comes from inside
/// another.
class ExecutionWork {
public:
    virtual ~ExecutionWork() = default;
    /// Begins the work; Running has been committed before. The outcome is reported through
    /// `execution`, which may also be used inside this call. An exception ends the execution as
    /// Halted, error, after forceStop().
    virtual void start(ExecutionHandle execution) = 0;
    /// Asks to come to rest on the path; answered by ExecutionHandle::atRest(), finish() or fail()
    /// within ProgramOptions::rest_deadline. Never called if the description is not suspendable.
    /// Errors: reported to the client; then nothing is stopped, and the work goes on.
    virtual Result<void> suspend() = 0;
    /// Goes on from rest, on the same path. It must move again once this returns without an error.
    /// Errors: nothing moves then, and the Program stays Suspended. If the arm was moved meanwhile,
    ///         the text names the distance.
    virtual Result<void> resume() = 0;
    /// Brakes; answered by ExecutionHandle::atRest(), finish() or fail() within
    /// ProgramOptions::rest_deadline. May follow suspend() before its answer: then one answer is
    /// enough. Also called when a suspended execution is given up: then no answer is needed, and
    /// the work is destroyed next.
    virtual void halt() = 0;
    /// Uses the device's own stop: the deadline to come to rest has passed, the device was lost, or
    /// the Program is destroyed while it runs.
    virtual void forceStop() noexcept = 0;
    /// Takes a live parameter that a client wrote while this runs; its field's checks have passed.
    /// \param parameter name of the field; valid during the call, as is `live`
    /// Errors: reported to the client; the old value stays. The default takes none: not_supported.
    virtual Result<void> input(std::string_view parameter, const LiveValue& live) {
        static_cast<void>(live);
        return fail(Errc::not_supported, std::string(parameter) + " is not taken while Running");
    }
    /// Notes that a live value was refused, by a check of its field or by input(). The client got
    /// the error.
    virtual void inputRefused(std::string_view parameter, const Error& why) {
        static_cast<void>(parameter);
        static_cast<void>(why);
    }
};

/// A skill: its description, and the way to begin an execution. Owned by its Program. Derive from
/// TypedSkill for parameters in a struct, or use LambdaSkill for a skill made of functions.
///
/// Threading: all calls come from the owner's thread and must not block. An exception counts as an
/// error of code internal.
class Skill {
public:
    virtual ~Skill() = default;
    /// Returns the same description for as long as the skill lives.
    virtual const SkillDescription& description() const = 0;
    /// Makes all checks of Start, planning included; nothing moves.
    /// \param snapshot a value for every parameter, each checked; Null only for optional ones.
    ///                 Valid during the call.
    /// \return work that has not begun; never null. It may be destroyed without having been
    /// started.
    /// Errors: Start is refused with this error, and nothing has changed.
    virtual Result<std::unique_ptr<ExecutionWork>> prepare(const ValueMap& snapshot) = 0;
    /// Makes the checks of prepare() for `snapshot`, without any effect. The default prepares work
    /// and drops it; override it to describe the motion.
    /// Errors: reported to the client as: not possible, with the error's text.
    virtual Result<CheckReport> check(const ValueMap& snapshot) {
        METIER_TRY(prepare(snapshot));
        return CheckReport{};
    }
    /// As check(), for a time at which arms may stand elsewhere; also for a skill that must ask
    /// others first. The default calls check(), whatever `starts` says.
    /// \param starts places of arms when the skill begins; valid during the call, as is `snapshot`
    /// \param done   called once, in this call or later on the owner's thread; never after the end
    ///               of the skill. An answer after the first one has no effect
    virtual void checkFrom(const ArmPositions& starts, const ValueMap& snapshot, CheckDone done) {
        static_cast<void>(starts);
        done(check(snapshot));
    }
    /// Clears a fault, if the device agrees that it is gone. Does not wait for the device.
    /// Errors: timeout: the device has begun and is not done; the next call gives its outcome. Any
    /// other error: the Program stays Halted and shows it.
    virtual Result<void> reset() { return {}; }
};

}  // namespace metier::skill
