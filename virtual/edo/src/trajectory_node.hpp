#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "codes.hpp"
#include "joint_bus.hpp"
#include "move_planner.hpp"
#include "movement.hpp"
#include "software.hpp"

namespace metier::virtual_edo {

/// The robot's trajectory node: runs moves and jogs, watches for collisions, and lets a client take
/// control of the joints.
///
/// Time passes by step(), one cycle of 10 ms each.
///
/// Threading: one thread.
/// Source: Comau/eDO_core, src/AlgorithmManager.cpp (releases 2.4.0 to 3.2.0).
class TrajectoryNode {
public:
    using Answer = std::function<void(Feedback)>;

    /// \param model outlives the node
    TrajectoryNode(const Software& software, const motion::RobotModel& model, Answer answer);

    /// Chooses the configuration for so many axes, once. \return for how many it is configured, 0:
    /// none
    std::size_t load(std::size_t axes);
    std::size_t axes() const { return axes_; }

    void move(const Movement& movement);
    void jog(const Movement& movement);
    /// /algo_control_switch_srv. \return 0 done, 1 refused
    std::uint8_t switchControl(std::uint8_t mode);
    /// /external_control: set-points and feed-forward velocities of every axis.
    void externalControl(const AxisValues& position, const AxisValues& velocity);

    void onJointState(const BusReport& report);
    /// The measured pose is the new zero of some axes: what it holds moves along.
    void rebase(const BusReport& report);
    void onBraked();
    void onReset();
    /// Something presses on the arm: whether it is noticed as a collision is the node's affair.
    void setContact(bool contact) { contact_ = contact; }
    bool watchesCollisions() const;
    bool collision() const { return contact_ && watchesCollisions(); }

    /// One cycle.
    void step();

    AlgorithmMode mode() const { return mode_; }
    bool isSwitchedOff() const { return mode_ >= AlgorithmMode::switched_off; }
    /// Reports whether a motion runs or waits.
    bool isBusy() const;
    /// Reports whether it publishes targets and its mode; older software is silent while switched
    /// off.
    bool publishes() const { return software_.external_control || !isSwitchedOff(); }
    bool publishesPose() const {
        return mode_ != AlgorithmMode::uninitialised && !isSwitchedOff() && !alarm_;
    }
    /// Target of each configured axis.
    const AxisValues& target() const { return target_; }
    const AxisValues& velocity() const { return velocity_; }
    /// Pose of the measured joints, in the last move's frames.
    CartesianPose pose() const { return planner_.cartesian(measured_); }
    const MovePlanner& planner() const { return planner_; }

private:
    struct Running {
        Segment segment;
        std::uint8_t delay = 0;
        double start = 0.0;  // start on the motion's own time [s]
    };

    void takeCommands();
    bool takeMove();
    void pauseMove();
    void resumeMove();
    void cancelMove();
    void takeJogs();
    void startJog(const Movement& movement);
    void append(Segment segment, std::uint8_t delay);
    void advance();
    void dropFinished();
    void finishLast(std::uint8_t delay);
    void onStopped();
    AxisValues position() const;
    void holdMeasured();
    void clearMotion();
    void dropAll(FeedbackData data);
    void fail(FeedbackData data);
    void say(FeedbackType type, FeedbackData data) { answer_({type, data}); }
    void takeControl(AlgorithmMode mode);
    void giveControlBack();

    Software software_;
    MovePlanner planner_;
    Answer answer_;
    AlgorithmMode mode_ = AlgorithmMode::uninitialised;
    std::size_t axes_ = 0;
    std::deque<Movement> commands_;  // pause, resume and cancel overtake moves
    std::deque<Movement> moves_;
    std::deque<Movement> jogs_;

    std::deque<Running> running_;
    double time_ = 0.0;  // the motion's own time; passes more slowly while it stops [s]
    double rate_ = 1.0;
    bool stopping_ = false;
    bool jogging_ = false;
    bool next_asked_ = false;
    int wait_left_ = 0;  // cycles

    AxisValues measured_{};
    AxisValues target_{};
    AxisValues velocity_{};
    bool alarm_ = false;
    bool calibrated_ = false;
    bool contact_ = false;
    int unwatched_left_ = 0;  // cycles
};

}  // namespace metier::virtual_edo
