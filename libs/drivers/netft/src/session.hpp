#pragma once

#include <atomic>
#include <chrono>
#include <future>
#include <mutex>
#include <stop_token>
#include <thread>
#include <vector>

#include "metier/device/notifier.hpp"
#include "metier/device/safety_publisher.hpp"
#include "metier/device/shared_value.hpp"
#include "metier/link/udp_link.hpp"
#include "netft_sensor.hpp"
#include "record_stream.hpp"
#include "tare_task.hpp"

namespace metier::netft_driver {

/// The thread that receives the records, and all that others see of the sensor.
///
/// While records come and their status does not change it neither locks nor allocates.
class NetftSensor::Session {
public:
    explicit Session(NetftOptions options);
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    // ---- for device::ForceTorqueSensor; any thread ----
    const std::string& name() const noexcept { return options_.name; }
    device::WrenchSample sample() const noexcept;
    device::Safety safety() const { return safety_.safety(); }
    Result<void> tare();
    device::Registration onSafetyChange(SafetyCallback callback) {
        return safety_.onChange(std::move(callback));
    }
    std::uint64_t lostRecords() const noexcept { return lost_records_.load(); }

private:
    // ---- the session's thread ----
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
    std::atomic<std::uint64_t> lost_records_{0};
    std::uint64_t lost_before_ = 0;  // records lost in the connections before this one
    std::uint32_t status_ = 0;       // status word of the last record
    bool connected_ = false;

    std::atomic<bool> tare_asked_{false};
    std::optional<TareTask> tare_;
    std::mutex tare_mutex_;
    std::vector<std::promise<Result<void>>> tare_answers_;

    device::Notifier notifier_;
    std::jthread thread_;
};

}  // namespace metier::netft_driver
