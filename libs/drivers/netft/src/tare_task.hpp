#pragma once

#include <array>
#include <chrono>
#include <optional>

#include "metier/device/force_torque_sensor.hpp"

namespace metier::netft_driver {

/// Task of taking the present load as zero. The sensor does not answer the request, so the records
/// after it must show whether it arrived.
///
/// Threading: one thread.
class TareTask {
public:
    /// Largest mean of kRecords that counts as zero.
    static constexpr double kZeroForce = 0.5;    ///< [N]
    static constexpr double kZeroTorque = 0.05;  ///< [Nm]
    static constexpr int kRecords = 10;
    static constexpr int kAttempts = 3;
    static constexpr std::chrono::milliseconds kAttemptTime{150};

    explicit TareTask(SteadyTime now) : attempt_end_(now) {}

    /// Reports whether the request must be sent now.
    bool toSend(SteadyTime now);
    /// The outcome, once it is known. Errors: timeout, with the load that is left.
    std::optional<Result<void>> take(const device::WrenchSample& sample, SteadyTime now);

private:
    void beginMean() noexcept;

    SteadyTime attempt_end_;
    int attempts_ = 0;
    int records_ = 0;
    std::array<double, 3> force_sum_{};
    std::array<double, 3> torque_sum_{};
    double force_left_ = 0.0;
    double torque_left_ = 0.0;
};

}  // namespace metier::netft_driver
