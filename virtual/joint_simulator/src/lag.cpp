#include "metier/joint_simulator/lag.hpp"

#include <algorithm>
#include <cmath>

namespace metier::joint_simulator {

Lag::Lag(std::size_t delay_cycles, double time_constant, double cycle) noexcept
    : delay_cycles_(std::min(delay_cycles, kMaxDelayCycles)),
      share_(time_constant > 0.0 ? 1.0 - std::exp(-cycle / time_constant) : 1.0),
      cycle_(cycle) {}

void Lag::reset(const device::JointArray& position) noexcept {
    past_.fill(position);
    position_ = position;
    velocity_ = device::JointArray(position.size());
}

void Lag::advance(const device::JointArray& commanded) noexcept {
    // Closer than this the measured arm has arrived: an exponential alone never would.
    constexpr double arrived = 1e-9;
    newest_ = (newest_ + 1) % past_.size();
    past_[newest_] = commanded;
    const auto& target = past_[(newest_ + past_.size() - delay_cycles_) % past_.size()];
    for (std::size_t axis = 0; axis < position_.size(); ++axis) {
        const double way = target[axis] - position_[axis];
        const double step = std::abs(way) < arrived ? way : share_ * way;
        position_[axis] += step;
        velocity_[axis] = step / cycle_;
    }
}

}  // namespace metier::joint_simulator
