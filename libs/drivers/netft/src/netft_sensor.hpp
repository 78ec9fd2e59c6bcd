#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <future>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "calibration.hpp"
#include "metier/device/driver.hpp"
#include "metier/device/force_torque_sensor.hpp"
#include "metier/device/notifier.hpp"
#include "metier/device/safety_publisher.hpp"
#include "metier/device/shared_value.hpp"
#include "metier/link/udp_link.hpp"
#include "record_stream.hpp"
#include "tare_task.hpp"

namespace metier::netft_driver {

/// Options of the driver for one sensor.
struct NetftOptions {
    std::string name;
    std::string host;
    std::uint16_t port = 49152;
    std::uint16_t http_port = 80;
    std::optional<Calibration> calibration{};  ///< not set: the sensor's own, by HTTP
    UnitTexts units{};                         ///< units for a page that does not state them
    /// Records [1/s]. Not set: as the sensor's page says, else kUsualRate.
    std::optional<double> rate{};
    /// Without a record: the sensor is lost. Not set: silenceAt() that rate.
    std::optional<std::chrono::milliseconds> silence{};
    /// Longest time that tare() waits for its end. Not a setting.
    std::chrono::milliseconds tare_wait{1'000};
};

inline constexpr double kUsualRate = 1000.0;  ///< records [1/s]

/// Five periods of the records, and 20 ms at least: a computer without a real-time kernel delays a
/// thread by as much now and then.
std::chrono::milliseconds silenceAt(double rate);

/// Reads `settings`: port, http_port, rate, silence, counts_per_force and counts_per_torque, or
/// force_unit and torque_unit.
/// Errors: invalid_argument for all that is wrong.
Result<NetftOptions> readOptions(const device::OpenRequest& request);

/// An ATI Net F/T sensor. Connects, and connects again, by itself; each time it reads the
/// calibration anew, and without one it gives no value.
///
/// While records come and their status does not change its thread neither locks nor allocates.
class NetftSensor final : public device::ForceTorqueSensor {
public:
    explicit NetftSensor(NetftOptions options);
    /// Ends the stream.
    ~NetftSensor() override;
    NetftSensor(const NetftSensor&) = delete;
    NetftSensor& operator=(const NetftSensor&) = delete;

    const std::string& name() const noexcept override { return options_.name; }
    device::WrenchSample sample() const noexcept override;
    device::Safety safety() const override { return safety_.safety(); }
    /// Waits at most options.tare_wait. Errors also: device_fault while the sensor reports an
    /// error.
    Result<void> tare() override;
    device::Registration onSafetyChange(SafetyCallback callback) override {
        return safety_.onChange(std::move(callback));
    }

private:
    // ---- the thread that receives the records ----
    void run(const std::stop_token& stop);
    /// One connection, from begin to end. Errors: why it ended; nothing if it was to end.
    Result<void> connection(const std::stop_token& stop);
    /// Reads the calibration from the settings or the sensor's page, which also has the rate of the
    /// records.
    Result<Calibration> calibration();
    Result<std::string> readPage() const;
    void setSilence(std::optional<double> reported_rate) noexcept;
    /// Asks for records until the first comes.
    Result<void> begin(const std::stop_token& stop, link::UdpLink& link, RecordStream& stream);
    Result<void> follow(const std::stop_token& stop, link::UdpLink& link, RecordStream& stream);
    void take(const device::WrenchSample& sample, const RecordStream& stream);
    Result<void> workOnTare(link::UdpLink& link, const device::WrenchSample& sample);
    void endTare(const Result<void>& outcome);
    void lost(const Error& why);
    std::string named(std::string_view text) const;

    const NetftOptions options_;
    std::atomic<std::chrono::milliseconds> silence_;
    device::SharedValue<device::WrenchSample> sample_;
    device::SafetyPublisher safety_;
    std::uint32_t status_ = 0;  // status word of the last record
    bool connected_ = false;

    std::atomic<bool> tare_asked_{false};
    std::optional<TareTask> tare_;
    std::mutex tare_mutex_;
    std::vector<std::promise<Result<void>>> tare_answers_;

    device::Notifier notifier_;
    std::jthread thread_;
};

}  // namespace metier::netft_driver
