#include "calibration.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cctype>
#include <pugixml.hpp>
#include <span>
#include <vector>

#include "metier/base/text.hpp"

namespace metier::netft_driver {
namespace {

struct Unit {
    std::string_view name;  // in lower case, without hyphens
    double si;
};

constexpr double kPoundForce = 4.4482216152605;
constexpr double kKilogramForce = 9.80665;
constexpr double kInch = 0.0254;
constexpr double kFoot = 0.3048;
constexpr double kLargestCounts = 1e12;
constexpr double kHighestRate = 1e5;  // [1/s]
constexpr std::size_t kLongestShown = 32;

constexpr std::array kForceUnits{Unit{"n", 1.0},
                                 Unit{"kn", 1e3},
                                 Unit{"lbf", kPoundForce},
                                 Unit{"klbf", 1e3 * kPoundForce},
                                 Unit{"kgf", kKilogramForce},
                                 Unit{"gf", 1e-3 * kKilogramForce}};
constexpr std::array kTorqueUnits{
    Unit{"nm", 1.0},
    Unit{"nmm", 1e-3},
    Unit{"knm", 1e3},
    Unit{"lbfin", kPoundForce* kInch},
    Unit{"lbfft", kPoundForce* kFoot},
    Unit{"kgfcm", 1e-2 * kKilogramForce},
};

std::string plain(std::string_view text) {
    auto result = inLowerCase(text);
    std::erase_if(result, [](unsigned char letter) { return std::isalnum(letter) == 0; });
    return result;
}

Result<double> unitIn(std::span<const Unit> units, std::string_view text, std::string_view what) {
    const auto wanted = plain(text);
    std::vector<std::string_view> known;
    for (const auto& unit : units) {
        if (unit.name == wanted) {
            return unit.si;
        }
        known.push_back(unit.name);
    }
    return fail(Errc::invalid_argument,
                fmt::format("unknown {} unit '{}'; known are {}", what,
                            text.substr(0, kLongestShown), fmt::join(known, ", ")));
}

/// The first of the elements that is there and not empty, anywhere on the page.
std::string textOf(const pugi::xml_document& page, std::span<const char* const> names) {
    for (const auto* name : names) {
        const auto node = page.find_node(
            [&](const pugi::xml_node& n) { return n.name() == std::string_view(name); });
        if (const auto text = trimmed(node.text().get()); !text.empty()) {
            return std::string(text);
        }
    }
    return {};
}

/// Name of each value on the newer and on the older page.
constexpr std::array kForceCounts{"cfgcpf", "calcpf"};
constexpr std::array kTorqueCounts{"cfgcpt", "calcpt"};
constexpr std::array kForceUnit{"scfgfu", "scalfu"};
constexpr std::array kTorqueUnit{"scfgtu", "scaltu"};
constexpr std::array kRdt{"comrdte"};
constexpr std::array kRate{"comrdtrate", "commrdtrate"};

Result<double> countsOf(const pugi::xml_document& page, std::span<const char* const> names) {
    const auto text = textOf(page, names);
    const auto counts = numberIn<double>(text);
    if (counts && *counts > 0.0 && *counts <= kLargestCounts) {
        return *counts;
    }
    return fail(Errc::invalid_argument,
                fmt::format("calibration: {} is '{}', expected counts per unit", names.front(),
                            text.substr(0, kLongestShown)));
}

Result<double> unitOf(const std::string& told, const std::string& fallback,
                      Result<double> (*parse)(std::string_view), std::string_view what) {
    const auto& text = told.empty() ? fallback : told;
    if (text.empty()) {
        return fail(Errc::invalid_argument,
                    fmt::format("calibration: no unit of {}; give it by the setting {}_unit, or "
                                "give counts_per_force and counts_per_torque",
                                what, what));
    }
    return parse(text);
}

Result<void> load(pugi::xml_document& document, std::string_view page) {
    if (const auto parsed = document.load_buffer(page.data(), page.size()); !parsed) {
        return fail(Errc::invalid_argument,
                    fmt::format("calibration: not XML: {}", parsed.description()));
    }
    return {};
}

}  // namespace

Result<double> forceUnit(std::string_view text) {
    return unitIn(kForceUnits, text, "force");
}

Result<double> torqueUnit(std::string_view text) {
    return unitIn(kTorqueUnits, text, "torque");
}

Result<Calibration> parseCalibration(std::string_view page, const UnitTexts& fallback) {
    pugi::xml_document document;
    METIER_TRY(load(document, page));
    METIER_ASSIGN(const auto force_counts, countsOf(document, kForceCounts));
    METIER_ASSIGN(const auto torque_counts, countsOf(document, kTorqueCounts));
    METIER_ASSIGN(const auto force,
                  unitOf(textOf(document, kForceUnit), fallback.force, forceUnit, "force"));
    METIER_ASSIGN(const auto torque,
                  unitOf(textOf(document, kTorqueUnit), fallback.torque, torqueUnit, "torque"));
    return Calibration{force / force_counts, torque / torque_counts};
}

Result<std::optional<double>> parseRate(std::string_view page) {
    pugi::xml_document document;
    METIER_TRY(load(document, page));
    const auto rdt = textOf(document, kRdt);
    if (!rdt.empty() && plain(rdt) != "enabled" && rdt != "1") {
        return fail(Errc::device_fault,
                    fmt::format("RDT is not enabled on the sensor's page of communication: comrdte "
                                "is '{}', expected Enabled",
                                rdt.substr(0, kLongestShown)));
    }
    const auto text = textOf(document, kRate);
    if (text.empty()) {
        return std::nullopt;
    }
    const auto rate = numberIn<double>(text);
    if (rate && *rate >= 1.0 && *rate <= kHighestRate) {
        return rate;
    }
    return fail(Errc::invalid_argument,
                fmt::format("{} is '{}', expected records per second, 1 to {}", kRate.front(),
                            text.substr(0, kLongestShown), kHighestRate));
}

}  // namespace metier::netft_driver
