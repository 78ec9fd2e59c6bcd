#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "metier/iiwa_driver/iiwa_arm.hpp"
#include "scripted_cabinet.hpp"

namespace metier::iiwa_driver {

using namespace std::chrono_literals;

/// Looks again after each millisecond until `done`, at most `limit`; whether it is.
inline bool until(const std::function<bool()>& done, std::chrono::milliseconds limit = 15s) {
    std::mutex mutex;
    std::condition_variable never;
    std::unique_lock lock(mutex);
    const auto deadline = std::chrono::steady_clock::now() + limit;
    while (!done()) {
        if (std::chrono::steady_clock::now() > deadline) {
            return false;
        }
        never.wait_for(lock, 1ms);
    }
    return true;
}

/// Outcome of a motion, for a thread that waits for it.
class Outcome {
public:
    device::MotionPlanner::Done taker() {
        return [this](Result<device::MotionOutcome> outcome) {
            const std::lock_guard lock(mutex_);
            ++count_;
            outcome_ = std::move(outcome);
        };
    }
    bool told() const {
        const std::lock_guard lock(mutex_);
        return count_ > 0;
    }
    int count() const {
        const std::lock_guard lock(mutex_);
        return count_;
    }
    Result<device::MotionOutcome> get() const {
        const std::lock_guard lock(mutex_);
        return *outcome_;
    }

private:
    mutable std::mutex mutex_;
    int count_ = 0;
    std::optional<Result<device::MotionOutcome>> outcome_;
};

/// Streams by a function of the cycle's number; counts and reports its end.
class Stream final : public device::SetPointSource {
public:
    using Play = std::function<Next(int cycle, device::JointArray& set_point)>;
    explicit Stream(Play play) : play_(std::move(play)) {}

    Next next(const device::ArmState& /*state*/, device::JointArray& set_point) noexcept override {
        return play_(cycle_++, set_point);
    }
    void ended(device::EndCause cause, const device::Safety& safety) override {
        const std::lock_guard lock(mutex_);
        cause_ = cause;
        safety_ = safety;
        ++ends_;
    }
    std::optional<device::EndCause> cause() const {
        const std::lock_guard lock(mutex_);
        return cause_;
    }
    device::Safety safety() const {
        const std::lock_guard lock(mutex_);
        return safety_;
    }
    int ends() const {
        const std::lock_guard lock(mutex_);
        return ends_;
    }

private:
    Play play_;
    int cycle_ = 0;
    mutable std::mutex mutex_;
    std::optional<device::EndCause> cause_;
    device::Safety safety_;
    int ends_ = 0;
};

/// An arm and the cabinet that dialled in to it.
class ArmBench {
public:
    explicit ArmBench(const ScriptedCabinet::Options& kind = {}, IiwaOptions options = quick())
        : options_(kind) {
        options.precision = kind.double_precision ? Precision::float64 : Precision::float32;
        arm = IiwaArm::create(options, model).value();
        dialIn();
    }

    static IiwaOptions quick() {
        IiwaOptions options;
        options.port = 0;
        options.cycle = 4ms;
        options.answer_timeout = 5s;  // a busy machine is no silent cabinet
        return options;
    }

    void dialIn() { cabinet = std::make_unique<ScriptedCabinet>(arm->port(), options_); }
    bool becomes(device::SafetyState state) {
        return until([&] { return arm->state().safety == state; });
    }
    bool ready() { return becomes(device::SafetyState::normal); }

    static device::ControllerPlannedMotion toJoints(double first_axis) {
        device::ControllerPlannedMotion motion;
        motion.target_joints = device::JointArray(std::span(ScriptedCabinet::kHome));
        motion.target_joints[0] = first_axis;
        return motion;
    }

    const motion::RobotModel model = iiwa7();
    std::unique_ptr<IiwaArm> arm;
    std::unique_ptr<ScriptedCabinet> cabinet;

private:
    const ScriptedCabinet::Options options_;
};

}  // namespace metier::iiwa_driver
