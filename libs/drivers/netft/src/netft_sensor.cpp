#include "netft_sensor.hpp"

#include <utility>

#include "session.hpp"

namespace metier::netft_driver {

NetftSensor::NetftSensor(NetftOptions options)
    : session_(std::make_unique<Session>(std::move(options))) {}

NetftSensor::~NetftSensor() = default;

const std::string& NetftSensor::name() const noexcept {
    return session_->name();
}

device::WrenchSample NetftSensor::sample() const noexcept {
    return session_->sample();
}

device::Safety NetftSensor::safety() const {
    return session_->safety();
}

Result<void> NetftSensor::tare() {
    return session_->tare();
}

device::Registration NetftSensor::onSafetyChange(SafetyCallback callback) {
    return session_->onSafetyChange(std::move(callback));
}

std::uint64_t NetftSensor::lostRecords() const noexcept {
    return session_->lostRecords();
}

}  // namespace metier::netft_driver
