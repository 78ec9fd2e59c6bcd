#pragma once

#include <memory>
#include <string>

#include "metier/motion/motion_run.hpp"
#include "metier/robot_skills/move_parameters.hpp"
#include "moves/motion_run_source.hpp"
#include "moves/move_skills.hpp"
#include "moves/path_deviation.hpp"
#include "moves/settling.hpp"
#include "moves/timetable.hpp"

namespace metier::robot_skills {

/// Watches for a contact that ends a motion before its target, and reports how the motion ended.
class ContactWatch {
public:
    virtual ~ContactWatch() = default;
    /// Whether the motion must end now. Cycle thread, each cycle: must not allocate, lock or throw.
    virtual bool mustEnd(const device::ArmState& state) noexcept = 0;
    /// The arm stands, at its target or where it came to rest after mustEnd(). Notifying thread.
    virtual void tell(const skill::ExecutionHandle& tell, const MoveResults& results) = 0;
};

/// A move whose set-points the arm's cycle thread takes from metier's plan.
struct StreamedMove {
    motion::Trajectory trajectory;
    PathDeviationMeter::Path path;
    const MoveParameters& parameters;
    std::unique_ptr<ContactWatch> contact{};  ///< nullptr: none is watched for
};

/// The execution of that move; nothing moves yet.
std::unique_ptr<skill::ExecutionWork> makeStreamedWork(const MovedArm& arm, StreamedMove move);

/// Gives an arm the set-points of one planned motion, from rest to rest.
class MoveSource final : public MotionRunSource {
public:
    MoveSource(const MovedArm& arm, StreamedMove move);

    Next next(const device::ArmState& state, device::JointArray& set_point) noexcept override;
    device::JointArray restingPlace() const noexcept override;

private:
    enum class Outcome : std::uint8_t { none, finished, at_rest, in_contact, off_target, missed };

    void goOnFrom(const device::JointArray& from) override;
    void released() noexcept override;
    void tellDone(const skill::ExecutionHandle& tell) override;

    void obey() noexcept;
    void watchContact(const device::ArmState& state) noexcept;
    void measure(const device::ArmState& state) noexcept;
    Next settle(const device::ArmState& state) noexcept;
    device::JointArray wayBack() const noexcept;
    MoveResults results() const;

    const std::string arm_;
    const double cycle_;      ///< [s]
    const double stop_time_;  ///< duration of a Suspend [s]; 0: as short as the limits allow
    motion::MotionRun execution_;
    const std::shared_ptr<StoppingReport> stopping_;  // shared with those who publish it
    Timetable timetable_;
    PathDeviationMeter deviation_;
    Settling settling_;
    std::unique_ptr<ContactWatch> contact_;
    bool in_contact_ = false;
    device::JointArray offset_;  ///< distance from the path when the motion went on after a rest
    double way_back_ = 0.0;      ///< time since then [s]
    double in_motion_ = 0.0;     ///< [s]
    bool stop_asked_ = false;
    device::JointArray reached_;
    Outcome outcome_ = Outcome::none;
};

}  // namespace metier::robot_skills
