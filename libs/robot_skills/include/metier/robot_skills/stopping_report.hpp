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
/// Threading: read() on any thread; the others on the thread that has the source of the set-points,
/// which is the cycle thread while it is attached. Nothing locks or allocates.
class StoppingReport {
public:
    /// Stop of the motion that metier plans and runs now; nothing if it runs none.
    std::optional<motion::StoppingEstimate> read() const noexcept {
        const auto now = newest_.read();
        return now.known ? std::optional(now.way) : std::nullopt;
    }
    void note(const motion::StoppingEstimate& way) noexcept { newest_.write({true, way}); }
    void clear() noexcept { newest_.write({}); }

private:
    struct Newest {
        bool known = false;
        motion::StoppingEstimate way{};
    };
    device::SharedValue<Newest> newest_;
};

/// Stop of an arm whose motion the controller plans, computed from its measured velocity: each axis
/// brakes with its own limits. The way is that of the flange.
motion::StoppingEstimate stoppingEstimateOf(const device::ArmState& state,
                                            const motion::RobotModel& model);

}  // namespace metier::robot_skills
