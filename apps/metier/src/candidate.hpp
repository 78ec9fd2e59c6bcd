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

/// A figure of an arm, and how it is known.
struct ToldFigure {
    std::optional<double> value{};
    /// Who told it, or why nobody does: "of iiwa, opc.tcp://..."; empty: the skill's own server.
    std::string note;
};

struct ToldFigures {
    ToldFigure reach;    ///< [m]
    ToldFigure payload;  ///< [kg]
};

struct Verdict {
    bool fits = true;
    /// One for each wish: "reach 0.85 m >= 0.5 m", with the note in brackets.
    std::vector<std::string> reasons;
};

/// Whether an arm is as wished. What is unknown does not fit.
Verdict judge(const ArmWishes& wishes, const ToldFigures& figures);

}  // namespace metier::app
