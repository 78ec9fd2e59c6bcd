// Check of the steps that hold others: side by side, one of several, again and again.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "check/known.hpp"
#include "check/steps_check.hpp"
#include "rounds.hpp"

namespace metier::composition {

namespace {

constexpr std::uint64_t kMostRounds = 20;

std::string joined(const std::string& texts, const std::string& text) {
    return texts.empty() ? text : texts + "; " + text;
}

}  // namespace

// ---- several at the same time -------------------------------------------------------------------

void StepsCheck::branches(Visit visit, Findings findings, const Then& then) {
    const auto index = findings->size();
    if (index == visit.step.steps.size()) {
        then(visit.step.wait_for == WaitFor::all ? merged(visit, *findings)
                                                 : mergedAny(visit, *findings));
        return;
    }
    const auto& step = visit.step.steps[index];
    checkStep(step, visit.path, visit.before, [this, visit, findings, then](Finding found) {
        findings->push_back(std::move(found));
        branches(visit, findings, then);
    });
}

StepsCheck::Finding StepsCheck::merged(const Visit& visit, const std::vector<Finding>& findings) {
    Finding all{visit.before};
    for (std::size_t i = 0; i < findings.size(); ++i) {
        const auto& found = findings[i];
        if (found.refusal) {
            return {anyOf(visit.before, findings), found.refusal};
        }
        all.sure = all.sure && found.sure;
        if (visit.step.steps[i].background) {  // halted with the others, wherever it is
            all.after = both(visit.before, all.after, either(visit.before, found.after));
        } else {
            all.after = both(visit.before, all.after, found.after);
            all.duration = std::max(all.duration, found.duration);
        }
    }
    return all;
}

/// After branches that were halted, wherever they were.
Forecast StepsCheck::anyOf(Forecast before, const std::vector<Finding>& findings) {
    for (const auto& found : findings) {
        before = either(before, found.after);
    }
    return before;
}

/// The first branch that succeeds ends the others.
StepsCheck::Finding StepsCheck::mergedAny(const Visit& visit,
                                          const std::vector<Finding>& findings) {
    Finding any{.after = anyOf(visit.before, findings), .sure = false};
    std::string refusals;
    std::optional<double> shortest;
    for (const auto& found : findings) {
        if (found.refusal) {
            refusals = joined(refusals, found.refusal->text);
        } else {
            shortest = std::min(shortest.value_or(found.duration), found.duration);
            any.sure = any.sure || found.sure;
        }
    }
    if (!shortest) {
        any.refusal = impossible(visit, "no branch can be done: " + refusals).refusal;
    } else if (!refusals.empty()) {
        note(refusals);
    }
    any.duration = shortest.value_or(0.0);
    return any;
}

// ---- one of several -----------------------------------------------------------------------------

/// The next one begins where the one before could not go on.
void StepsCheck::fallback(Visit visit, std::size_t index, std::string refusals, Then then) {
    if (index == visit.step.steps.size()) {
        then(impossible(visit, "nothing is left to try: " + refusals));
        return;
    }
    const auto& step = visit.step.steps[index];
    checkStep(step, visit.path, visit.before,
              [this, visit, index, refusals = std::move(refusals),
               then = std::move(then)](Finding found) {
                  if (found.refusal) {
                      auto next = visit;
                      next.before = std::move(found.after);
                      fallback(std::move(next), index + 1, joined(refusals, found.refusal->text),
                               then);
                      return;
                  }
                  if (!refusals.empty()) {
                      note(refusals);
                  }
                  if (found.sure || index + 1 == visit.step.steps.size()) {
                      then(std::move(found));
                      return;
                  }
                  alsoLater(visit, index + 1, std::move(found), then);
              });
}

/// Checks the alternatives of a fallback after one that may fail in the run.
void StepsCheck::alsoLater(Visit visit, std::size_t index, Finding found, Then then) {
    visit.before = either(visit.before, found.after);
    fallback(std::move(visit), index, "",
             [this, found = std::move(found), then = std::move(then)](const Finding& later) {
                 if (later.refusal) {
                     note(later.refusal->text);
                     then(found);
                     return;
                 }
                 then({.after = either(found.after, later.after),
                       .duration = std::max(found.duration, later.duration),
                       .sure = later.sure});
             });
}

void StepsCheck::choice(Visit visit, const Then& then) {
    const auto& condition = *visit.step.condition;
    if (const auto result = resultIn(condition)) {
        note(fmt::format("{}: its branch depends on {}, which is not known before the run",
                         describe(visit), *result));
        eitherBranch(std::move(visit), then);
        return;
    }
    const auto held = scope_.holds(condition);
    if (!held) {
        then(impossible(visit, held.error().message));
        return;
    }
    inOrder(*held ? visit.step.steps : visit.step.otherwise, visit.path, {std::move(visit.before)},
            then);
}

void StepsCheck::eitherBranch(Visit visit, const Then& then) {
    inOrder(visit.step.steps, visit.path, {visit.before}, [this, visit, then](Finding one) {
        inOrder(visit.step.otherwise, visit.path, {visit.before},
                [this, one = std::move(one), then](Finding other) mutable {
                    then(oneOf(std::move(one), std::move(other)));
                });
    });
}

/// The common finding of two branches: the run will take one of them.
StepsCheck::Finding StepsCheck::oneOf(Finding one, Finding other) {
    if (!one.refusal && !other.refusal) {
        return {.after = either(one.after, other.after),
                .duration = std::max(one.duration, other.duration),
                .sure = one.sure && other.sure};
    }
    if (!one.refusal || !other.refusal) {
        note(one.refusal ? one.refusal->text : other.refusal->text);
    }
    auto found = other.refusal ? std::move(one) : std::move(other);
    found.sure = false;
    return found;
}

// ---- again and again ----------------------------------------------------------------------------

Result<StepsCheck::Rounds> StepsCheck::roundsOf(const Step& step) const {
    Rounds rounds{step.at_most.value_or(kMostRounds)};
    if (step.times && resultIn(*step.times)) {
        rounds.needed = false;
    } else if (step.times) {
        METIER_ASSIGN(const auto times, scope_.number(*step.times));
        METIER_ASSIGN(const auto whole, wholeRounds(times));
        rounds = {whole, true};
    }
    bool may_end = step.until.has_value();  // before `times` or `at_most`
    if (step.condition && resultIn(*step.condition)) {
        rounds.known = rounds.needed = false;
        may_end = true;
    } else if (step.condition) {
        METIER_ASSIGN(const auto held, scope_.holds(*step.condition));
        if (!held) {
            return Rounds{0, true};
        }
    }
    if (step.at_most) {
        const bool too_many = !step.times || (rounds.known && rounds.most > *step.at_most);
        if (too_many && !may_end) {
            return fail(Errc::out_of_range, fmt::format("not done after {} rounds", *step.at_most));
        }
        rounds.most = std::min<std::uint64_t>(rounds.most, *step.at_most);
    }
    rounds.known = rounds.known && !step.until;
    return rounds;
}

void StepsCheck::loop(Visit visit, const Then& then) {
    const auto rounds = roundsOf(visit.step);
    if (!rounds) {
        then(impossible(visit, rounds.error().message));
        return;
    }
    if (!rounds->known) {
        note(fmt::format("{}: how often it is repeated is not known before the run",
                         describe(visit)));
    }
    auto before = visit.before;
    round(std::move(visit), *rounds, {std::move(before)}, then);
}

/// Ends with the first round that begins where the one before began: all others are as that one.
void StepsCheck::round(Visit visit, Rounds rounds, Finding so_far, Then then) {
    // A second round shows where an unknown number of rounds leads to.
    const auto most = rounds.known ? rounds.most : std::min<std::uint64_t>(rounds.most, 2);
    if (rounds.number > most || so_far.refusal) {
        then(std::move(so_far));
        return;
    }
    if (rounds.number > kMostRounds) {
        note(fmt::format("{}: rounds after the first {} are not checked", describe(visit),
                         kMostRounds));
        so_far.after.move({{std::string(skill::kEveryOtherArm), {}}});
        then(std::move(so_far));
        return;
    }
    const auto path = fmt::format("{}[{}]", visit.path, rounds.number);
    const auto& steps = visit.step.steps;
    inOrder(steps, path, {so_far.after}, [this, visit, rounds, most, so_far, then](Finding found) {
        const bool maybe = !rounds.known && (rounds.number > 1 || !rounds.needed);
        const bool sure = so_far.sure && found.sure;
        if (maybe && found.refusal) {
            note(found.refusal->text);
            then({.after = so_far.after, .duration = so_far.duration, .sure = false});
            return;
        }
        if (maybe) {
            then({.after = either(so_far.after, found.after),
                  .duration = so_far.duration,
                  .sure = sure});
            return;
        }
        found.sure = sure;
        const bool settled = samePlaces(so_far.after, found.after);
        const auto equal_rounds = settled && rounds.known ? most - rounds.number + 1 : 1;
        found.duration = so_far.duration + found.duration * static_cast<double>(equal_rounds);
        if (settled || found.refusal) {
            then(std::move(found));
            return;
        }
        auto next = rounds;
        ++next.number;
        round(visit, next, std::move(found), then);
    });
}

}  // namespace metier::composition
