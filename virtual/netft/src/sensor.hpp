#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <string_view>

#include "metier/motion/wrench.hpp"
#include "rdt.hpp"

namespace metier::virtual_netft {

/// A unit that the sensor can be set to, with its size in SI units.
struct Unit {
    std::string_view name;
    double size = 1.0;
    int code = 0;  ///< its number on the pages
};

inline constexpr double kPoundForce = 4.4482216152605;  // [N]
inline constexpr double kKilogramForce = 9.80665;       // [N]
inline constexpr double kInch = 0.0254;                 // [m]
inline constexpr double kFoot = 0.3048;                 // [m]

/// Units in the spelling of the sensor's web pages.
inline constexpr std::array kForceUnits{Unit{"N", 1.0, 2},
                                        Unit{"kN", 1e3, 4},
                                        Unit{"lbf", kPoundForce, 1},
                                        Unit{"klbf", 1e3 * kPoundForce, 3},
                                        Unit{"kgf", kKilogramForce, 5},
                                        Unit{"gf", 1e-3 * kKilogramForce, 6}};
inline constexpr std::array kTorqueUnits{Unit{"Nm", 1.0, 3},
                                         Unit{"N-m", 1.0, 3},
                                         Unit{"Nmm", 1e-3, 4},
                                         Unit{"N-mm", 1e-3, 4},
                                         Unit{"kN-m", 1e3, 6},
                                         Unit{"lbf-in", kPoundForce* kInch, 1},
                                         Unit{"lbf-ft", kPoundForce* kFoot, 2},
                                         Unit{"kNm", 1e3, 6},
                                         Unit{"kgf-cm", 1e-2 * kKilogramForce, 5}};

/// Rate of the sensor's own samples, independent of the rate of the records [1/s].
inline constexpr int kSampleRate = 7000;
/// Serial number of the transducer on the pages.
inline constexpr std::string_view kSerialNumber = "FT00001";

/// The sensor's own calibration and range.
struct Calibration {
    Unit force_unit{"N", 1.0, 2};
    Unit torque_unit{"Nm", 1.0, 3};
    double counts_per_force = 1e6;   ///< per force unit
    double counts_per_torque = 1e6;  ///< per torque unit
    /// Beyond it a gauge is saturated [N], [Nm]. Of a Gamma SI-65-5.
    std::array<double, 6> range{65.0, 65.0, 200.0, 5.0, 5.0, 5.0};
    double force_noise = 0.0;   ///< standard deviation [N]
    double torque_noise = 0.0;  ///< [Nm]
};

/// Turns a load into counts and a status word.
///
/// Threading: one thread.
class Sensor {
public:
    explicit Sensor(const Calibration& calibration) : calibration_(calibration) {}

    struct Reading {
        std::array<std::int32_t, 6> counts{};
        std::uint32_t status = 0;
    };
    Reading read(const motion::Wrench& load);

    /// The last load becomes zero.
    void setBias() noexcept { bias_ = last_; }
    /// Bias of each gauge for the pages, -32768 to 32767. A real sensor has six gauges that a
    /// matrix maps to the axes; here each axis has one gauge, with 32767 at the end of its range.
    std::array<int, 6> gaugeBias() const noexcept;
    void setGaugeBias(std::size_t gauge, int bias) noexcept;
    /// Ends a warning of the monitor condition.
    void resetLatch() noexcept;
    /// The status word of its own, until another one is set.
    void setStatus(std::uint32_t status) noexcept { status_ = status; }

    const Calibration& calibration() const noexcept { return calibration_; }

private:
    Calibration calibration_;
    std::array<double, 6> last_{};  // last wrench with its noise [N], [Nm]
    std::array<double, 6> bias_{};
    std::uint32_t status_ = status::kHealthy;
    std::mt19937 random_{1};
    std::normal_distribution<double> normal_;
};

}  // namespace metier::virtual_netft
