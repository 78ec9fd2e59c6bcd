#include "candidate.hpp"

#include <fmt/format.h>

#include <string_view>

namespace metier::app {
namespace {

struct Figure {
    std::string_view name;
    std::string_view unit;
};

void judgeOne(const Figure& figure, std::optional<double> wish, const ToldFigure& told,
              Verdict& verdict) {
    if (!wish) {
        return;
    }
    const auto note = told.note.empty() ? "" : fmt::format(" ({})", told.note);
    if (!told.value) {
        verdict.fits = false;
        verdict.reasons.push_back(fmt::format("{} unknown{}", figure.name, note));
        return;
    }
    const bool enough = *told.value >= *wish;
    verdict.fits = verdict.fits && enough;
    verdict.reasons.push_back(fmt::format("{} {:.3g} {} {} {:.3g} {}{}", figure.name, *told.value,
                                          figure.unit, enough ? ">=" : "<", *wish, figure.unit,
                                          note));
}

}  // namespace

Verdict judge(const ArmWishes& wishes, const ToldFigures& figures) {
    Verdict verdict;
    judgeOne({"reach", "m"}, wishes.reach, figures.reach, verdict);
    judgeOne({"payload", "kg"}, wishes.payload, figures.payload, verdict);
    return verdict;
}

}  // namespace metier::app
