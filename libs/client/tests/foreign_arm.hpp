#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "metier/skill/state.hpp"
#include "served_nodes.hpp"

namespace metier::client::testing {

/// Differences between servers of other makers.
struct ForeignShape {
    /// Names of the axes in the order of the server, which is that of its arrays.
    std::vector<std::string> axes{"wrist_3", "wrist_2", "wrist_1", "elbow", "shoulder", "base"};
    bool degrees = true;       ///< unit of ActualPosition
    bool takes_times = true;   ///< SourceTimestamps
    bool has_safety = true;    ///< publishes stops
    bool has_reset = true;     ///< of the stream skill
    bool takes_poses = false;  ///< instead of joint positions
    bool follows = true;       ///< its set-points
    /// Whether the server has another arm in the same system.
    bool other_arm = false;
    /// Whether it has another stream, of the controller "Other".
    bool other_stream = false;
    skill::State state = skill::State::ready;
};

/// An arm of six axes behind a server that knows nothing of metier: a motion device of OPC 40010-1,
/// and a Program that follows a stream. The arm is at each set-point at once.
class ForeignArm {
public:
    using State = skill::State;

    explicit ForeignArm(ForeignShape shape = {})
        : shape_(std::move(shape)), state_(shape_.state), position_(shape_.axes.size(), 0.1) {
        const auto system = served_.object(opcua::ids::kObjectsFolder, "Robot");
        const auto devices = served_.object(system, "MotionDevices");
        addAxes(served_.object(devices, "Arm"));
        if (shape_.other_arm) {
            addAxes(served_.object(devices, "OtherArm"));
        }
        if (shape_.has_safety) {
            addSafety(served_.object(served_.object(system, "SafetyStates"), "Safety"));
        }
        const auto controllers = served_.object(system, "Controllers");
        addSkill(served_.object(served_.object(controllers, "Controller"), "Skills"));
        if (shape_.other_stream) {
            addSkill(served_.object(served_.object(controllers, "Other"), "Skills"));
        }
    }

    std::string url() { return served_.url(); }
    /// Position of that axis [rad].
    double position(const std::string& axis) {
        const std::lock_guard lock(mutex_);
        return position_.at(indexOf(axis));
    }
    std::vector<double> positions() {
        const std::lock_guard lock(mutex_);
        return position_;
    }
    /// Poses that were written: x of each [m].
    std::vector<double> poses() {
        const std::lock_guard lock(mutex_);
        return poses_;
    }
    /// Set-point that was there at the last Start, in the server's order [rad].
    std::vector<double> targetAtStart() {
        const std::lock_guard lock(mutex_);
        return target_at_start_;
    }
    /// Methods that were called, in order.
    std::vector<std::string> calls() {
        const std::lock_guard lock(mutex_);
        return calls_;
    }
    /// Number of set-points that came with a time.
    int times() const { return times_; }
    /// Waits until the skill is in that state; false after 30 s.
    bool await(State wanted) {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, std::chrono::seconds(30), [&] { return state_ == wanted; });
    }
    /// Waits until so many set-points have come while it ran; false after 30 s.
    bool awaitSetPoints(int wanted) {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, std::chrono::seconds(30),
                                 [&] { return set_points_ >= wanted; });
    }
    void go(State state) {
        {
            const std::lock_guard lock(mutex_);
            state_ = state;
        }
        changed_.notify_all();
    }
    void pressEmergencyStop(bool pressed) { emergency_stop_ = pressed; }
    /// Waits until the emergency stop was read so often while it was pressed; false after 30 s.
    bool awaitStopReads(int wanted) {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, std::chrono::seconds(30),
                                 [&] { return stop_reads_ >= wanted; });
    }
    void loseEncoders(bool lost) { encoders_lost_ = lost; }
    /// The emergency stop has no value any more.
    void loseStop(bool lost) { stop_lost_ = lost; }
    void refuseSetPoints() { refuses_ = true; }
    /// It is halted by itself in the moment of the next Halt.
    void haltsItselfNext() { halts_itself_ = true; }
    /// Answers no write while it is held, at most 20 s.
    void hold(bool held) {
        {
            const std::lock_guard lock(mutex_);
            held_ = held;
        }
        changed_.notify_all();
    }
    /// Somebody else moves that axis [rad].
    void push(const std::string& axis, double distance) {
        const std::lock_guard lock(mutex_);
        position_.at(indexOf(axis)) += distance;
    }

private:
    using NodeId = opcua::NodeId;
    using Value = opcua::Value;

    std::size_t indexOf(const std::string& axis) const {
        const auto found = std::find(shape_.axes.begin(), shape_.axes.end(), axis);
        return static_cast<std::size_t>(found - shape_.axes.begin());
    }
    void source(const NodeId& variable, std::function<opcua::DataValue()> read) {
        EXPECT_TRUE(served_.nodes().setDataSource(
            variable,
            {.read = [read = std::move(read)](const auto& /*session*/) { return read(); }}));
    }
    static opcua::DataValue valueOf(Value value) {
        opcua::DataValue data;
        data.value = std::move(value);
        return data;
    }

    void addAxes(const NodeId& device) {
        const auto axes = served_.object(device, "Axes");
        const opcua::EuInformation degree{"http://www.opcfoundation.org/UA/units/un/cefact",
                                          17'476,
                                          {"", "\u00b0"},
                                          {"", "degree"}};
        const opcua::EuInformation radian{degree.namespace_uri, 4'405'297, {"", "rad"}, {}};
        for (std::size_t i = 0; i < shape_.axes.size(); ++i) {
            const auto set = served_.object(served_.object(axes, shape_.axes[i]), "ParameterSet");
            const auto position = served_.variable(set, "ActualPosition", Value::of(0.0));
            served_.variable(position, opcua::QualifiedName{0, "EngineeringUnits"},
                             Value::of(shape_.degrees ? degree : radian));
            source(position, [this, i] { return measured(i); });
        }
    }
    opcua::DataValue measured(std::size_t axis) {
        const std::lock_guard lock(mutex_);
        auto data =
            valueOf(Value::of(position_[axis] * (shape_.degrees ? 180.0 / std::numbers::pi : 1.0)));
        if (encoders_lost_) {
            data = {};
            data.status = opcua::status::kBadTimeout;
        }
        return data;
    }
    void addSafety(const NodeId& state) {
        const auto set = served_.object(state, "ParameterSet");
        const auto stop = served_.variable(set, "EmergencyStop", Value::of(false));
        served_.variable(set, "ProtectiveStop", Value::of(false));
        source(stop, [this] { return stopNow(); });
    }

    opcua::DataValue stopNow() {
        opcua::DataValue data;
        if (stop_lost_) {
            data.status = opcua::status::kBadTimeout;
            return data;
        }
        data.value = Value::of(emergency_stop_.load());
        if (emergency_stop_) {
            const std::lock_guard lock(mutex_);
            ++stop_reads_;
        }
        changed_.notify_all();
        return data;
    }

    void addSkill(const NodeId& skills) {
        const auto robotics =
            served_.nodes().namespaceIndex("https://fortiss.org/UA/Robotics/").value();
        constexpr std::uint32_t stream_type = 15'775;
        const auto skill =
            served_.object(skills, "PositionStreamSkill", NodeId(robotics, stream_type));
        const auto state =
            served_.variable(skill, opcua::QualifiedName{0, "CurrentState"}, Value::of("Ready"));
        const auto number =
            served_.variable(state, opcua::QualifiedName{0, "Number"}, Value::of(std::uint32_t{0}));
        source(number, [this] {
            const std::lock_guard lock(mutex_);
            return valueOf(Value::of(static_cast<std::uint32_t>(state_)));
        });
        const auto parameters = served_.object(skill, "ParameterSet");
        addTarget(
            shape_.takes_poses
                ? served_.variable(parameters, "TargetPosition", Value::of(opcua::ThreeDFrame{}))
                : served_.variable(parameters, "TargetJointPosition", Value::of(target_)));
        addMethod(skill, "Start", State::ready, State::running);
        addMethod(skill, "Halt", State::running, State::halted);
        if (shape_.has_reset) {
            addMethod(skill, "Reset", State::halted, State::ready);
        }
    }
    void addTarget(const NodeId& target) {
        EXPECT_TRUE(served_.nodes().setAccess(target, opcua::Access::read_write));
        EXPECT_TRUE(served_.nodes().setDataSource(
            target, {.read =
                         [this](const auto& /*session*/) {
                             const std::lock_guard lock(mutex_);
                             return valueOf(shape_.takes_poses ? Value::of(opcua::ThreeDFrame{})
                                                               : Value::of(target_));
                         },
                     .write =
                         [this](const auto& writer, const Value& value) {
                             return take(writer.source_time.has_value(), value);
                         }}));
    }
    Result<> take(bool with_time, const Value& value) {
        if (with_time && !shape_.takes_times) {
            return fail(Errc::not_supported, "no times");
        }
        if (refuses_) {
            return fail(Errc::out_of_range, "too far");
        }
        {
            std::unique_lock lock(mutex_);
            changed_.wait_for(lock, std::chrono::seconds(20), [this] { return !held_; });
            times_ += with_time ? 1 : 0;
            takeSetPoint(value);
            set_points_ += state_ == State::running ? 1 : 0;
        }
        changed_.notify_all();
        return {};
    }
    void takeSetPoint(const Value& value) {
        if (const auto pose = value.as<opcua::ThreeDFrame>()) {
            poses_.push_back(pose->x);
            return;
        }
        target_ = value.as<std::vector<double>>().value();
        position_ = state_ == State::running && shape_.follows ? target_ : position_;
    }
    void addMethod(const NodeId& skill, const std::string& name, State from, State to) {
        const auto work = [this, name, from, to](const auto& /*caller*/,
                                                 auto /*in*/) -> Result<std::vector<Value>> {
            {
                const std::lock_guard lock(mutex_);
                calls_.push_back(name);
                if (name == "Halt" && std::exchange(halts_itself_, false)) {
                    state_ = State::halted;
                    return fail(Errc::invalid_state, "not now");
                }
                if (state_ != from) {
                    return fail(Errc::invalid_state, "not now");
                }
                state_ = to;
                target_at_start_ = to == State::running ? target_ : target_at_start_;
            }
            changed_.notify_all();
            return std::vector<Value>();
        };
        EXPECT_TRUE(served_.nodes().setMethod(served_.method(skill, name), work));
    }

    const ForeignShape shape_;
    std::mutex mutex_;
    std::condition_variable changed_;
    State state_;
    std::vector<double> position_;
    std::vector<double> target_ = std::vector<double>(6, 3.0);  // of the stream before
    std::vector<double> target_at_start_;
    std::vector<double> poses_;
    std::vector<std::string> calls_;
    int set_points_ = 0;
    int stop_reads_ = 0;
    bool halts_itself_ = false;
    bool held_ = false;
    std::atomic<int> times_ = 0;
    std::atomic<bool> emergency_stop_ = false;
    std::atomic<bool> encoders_lost_ = false;
    std::atomic<bool> stop_lost_ = false;
    std::atomic<bool> refuses_ = false;
    ServedNodes served_{{"device", "robotics"}};  // last: its thread uses all of the above
};

}  // namespace metier::client::testing
