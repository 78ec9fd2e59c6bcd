#include "sensor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace metier::virtual_netft {

namespace {

constexpr double kGaugeRange = 32767.0;

std::int32_t toCounts(double value) {
    constexpr double most = std::numeric_limits<std::int32_t>::max();
    return static_cast<std::int32_t>(std::lround(std::clamp(value, -most, most)));
}

}  // namespace

Sensor::Reading Sensor::read(const motion::Wrench& load) {
    Reading reading;
    reading.status = status_;
    for (std::size_t axis = 0; axis < last_.size(); ++axis) {
        const bool force = axis < 3;
        const auto i = static_cast<Eigen::Index>(axis % 3);
        const double noise = force ? calibration_.force_noise : calibration_.torque_noise;
        const double real = force ? load.force[i] : load.torque[i];
        const double range = calibration_.range[axis];
        const double wanted = std::isfinite(real) ? real + noise * normal_(random_) : 0.0;
        last_[axis] = std::clamp(wanted, -range, range);
        if (last_[axis] != wanted) {
            reading.status |= status::kSaturated;
        }
        const double scale = force ? calibration_.counts_per_force / calibration_.force_unit.size
                                   : calibration_.counts_per_torque / calibration_.torque_unit.size;
        reading.counts[axis] = toCounts((last_[axis] - bias_[axis]) * scale);
    }
    return reading;
}

std::array<int, 6> Sensor::gaugeBias() const noexcept {
    std::array<int, 6> result{};
    for (std::size_t gauge = 0; gauge < result.size(); ++gauge) {
        const double part = bias_[gauge] / calibration_.range[gauge];
        result[gauge] = static_cast<int>(std::lround(part * kGaugeRange));
    }
    return result;
}

void Sensor::setGaugeBias(std::size_t gauge, int bias) noexcept {
    bias_[gauge] = bias / kGaugeRange * calibration_.range[gauge];
}

void Sensor::resetLatch() noexcept {
    if (status_ == status::kMonitorLatched) {
        status_ = status::kHealthy;
    }
}

}  // namespace metier::virtual_netft
