#pragma once

#include <atomic>
#include <functional>
#include <memory>

#include "metier/device/gripper.hpp"
#include "metier/skill/skill.hpp"

namespace metier::robot_skills {

/// An execution that moves the jaws of a gripper once; again after each rest.
class GripperWork : public skill::ExecutionWork {
public:
    /// Asks the gripper for the motion.
    using Ask = std::function<Result<void>(device::Gripper&, device::Gripper::Done)>;
    /// The result for the client. Errors: the outcome is not what was asked for.
    using Judge = std::function<Result<skill::ValueMap>(const device::GripperOutcome&)>;

    /// Whether a motion is under way; shared with the gripper, which may end it after the work.
    using Moving = std::shared_ptr<std::atomic<bool>>;

    /// \param gripper must outlive the work
    GripperWork(device::Gripper& gripper, Ask ask, Judge judge, Moving moving);
    /// Stops the jaws if they still move.
    ~GripperWork() override;
    GripperWork(const GripperWork&) = delete;
    GripperWork& operator=(const GripperWork&) = delete;

    void start(skill::ExecutionHandle execution) override;
    Result<void> suspend() override;
    Result<void> resume() override;
    void halt() override;
    void forceStop() noexcept override;

private:
    /// Data for reporting a motion's end, which may come after the work is destroyed.
    struct Telling {
        skill::ExecutionHandle execution;
        Judge judge;
        Moving moving;
    };

    static void tell(const Telling& telling, const Result<device::GripperOutcome>& outcome);
    Result<void> move();
    void watchSafety();

    device::Gripper& gripper_;
    Ask ask_;
    std::shared_ptr<Telling> telling_;  // shared with the gripper while it moves
    device::Registration safety_watch_;
};

}  // namespace metier::robot_skills
