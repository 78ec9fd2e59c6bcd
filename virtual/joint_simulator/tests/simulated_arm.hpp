#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "metier/joint_simulator/joint_simulator.hpp"

namespace metier::joint_simulator {

/// Two axes of +-2 rad, 1 rad/s, 10 rad/s2 at 100 Hz, standing at zero.
inline JointSimulatorOptions twoAxisOptions() {
    JointSimulatorOptions options;
    options.name = "arm";
    options.axis_names = {"A1", "A2"};
    options.limits.assign(2, AxisLimits{-2.0, 2.0, 1.0, 10.0});
    options.start_position = {0.0, 0.0};
    options.cycle = std::chrono::milliseconds(10);
    return options;
}

inline std::unique_ptr<JointSimulator> twoAxisArm(
    JointSimulatorOptions options = twoAxisOptions()) {
    return std::move(JointSimulator::create(std::move(options)).value());
}

inline device::JointArray joints(double first, double second) {
    device::JointArray values(2);
    values[0] = first;
    values[1] = second;
    return values;
}

/// A source made of a function that returns the next set-point, nothing at its end.
class FunctionSource final : public device::SetPointSource {
public:
    using Function = std::function<std::optional<device::JointArray>(const device::ArmState&)>;

    explicit FunctionSource(Function function) : function_(std::move(function)) {}

    Next next(const device::ArmState& state, device::JointArray& set_point) noexcept override {
        const auto wanted = function_(state);
        if (!wanted) {
            return Next::done;
        }
        set_point = *wanted;
        return Next::set_point;
    }

    void ended(device::EndCause cause, const device::Safety& safety) override {
        {
            const std::lock_guard lock(mutex_);
            ends_.emplace_back(cause, safety);
        }
        changed_.notify_all();
    }

    std::vector<std::pair<device::EndCause, device::Safety>> ends() const {
        const std::lock_guard lock(mutex_);
        return ends_;
    }

    /// Waits until the arm let go, at most 20 s.
    bool waitForEnd() {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, std::chrono::seconds(20), [this] { return !ends_.empty(); });
    }

private:
    Function function_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<std::pair<device::EndCause, device::Safety>> ends_;
};

/// Speeds axis 1 up to `speed` [rad/s] at 10 rad/s2 and keeps it; never ends.
inline std::shared_ptr<FunctionSource> cruise(double speed, double cycle = 0.01) {
    return std::make_shared<FunctionSource>(
        [speed, cycle, position = 0.0, velocity = 0.0](const device::ArmState&) mutable {
            velocity = std::min(speed, velocity + 10.0 * cycle);
            position += velocity * cycle;
            return std::optional(joints(position, 0.0));
        });
}

}  // namespace metier::joint_simulator
