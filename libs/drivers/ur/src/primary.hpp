#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "controller_state.hpp"
#include "metier/base/error.hpp"
#include "stream_buffer.hpp"

/// The primary client interface of Universal Robots: bytes, no socket.
/// Source of every layout: docs/protocols/ur.md#primary.
namespace metier::ur_driver::primary {

inline constexpr std::size_t kHeaderSize = 5;
/// A longer package is taken for garbage: real ones have one to two thousand bytes.
inline constexpr std::size_t kMaxPackageSize = 65536;

/// T_i = Rz(q_i + theta_i) Tz(d_i) Tx(a_i) Rx(alpha_i) of this very arm. [rad], [m]
struct Kinematics {
    Joints theta{};
    Joints a{};
    Joints d{};
    Joints alpha{};

    friend bool operator==(const Kinematics&, const Kinematics&) = default;
};

/// Limits of the controller's safety settings.
struct Configuration {
    Joints lower{};             ///< [rad]
    Joints upper{};             ///< [rad]
    Joints max_velocity{};      ///< [rad/s]
    Joints max_acceleration{};  ///< [rad/s2]

    friend bool operator==(const Configuration&, const Configuration&) = default;
};

/// Version of the controller's software, as far as the driver uses it.
struct Version {
    int major = 0;
};

/// A message of the controller for a person.
struct Report {
    enum class Kind : std::uint8_t { text, safety, error, runtime_exception };
    enum class Level : std::uint8_t { debug, info, warning, violation, fault, critical };
    Kind kind = Kind::text;
    Level level = Level::info;
    std::int32_t code = 0;      ///< code of error and safety; the line of a runtime exception
    std::int32_t argument = 0;  ///< argument of error and safety; the column of a runtime exception
    std::string text{};         ///< printable; may be empty

    /// "C153A2: ..." or "runtime exception in line 3, column 4: ...".
    std::string toText() const;
};

/// Parts of one package that the driver understands; the rest was skipped.
struct Package {
    std::optional<Kinematics> kinematics;
    std::optional<Configuration> configuration;
    std::optional<Version> version;
    std::optional<Report> report;
};

/// Size of the first package of the buffer with its header; nothing if it is not complete yet.
/// Errors: invalid_argument if it is under kHeaderSize or over kMaxPackageSize.
Result<std::optional<std::size_t>> firstPackageSize(const StreamBuffer& buffer);

/// \param bytes one whole package, header included
/// Errors: invalid_argument: a length inside it does not fit, or a value is not finite.
Result<Package> parse(std::span<const std::byte> bytes);

}  // namespace metier::ur_driver::primary
