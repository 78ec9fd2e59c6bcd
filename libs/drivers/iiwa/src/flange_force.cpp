#include "flange_force.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace metier::iiwa_driver {

namespace {

bool allFinite(const std::array<double, 3>& values) noexcept {
    return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

}  // namespace

FlangeForce::FlangeForce(device::ArmCore& core, std::chrono::nanoseconds longest)
    : core_(core), longest_(longest), name_(core.info().name + " flange") {}

void FlangeForce::take(const CabinetState& answer, SteadyTime now) noexcept {
    device::WrenchSample sample;
    sample.force = answer.force;
    sample.torque = answer.torque;
    sample.sequence = newest_.read().sequence + 1;
    const bool known = allFinite(answer.force) && allFinite(answer.torque);
    sample.health = known ? device::SafetyState::normal : device::SafetyState::fault;
    sample.stamp = now;
    newest_.write(sample);
}

device::WrenchSample FlangeForce::sample() const noexcept {
    auto sample = newest_.read();
    const auto zero = zero_.read();
    for (std::size_t i = 0; i < 3; ++i) {
        sample.force[i] -= zero.force[i];
        sample.torque[i] -= zero.torque[i];
    }
    const auto age = std::chrono::steady_clock::now() - sample.stamp;
    if (age > longest_) {
        sample.health = device::SafetyState::disconnected;
    }
    return sample;
}

Result<void> FlangeForce::tare() {
    const auto now = sample().health;
    if (now != device::SafetyState::normal) {
        return fail(Errc::connection_lost, name_ + ": no measurement to make zero");
    }
    const std::lock_guard lock(tare_mutex_);
    zero_.write(newest_.read());
    return {};
}

}  // namespace metier::iiwa_driver
