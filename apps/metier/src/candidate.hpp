#pragma once

#include <optional>
#include <string>
#include <vector>

namespace metier::app {

/// What a skill's arm is to be able to do.
struct ArmWishes {
    std::optional<double> reach{};    ///< at least [m]
    std::optional<double> payload{};  ///< at least [kg]
};

struct Verdict {
    bool fits = true;
    std::vector<std::string> reasons;  ///< one for each wish: "reach 0.85 m >= 0.5 m"
};

/// Whether an arm of that reach [m] and payload [kg] is as wished. What is unknown does not fit.
Verdict judge(const ArmWishes& wishes, std::optional<double> reach, std::optional<double> payload);

}  // namespace metier::app
