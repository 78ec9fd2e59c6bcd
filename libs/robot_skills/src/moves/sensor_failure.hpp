#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>

#include "metier/device/force_torque_sensor.hpp"

namespace metier::robot_skills {

/// Why a sensor failed during a motion: the first reason, also if the sensor is well again by the
/// time that the arm has come to rest.
///
/// Threading: keep() and kept() the cycle thread, which they neither lock nor allocate on, and any
/// other after the motion; text() any but the cycle thread.
class SensorFailure {
public:
    /// \param sensor must outlive this
    explicit SensorFailure(device::ForceTorqueSensor& sensor);

    /// The sensor is not well now. Later calls change nothing.
    void keep(device::SafetyState health) noexcept;
    bool kept() const noexcept { return kept_.load() != device::SafetyState::normal; }
    /// Text of the sensor when it failed; its state at that time if it recovered without a text.
    std::string text() const;

private:
    struct Heard {
        std::mutex mutex;
        std::string text;  ///< empty while the sensor is well
        std::atomic<bool> closed{false};
    };

    device::ForceTorqueSensor& sensor_;
    std::atomic<device::SafetyState> kept_{device::SafetyState::normal};
    // Shared with the callback, which may run while this is destroyed.
    std::shared_ptr<Heard> heard_ = std::make_shared<Heard>();
    device::Registration registration_;
};

}  // namespace metier::robot_skills
