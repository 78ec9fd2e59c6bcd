#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "messages.hpp"
#include "metier/base/clock.hpp"
#include "metier/device/gripper.hpp"
#include "observation.hpp"

namespace metier::wsg50_driver {

/// Where commands go to.
class CommandSink {
public:
    virtual ~CommandSink() = default;
    virtual void send(Command command) = 0;
};

enum class MotionKind : std::uint8_t { grasp, release, move, home };

/// A motion of the jaws, with nothing left open.
struct Motion {
    MotionKind kind = MotionKind::move;
    double width = 0.0;  ///< [m]
    double speed = 0.0;  ///< [m/s]
    double force = 0.0;  ///< limit that is set before [N]
    /// Of a grasp: the width of the part is not known; `width` is the least that it may be.
    bool any_width = false;
};

/// One motion, from its first command to its outcome.
///
/// The gripper acknowledges a motion as pending and tells its end in a second reply. Neither is
/// trusted: the outcome is what the updates after the last reply show, once the jaws rest: the
/// gripper tells that a motion was stopped when it begins to brake. A grasp of a part of unknown
/// width that the part blocks is asked for again, with the width where it was blocked.
///
/// Threading: one thread.
class MotionTask {
public:
    struct Timing {
        SteadyTime::duration reply{};   ///< for the first answer to a command
        SteadyTime::duration motion{};  ///< for the last one, and for the standstill after it
        SteadyTime::duration settle{};  ///< at standstill, for the state to agree with the last one
    };

    /// Sends the first command. \param sink must outlive this
    MotionTask(Motion motion, const Timing& timing, SteadyTime now, CommandSink& sink);

    /// Takes a reply that is no update of a value.
    void take(const Reply& reply, const Observation& seen, SteadyTime now);
    /// Asks for a stop; the outcome follows.
    void stop(SteadyTime now);
    /// What became of it, once that is known. To be called after each update and when time passes.
    /// Errors: device_fault, cancelled, timeout.
    std::optional<Result<device::GripperOutcome>> outcome(const Observation& seen, SteadyTime now);
    /// The command whose last reply is still to come, if the motion is given up now.
    std::optional<CommandId> owed() const noexcept;

    MotionKind kind() const noexcept { return motion_.kind; }

private:
    enum class Phase : std::uint8_t { force_limit, asked, pending, settling, refused };
    using Outcome = Result<device::GripperOutcome>;

    void begin(SteadyTime now);
    void takeForceLimit(Status status, SteadyTime now);
    void settle(Status last, const Observation& seen, SteadyTime now);
    void refuse(std::string why);
    bool graspsAnew(const Observation& seen, SteadyTime now);
    std::optional<Outcome> late(const Observation& seen, SteadyTime now);
    Outcome stopped() const;
    bool asWanted(const Observation& seen) const;
    Outcome judge(const Observation& seen) const;
    Outcome judgeFailure(const Observation& seen) const;
    Outcome judgeMismatch(const Observation& seen) const;

    Motion motion_;
    Timing timing_;
    CommandSink& sink_;
    Phase phase_ = Phase::force_limit;
    SteadyTime deadline_;
    SteadyTime rest_by_;  // once it settles
    bool stopping_ = false;
    bool timed_out_ = false;
    Status last_ = Status::success;
    Observation::Mark mark_{};
    std::string refusal_;
};

}  // namespace metier::wsg50_driver
