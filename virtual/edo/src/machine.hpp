#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>

#include "codes.hpp"
#include "joint_bus.hpp"
#include "movement.hpp"

namespace metier::virtual_edo {

/// Waits until every addressed joint has raised its acknowledgement and dropped it again.
class CommandWait {
public:
    /// \param axes how many axes are awaited, of those in the mask
    void begin(std::uint64_t mask, std::size_t axes);

    /// One cycle's report. \return whether all have acknowledged
    bool take(const BusReport& report);

    /// One cycle. \return whether 10 s are over
    bool expired() { return ++age_ >= kLongestWait; }

private:
    static constexpr int kLongestWait = 1000;  // cycles
    enum class Phase : std::uint8_t { done, low, raised };

    std::array<Phase, kMostAxes> phases_{};
    int age_ = 0;
};

/// Parts of the robot on which the state machine acts.
class MachinePeers {
public:
    virtual ~MachinePeers() = default;

    /// Chooses the configuration of so many axes. \return how many the robot is configured for;
    /// 0: for none, since there is no such configuration
    virtual std::size_t loadConfiguration(std::size_t axes) = 0;
    virtual JointBus& bus() = 0;
    virtual void passMove(const Movement& movement) = 0;
    virtual void passJog(const Movement& movement) = 0;
    virtual bool algorithmBusy() const = 0;
    virtual void publishFeedback(Feedback feedback) = 0;
    virtual void publishBrakesCheck(std::int8_t state, std::uint8_t mask) = 0;
    /// The brakes were engaged, or an error stopped the machine.
    virtual void onBraked() = 0;
};

/// State machine of the robot: decides which commands are allowed in which state, and how they are
/// acknowledged. A command that is not valid in a state is dropped without an answer, as the robot
/// does.
///
/// Time passes by step(), one cycle of 10 ms each.
///
/// Threading: one thread.
/// Source: Comau/eDO_core, src/*State.cpp, StateManager.cpp, CommandState.cpp, TabletCheck.cpp.
class Machine {
public:
    /// \param peers outlives the machine
    explicit Machine(MachinePeers& peers) : peers_(peers) {}

    /// Sets the state as after a successful start-up with this number of axes.
    void makeReady(std::size_t axes);

    void onInit(std::uint8_t mode, std::uint64_t mask);
    void onReset(std::uint64_t mask);
    void onCalibration(std::uint64_t mask);
    void onConfiguration(std::uint64_t mask);
    void onMove(const Movement& movement);
    void onJog(const Movement& movement);
    void onHeartbeatStart(bool start);
    void onHeartbeat() { ++beats_; }
    void onBrakesCheckStart(bool start);

    /// Feedback of the trajectory node.
    void onFeedback(Feedback feedback);

    /// One cycle.
    /// \param report    nothing if the bus is silent
    /// \param collision whether the trajectory node sees one
    void step(const std::optional<BusReport>& report, bool collision);

    MachineState state() const { return state_; }
    std::uint32_t opcode() const { return opcode_; }
    std::size_t axes() const { return axes_; }

private:
    enum class Pending : std::uint8_t { nothing, discovery, versions, configuration, reset, other };
    enum class MovePhase : std::uint8_t { idle, pause, cancel };
    struct Flags {
        bool overcurrent = false;
        bool power_stage_open = false;
        bool uncalibrated = false;
    };

    void enter(MachineState state) { state_ = state; }
    void beginCommand(Pending pending, std::uint64_t mask, std::size_t awaited);
    void stepCommand(const std::optional<BusReport>& report);
    void finishCommand();
    void expireCommand();
    void discover(std::uint64_t mask);

    Flags readFlags(const BusReport& report);
    void judge(const Flags& flags, bool collision);
    void brake();
    void stop();
    bool mayBrake() const;
    bool heartbeatLost();
    void stepSilence(const std::optional<BusReport>& report);
    void stepBrakesCheck();

    void startMove(const Movement& movement);
    void queueMove(const Movement& movement);
    void passNext();
    void pause(const Movement& movement);
    void resume(const Movement& movement);
    void cancel();
    void onExecuted(Feedback feedback);
    void onNeedData(Feedback feedback);
    void say(FeedbackType type, FeedbackData data = FeedbackData::none) {
        peers_.publishFeedback({type, data});
    }
    void stopJog();
    void set(Opcode bit, bool on);

    MachinePeers& peers_;
    MachineState state_ = MachineState::init;
    MachineState previous_ = MachineState::init;  // state to which command and jog return
    std::uint32_t opcode_ = 0;
    std::size_t axes_ = 0;
    std::array<int, kMostAxes> unheard_{};  // cycles
    int silence_ = 0;                       // cycles without any report

    Pending pending_ = Pending::nothing;
    CommandWait wait_;
    bool complete_ = false;  // the discovery found the configured axes
    int versions_left_ = 0;  // cycles

    MovePhase move_phase_ = MovePhase::idle;
    std::deque<Movement> moves_;

    std::optional<Movement> jog_;
    int jog_age_ = 0;  // cycles since it was last asked for

    bool heartbeat_wanted_ = false;
    int heartbeat_age_ = 0;
    int beats_ = 0;
    int brakes_check_left_ = 0;
};

}  // namespace metier::virtual_edo
