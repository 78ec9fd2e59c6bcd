#include "check/forecast.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace metier::composition {

namespace {

using Place = std::optional<std::vector<double>>;
using Servers = std::set<std::string, std::less<>>;

constexpr double kSamePlace = 1e-6;  // [rad], far below what an arm can resolve

bool same(const Place& a, const Place& b) {
    if (!a || !b) {
        return a.has_value() == b.has_value();
    }
    return std::equal(a->begin(), a->end(), b->begin(), b->end(),
                      [](double one, double other) { return std::abs(one - other) <= kSamePlace; });
}

/// The arms that either names; the one that stands for all others comes first.
Servers armsOf(const Forecast& a, const Forecast& b) {
    Servers servers;
    for (const auto* forecast : {&a, &b}) {
        for (const auto& [server, place] : forecast->arms) {
            servers.insert(server);
        }
    }
    return servers;
}

Forecast withServersOf(const Forecast& a, const Forecast& b) {
    Forecast merged;
    merged.used = a.used;
    merged.used.insert(b.used.begin(), b.used.end());
    return merged;
}

void put(Forecast& forecast, const std::string& server, Place place) {
    if (place) {
        forecast.arms.insert_or_assign(server, std::move(*place));
    }
}

}  // namespace

Place Forecast::place(std::string_view server) const {
    auto found = arms.find(server);
    if (found == arms.end()) {
        found = arms.find(skill::kEveryOtherArm);
    }
    return found == arms.end() ? Place() : Place(found->second);
}

bool Forecast::isLost(std::string_view server) const {
    const auto now = place(server);
    return now && now->empty();
}

bool Forecast::anyLost() const {
    return std::any_of(arms.begin(), arms.end(),
                       [](const auto& arm) { return arm.second.empty(); });
}

void Forecast::move(const skill::ArmPositions& ends) {
    if (ends.contains(skill::kEveryOtherArm)) {
        arms.clear();
    }
    for (const auto& [server, place] : ends) {
        arms.insert_or_assign(server, place);
    }
}

bool samePlaces(const Forecast& a, const Forecast& b) {
    const auto servers = armsOf(a, b);
    return std::all_of(servers.begin(), servers.end(), [&](const std::string& server) {
        return same(a.place(server), b.place(server));
    });
}

Forecast either(const Forecast& a, const Forecast& b) {
    auto merged = withServersOf(a, b);
    for (const auto& server : armsOf(a, b)) {
        auto place = a.place(server);
        put(merged, server,
            same(place, b.place(server)) ? std::move(place) : std::vector<double>());
    }
    return merged;
}

Forecast both(const Forecast& begin, const Forecast& a, const Forecast& b) {
    auto merged = withServersOf(a, b);
    for (const auto& server : armsOf(a, b)) {
        const auto before = begin.place(server);
        auto place = a.place(server);
        auto other = b.place(server);
        if (same(place, before)) {
            place = std::move(other);
        } else if (!same(other, before)) {
            place.emplace();
        }
        put(merged, server, std::move(place));
    }
    return merged;
}

}  // namespace metier::composition
