#include "moves/sensor_failure.hpp"

#include <fmt/format.h>

namespace metier::robot_skills {

using device::SafetyState;

SensorFailure::SensorFailure(device::ForceTorqueSensor& sensor)
    : sensor_(sensor),
      registration_(sensor.onSafetyChange([heard = heard_](const device::Safety& safety) {
          const std::lock_guard lock(heard->mutex);
          if (safety.state != SafetyState::normal && heard->text.empty()) {
              heard->text = safety.text;
          } else if (safety.state == SafetyState::normal && !heard->closed.load()) {
              heard->text.clear();
          }
      })) {}

void SensorFailure::keep(SafetyState health) noexcept {
    if (!kept()) {
        kept_.store(health);
        heard_->closed.store(true);
    }
}

std::string SensorFailure::text() const {
    {
        const std::lock_guard lock(heard_->mutex);
        if (!heard_->text.empty()) {
            return heard_->text;
        }
    }
    const auto now = sensor_.safety();
    return now.state != SafetyState::normal
               ? now.text
               : fmt::format("{} for a moment, and well again", device::toString(kept_.load()));
}

}  // namespace metier::robot_skills
