#pragma once

#include <optional>

#include "metier/device/arm.hpp"
#include "metier/device/shared_value.hpp"
#include "metier/motion/motion_run.hpp"
#include "metier/motion/robot_model.hpp"

namespace metier::robot_skills {

/// Stop of an arm on its path, if it were halted now: time [s] and way of the set-points. The
/// measured arm follows them by the lag of its controller.
///
/// Threading: read() on any thread; the others on the thread that has the motion, which is the
/// cycle thread while it runs. Nothing locks or allocates.
class StoppingReport {
public:
    /// Stop of the move that runs now; nothing if none does.
    std::optional<motion::StoppingEstimate> read() const noexcept {
        const auto now = newest_.read();
        return now.known ? std::optional(now.way) : std::nullopt;
    }
    /// Shows the stop that a Halt would need now.
    void note(const motion::StoppingEstimate& way) noexcept { newest_.write({true, way}); }
    /// Shows that no move runs.
    void clear() noexcept { newest_.write({}); }

private:
    /// Whether a move runs, and its stop.
    struct Newest {
        bool known = false;
        motion::StoppingEstimate way{};
    };
    device::SharedValue<Newest> newest_;
};

/// Stop of an arm whose set-points metier does not plan, computed from its measured velocity: each
/// axis brakes with its own limits. The way is that of the flange.
/// Zero, too, if the state has another number of axes than the model.
/// \param acceleration of each axis, which ends first [rad/s2]; empty: none
/// \return zero for an arm at rest that is not about to move
/// Threads: any, also a cycle thread; pure.
motion::StoppingEstimate stoppingEstimateOf(const device::ArmState& state,
                                            const motion::RobotModel& model,
                                            const device::JointArray& acceleration = {});

}  // namespace metier::robot_skills
