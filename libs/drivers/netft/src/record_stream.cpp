#include "record_stream.hpp"

#include <cstddef>

namespace metier::netft_driver {

using device::SafetyState;
using device::WrenchSample;

std::optional<WrenchSample> RecordStream::take(std::span<const std::byte> datagram,
                                               SteadyTime now) {
    if (datagram.empty() || datagram.size() % kRecordSize != 0) {
        return std::nullopt;
    }
    std::optional<WrenchSample> newest;
    for (std::size_t offset = 0; offset < datagram.size(); offset += kRecordSize) {
        const auto record = parseRecord(datagram.subspan(offset, kRecordSize));
        if (record && isNew(*record)) {
            newest = toSample(*record, now);
        }
    }
    return newest;
}

bool RecordStream::isNew(const RdtRecord& record) {
    if (last_) {
        const auto step = record.sequence - last_->sequence;  // modulo 2^32
        constexpr std::uint32_t kHalf = 0x80000000U;
        if (step == 0 || step >= kHalf) {
            return false;
        }
        sensor_sequence_ += std::uint32_t{record.sensor_sequence - last_->sensor_sequence};
    } else {
        sensor_sequence_ = record.sensor_sequence;
    }
    last_ = record;
    status_ = record.status;
    return true;
}

WrenchSample RecordStream::toSample(const RdtRecord& record, SteadyTime now) const noexcept {
    WrenchSample sample;
    for (std::size_t i = 0; i < 3; ++i) {
        sample.force[i] = record.counts[i] * calibration_.force_per_count;
        sample.torque[i] = record.counts[i + 3] * calibration_.torque_per_count;
    }
    sample.sequence = sensor_sequence_;
    sample.health = isError(record.status) ? SafetyState::fault : SafetyState::normal;
    sample.stamp = now;
    return sample;
}

}  // namespace metier::netft_driver
