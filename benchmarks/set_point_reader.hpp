#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>

namespace metier::benchmarks {

/// Finds set-points of joint 1 among the bytes that a driver sends to its controller.
///
/// Written from the maker's documents (docs/protocols), not from the driver, and only as far as a
/// set-point needs. Threading: one thread.
class SetPointReader {
public:
    using Found = std::function<void(double)>;  ///< [rad]

    virtual ~SetPointReader() = default;
    /// Takes the next bytes of the connection, however they are cut.
    virtual void read(std::span<const std::byte> bytes, const Found& found) = 0;
};

/// RTDE: data packages with the input registers of metier's script: token, counter, six joints.
std::unique_ptr<SetPointReader> rtdeReader();
/// libiiwa: commands of eight numbers in single precision; 102 is a joint position.
std::unique_ptr<SetPointReader> libiiwaReader();
/// rosbridge: JSON texts in masked WebSocket frames; joint positions in degrees.
std::unique_ptr<SetPointReader> rosbridgeReader();

}  // namespace metier::benchmarks
