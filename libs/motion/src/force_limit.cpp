#include "metier/motion/force_limit.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace metier::motion {

namespace {

constexpr double kCutOff = 20.0;  // [Hz]
constexpr std::array kComponentNames{"force along x",  "force along y",  "force along z",
                                     "torque about x", "torque about y", "torque about z"};

using Components = std::array<double, 6>;
using Quantity = ForceExcess::Quantity;

Components componentsOf(const Wrench& wrench) noexcept {
    const auto& [f, t] = wrench;
    return {f.x(), f.y(), f.z(), t.x(), t.y(), t.z()};
}

bool beyond(double value, double limit) noexcept {
    return limit > 0 && std::abs(value) > limit;
}

bool isLimit(double value) noexcept {
    return std::isfinite(value) && value >= 0;
}

std::optional<ForceExcess> findNotFinite(const Components& measured) noexcept {
    for (std::size_t i = 0; i < measured.size(); ++i) {
        if (!std::isfinite(measured[i])) {
            return ForceExcess{Quantity::not_finite, i, measured[i], 0};
        }
    }
    return std::nullopt;
}

std::optional<ForceExcess> findExcess(const Wrench& wrench, const WrenchLimits& limits) noexcept {
    if (const double force = wrench.force.norm(); beyond(force, limits.force)) {
        return ForceExcess{Quantity::force, 0, force, limits.force};
    }
    if (const double torque = wrench.torque.norm(); beyond(torque, limits.torque)) {
        return ForceExcess{Quantity::torque, 0, torque, limits.torque};
    }
    const Components values = componentsOf(wrench);
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (beyond(values[i], limits.components[i])) {
            return ForceExcess{Quantity::component, i, values[i], limits.components[i]};
        }
    }
    return std::nullopt;
}

}  // namespace

Error toError(const ForceExcess& excess) {
    const bool of_component =
        excess.quantity == Quantity::component || excess.quantity == Quantity::not_finite;
    const bool torque = of_component ? excess.component >= 3 : excess.quantity == Quantity::torque;
    const std::string_view what = of_component ? kComponentNames.at(excess.component)
                                  : torque     ? "torque"
                                               : "force";
    if (excess.quantity == Quantity::not_finite) {
        return {Errc::device_fault, fmt::format("{}: not finite", what)};
    }
    const std::string_view unit = torque ? "Nm" : "N";
    return {Errc::out_of_range, fmt::format("{}: {:.2f} {} over limit {:.2f} {}", what,
                                            excess.value, unit, excess.limit, unit)};
}

Result<ForceLimit> ForceLimit::create(const WrenchLimits& limits, Seconds cycle) {
    const auto& [force, torque, components] = limits;
    if (!isLimit(force) || !isLimit(torque) ||
        !std::all_of(components.begin(), components.end(), isLimit)) {
        return fail(Errc::invalid_argument,
                    fmt::format("wrench limits: force {} N, torque {} Nm, components {}: one is "
                                "not a finite number >= 0",
                                force, torque, fmt::join(components, ", ")));
    }
    if (force == 0 && torque == 0 && components == Components{}) {
        return fail(Errc::invalid_argument, "no wrench limit is over 0");
    }
    if (!(cycle.count() > 0)) {
        return fail(Errc::invalid_argument, fmt::format("cycle {} s is not over 0", cycle.count()));
    }
    return ForceLimit(limits, 1 - std::exp(-2 * std::numbers::pi * kCutOff * cycle.count()));
}

std::optional<ForceExcess> ForceLimit::check(const Wrench& measured) noexcept {
    if (const auto broken = findNotFinite(componentsOf(measured))) {
        return broken;
    }
    const double gain = started_ ? gain_ : 1.0;
    filtered_.force += gain * (measured.force - filtered_.force);
    filtered_.torque += gain * (measured.torque - filtered_.torque);
    started_ = true;
    return findExcess(filtered_, limits_);
}

}  // namespace metier::motion
