#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

// Records as a sensor would send them, written without the driver's codec.
namespace metier::netft_driver::testing {

using Bytes = std::vector<std::byte>;

inline void appendBigEndian(Bytes& bytes, std::uint32_t value) {
    for (const unsigned shift : {24U, 16U, 8U, 0U}) {
        bytes.push_back(static_cast<std::byte>(value >> shift & 0xFFU));
    }
}

struct Record {
    std::uint32_t sequence = 1;
    std::uint32_t sensor_sequence = 1;
    std::uint32_t status = 0;
    std::array<std::int32_t, 6> counts{};

    Bytes bytes() const {
        Bytes result;
        appendBigEndian(result, sequence);
        appendBigEndian(result, sensor_sequence);
        appendBigEndian(result, status);
        for (const auto count : counts) {
            appendBigEndian(result, static_cast<std::uint32_t>(count));
        }
        return result;
    }
};

}  // namespace metier::netft_driver::testing
