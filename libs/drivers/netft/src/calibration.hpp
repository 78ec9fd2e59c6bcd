#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "metier/base/error.hpp"

namespace metier::netft_driver {

/// Force and torque that one count stands for.
struct Calibration {
    double force_per_count = 0.0;   ///< [N]
    double torque_per_count = 0.0;  ///< [Nm]
};

/// Units as text, for pages that do not state them; empty: not known.
struct UnitTexts {
    std::string force{};
    std::string torque{};
};

/// A force unit in N, a torque unit in Nm: "lbf" gives 4.448. Upper and lower case, blanks and
/// hyphens do not matter.
/// Errors: invalid_argument for an unknown one, naming those that are known.
Result<double> forceUnit(std::string_view text);
Result<double> torqueUnit(std::string_view text);

/// Reads the page netftapi2.xml, or the older netftcalapi.xml.
/// \param fallback units to use if the page does not state them
/// Errors: invalid_argument if it is no such page, counts are missing or not positive, or a unit is
///         unknown or missing: nothing is guessed.
Result<Calibration> parseCalibration(std::string_view page, const UnitTexts& fallback);

/// The records per second that the page says the sensor sends; nothing if it does not say.
/// Errors: invalid_argument if it is no XML or the rate is no such number; device_fault if the page
///         says that the sensor sends none.
Result<std::optional<double>> parseRate(std::string_view page);

}  // namespace metier::netft_driver
