#include "candidate.hpp"

#include <fmt/format.h>

#include <string_view>

namespace metier::app {
namespace {

struct Figure {
    std::string_view name;
    std::string_view unit;
};

void judgeOne(const Figure& figure, std::optional<double> wish, std::optional<double> value,
              Verdict& verdict) {
    if (!wish) {
        return;
    }
    if (!value) {
        verdict.fits = false;
        verdict.reasons.push_back(fmt::format("{} unknown", figure.name));
        return;
    }
    const bool enough = *value >= *wish;
    verdict.fits = verdict.fits && enough;
    verdict.reasons.push_back(fmt::format("{} {:.3g} {} {} {:.3g} {}", figure.name, *value,
                                          figure.unit, enough ? ">=" : "<", *wish, figure.unit));
}

}  // namespace

Verdict judge(const ArmWishes& wishes, std::optional<double> reach, std::optional<double> payload) {
    Verdict verdict;
    judgeOne({"reach", "m"}, wishes.reach, reach, verdict);
    judgeOne({"payload", "kg"}, wishes.payload, payload, verdict);
    return verdict;
}

}  // namespace metier::app
