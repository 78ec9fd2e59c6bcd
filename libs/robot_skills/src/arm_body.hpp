#pragma once

#include <functional>
#include <memory>
#include <string>

#include "execution_source.hpp"
#include "metier/skill/skill.hpp"

namespace metier::robot_skills {

/// Most that any axis may have been moved during a rest for Resume to go on [rad].
inline constexpr double kMovedTolerance = 2e-3;

/// An execution that moves an arm by a source of set-points.
class ArmBody : public skill::Body {
public:
    /// How far the tool frame is at one joint position from where it is at another, for texts.
    using ToolDistance =
        std::function<double(const device::JointArray&, const device::JointArray&)>;

    /// \param arm must outlive the body
    ArmBody(device::Arm& arm, std::shared_ptr<ExecutionSource> source, ToolDistance tool_distance);
    /// Brakes on the path if it still moves; the arm keeps what it needs for that.
    ~ArmBody() override;
    ArmBody(const ArmBody&) = delete;
    ArmBody& operator=(const ArmBody&) = delete;

    void start(skill::Execution execution) override;
    Result<void> suspend() override;
    Result<void> resume() override;
    void halt() override;
    void forceStop() noexcept override;

private:
    Result<void> checkNotMoved(const device::JointArray& position) const;
    void watchSafety();

    device::Arm& arm_;
    std::shared_ptr<ExecutionSource> source_;  // shared with the arm while it moves
    ToolDistance tool_distance_;
    skill::Execution execution_;
    device::Registration safety_watch_;
};

}  // namespace metier::robot_skills
