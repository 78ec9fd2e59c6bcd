#pragma once

#include "execution_source.hpp"
#include "metier/motion/execution.hpp"
#include "metier/robot_skills/move_parameters.hpp"
#include "path_deviation.hpp"
#include "settling.hpp"

namespace metier::robot_skills {

/// Gives an arm the set-points of one planned motion, from rest to rest.
class MoveSource final : public ExecutionSource {
public:
    MoveSource(const device::ArmInfo& info, const motion::Trajectory& trajectory,
               PathDeviationMeter::Path path);

    Next next(const device::ArmState& state, device::JointArray& set_point) noexcept override;
    device::JointArray restingPlace() const noexcept override;

private:
    enum class Outcome : std::uint8_t { none, finished, at_rest, off_target };

    void goOnFrom(const device::JointArray& from) override;
    void tellDone(const skill::Execution& tell) override;

    void obey() noexcept;
    void measure(const device::ArmState& state) noexcept;
    Next settle(const device::ArmState& state) noexcept;
    device::JointArray wayBack() const noexcept;
    MoveResults results() const;

    const double cycle_;  ///< [s]
    motion::MotionExecution execution_;
    PathDeviationMeter deviation_;
    Settling settling_;
    device::JointArray offset_;  ///< from the path when the motion went on after a rest
    double way_back_ = 0.0;      ///< time since then [s]
    double in_motion_ = 0.0;     ///< [s]
    bool stop_asked_ = false;
    device::JointArray reached_;
    Outcome outcome_ = Outcome::none;
};

}  // namespace metier::robot_skills
