#include "sensor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace metier::virtual_netft {

namespace {

constexpr double kPoundForce = 4.4482216152605;  // [N]
constexpr double kKilogramForce = 9.80665;       // [N]
constexpr double kInch = 0.0254;                 // [m]
constexpr double kFoot = 0.3048;                 // [m]

constexpr double kGaugeRange = 32767.0;

constexpr std::array kForceUnits{Unit{"N", 1.0, 2},
                                 Unit{"kN", 1e3, 4},
                                 Unit{"lbf", kPoundForce, 1},
                                 Unit{"klbf", 1e3 * kPoundForce, 3},
                                 Unit{"kgf", kKilogramForce, 5},
                                 Unit{"gf", 1e-3 * kKilogramForce, 6}};
constexpr std::array kTorqueUnits{Unit{"Nm", 1.0, 3},
                                  Unit{"N-m", 1.0, 3},
                                  Unit{"Nmm", 1e-3, 4},
                                  Unit{"N-mm", 1e-3, 4},
                                  Unit{"kN-m", 1e3, 6},
                                  Unit{"lbf-in", kPoundForce* kInch, 1},
                                  Unit{"lbf-ft", kPoundForce* kFoot, 2},
                                  Unit{"kNm", 1e3, 6},
                                  Unit{"kgf-cm", 1e-2 * kKilogramForce, 5}};

std::int32_t toCounts(double value) {
    constexpr double most = std::numeric_limits<std::int32_t>::max();
    return static_cast<std::int32_t>(std::lround(std::clamp(value, -most, most)));
}

}  // namespace

std::span<const Unit> forceUnits() noexcept {
    return kForceUnits;
}

std::span<const Unit> torqueUnits() noexcept {
    return kTorqueUnits;
}

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
