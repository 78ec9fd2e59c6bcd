#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "messages.hpp"
#include "metier/base/clock.hpp"
#include "metier/device/gripper.hpp"
#include "observation.hpp"

namespace metier::wsg50_driver {

/// Receiver of commands.
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
    /// Set for a grasp of a part of unknown width; `width` is then its smallest possible width.
    bool any_width = false;
};

/// One motion, from its first command to its outcome.
///
/// The gripper acknowledges a motion as pending and reports its end in a second reply. Neither is
/// trusted, since the gripper reports a stopped motion already when it begins to brake: the outcome
/// is read from the updates after the last reply, once the jaws rest. A grasp of a part of unknown
/// width that was blocked by the part is repeated with the width at which it was blocked.
///
/// Threading: one thread.
class MotionTask {
public:
    struct Timing {
        SteadyTime::duration reply{};   ///< longest time until the first answer to a command
        SteadyTime::duration motion{};  ///< longest time until the last answer, and until
                                        ///< standstill after it
        SteadyTime::duration settle{};  ///< longest time at standstill until the state agrees with
                                        ///< the last answer
    };

    /// Sends the first command. \param sink must outlive this
    MotionTask(Motion motion, const Timing& timing, SteadyTime now, CommandSink& sink);

    /// Takes a reply that is no update of a value.
    void take(const Reply& reply, const Observation& seen, SteadyTime now);
    /// Asks for a stop; the outcome follows.
    void stop(SteadyTime now);
    /// Outcome of the motion, once it is known. Call it after each update and when time passes.
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
