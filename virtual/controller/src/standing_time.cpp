#include "metier/virtual_controller/standing_time.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace metier::virtual_controller {

namespace {

// A device that has been standing for so long begins a new motion when it moves again.
constexpr std::chrono::milliseconds kAtRest{200};

bool away(std::span<const double> from, std::span<const double> to) {
    return !std::equal(from.begin(), from.end(), to.begin(), to.end(), [](double a, double b) {
        return std::abs(a - b) < StandingTime::kNoMotion;
    });
}

}  // namespace

void StandingTime::take(std::span<const double> position, SteadyTime now) {
    const bool first = place_.empty();
    if (!first) {
        longest_cycle_ = std::max<std::chrono::duration<double>>(longest_cycle_, now - last_);
    }
    last_ = now;
    if (first || away(place_, position)) {
        if (!moving_) {
            longest_cycle_ = {};
        }
        moving_ = !first;
        place_.assign(position.begin(), position.end());
        moved_ = now;
    } else if (now - moved_ > kAtRest) {
        moving_ = false;
    }
}

std::chrono::duration<double> StandingTime::standing(SteadyTime now) const {
    return place_.empty() ? std::chrono::duration<double>() : now - moved_;
}

void StandingTime::show(nlohmann::ordered_json& state, SteadyTime now) const {
    state["standing_for"] = standing(now).count();
    state["longest_cycle"] = longest_cycle_.count();
}

}  // namespace metier::virtual_controller
