#pragma once

#include <memory>

#include "moves/arm_work.hpp"
#include "moves/motion_run_source.hpp"

namespace metier::robot_skills {

/// An execution that moves an arm by a source of set-points.
class SourceWork : public ArmWork {
public:
    /// \param arm must outlive the work
    SourceWork(device::Arm& arm, std::shared_ptr<MotionRunSource> source, ToolPose tool_pose);
    /// Brakes on the path if it still moves; the arm keeps what it needs for that.
    ~SourceWork() override;
    SourceWork(const SourceWork&) = delete;
    SourceWork& operator=(const SourceWork&) = delete;

    void start(skill::ExecutionHandle execution) override;
    Result<void> suspend() override;
    Result<void> resume() override;
    void halt() override;
    void forceStop() noexcept override;

private:
    std::shared_ptr<MotionRunSource> source_;  // shared with the arm while it moves
};

}  // namespace metier::robot_skills
