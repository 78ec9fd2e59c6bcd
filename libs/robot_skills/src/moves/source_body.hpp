#pragma once

#include <memory>

#include "moves/arm_body.hpp"
#include "moves/execution_source.hpp"

namespace metier::robot_skills {

/// An execution that moves an arm by a source of set-points.
class SourceBody : public ArmBody {
public:
    /// \param arm must outlive the body
    SourceBody(device::Arm& arm, std::shared_ptr<ExecutionSource> source,
               ToolDistance tool_distance);
    /// Brakes on the path if it still moves; the arm keeps what it needs for that.
    ~SourceBody() override;
    SourceBody(const SourceBody&) = delete;
    SourceBody& operator=(const SourceBody&) = delete;

    void start(skill::Execution execution) override;
    Result<void> suspend() override;
    Result<void> resume() override;
    void halt() override;
    void forceStop() noexcept override;

private:
    std::shared_ptr<ExecutionSource> source_;  // shared with the arm while it moves
};

}  // namespace metier::robot_skills
