#pragma once

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "metier/skill/skill.hpp"

namespace metier::composition {

/// Knowledge, before a run, of the moment between two of its steps.
struct Forecast {
    /// Arms that earlier steps have moved, by the address of their server; no values: not known.
    skill::ArmPositions arms{};
    /// Addresses of servers whose skills earlier steps have used; skill::kEveryOtherArm for those
    /// that a composed skill may have used.
    std::set<std::string, std::less<>> used{};

    /// Place of the arm of a server; nothing: where it stands now; no values: not known.
    std::optional<std::vector<double>> place(std::string_view server) const;
    /// Whether the place of an arm is not known.
    bool isLost(std::string_view server) const;
    /// Whether the place of any arm is not known.
    bool anyLost() const;
    /// Notes that a skill has moved these arms.
    void move(const skill::ArmPositions& ends);
    /// Notes that the arm of that server may be anywhere now.
    void lose(std::string_view server) { arms.insert_or_assign(std::string(server), kNowhere); }

private:
    static inline const std::vector<double> kNowhere{};
};

/// Whether all arms stand at the same places, to rounding.
bool samePlaces(const Forecast& a, const Forecast& b);
/// Joins the forecasts after two ways, of which one is taken, and it is not known which.
Forecast either(const Forecast& a, const Forecast& b);
/// Joins the forecasts after two ways that both begin at `begin`.
Forecast both(const Forecast& begin, const Forecast& a, const Forecast& b);

}  // namespace metier::composition
