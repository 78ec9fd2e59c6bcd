#include "check/steps_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "activity.hpp"
#include "check/known.hpp"

namespace metier::composition {

using skill::CheckReport;
using skill::State;

namespace {

// More would keep used servers busy for long.
constexpr std::size_t kMostQuestions = 200;
constexpr std::size_t kMostNotes = 100;

/// Whether a refusal of that kind depends only on the parameters and on where the arms stand. All
/// others may be gone when the step begins.
bool isLasting(std::string_view code) {
    constexpr std::array kLasting{Errc::invalid_argument, Errc::type_mismatch, Errc::out_of_range,
                                  Errc::unreachable,      Errc::not_found,     Errc::not_supported,
                                  Errc::limit_violated};
    return std::any_of(kLasting.begin(), kLasting.end(),
                       [&](Errc lasting) { return toString(lasting) == code; });
}

/// Places that a used skill is given: those of all arms if it runs skills of others, else that of
/// its own arm. A server that does not report where its arms end takes none: it is given none.
skill::ArmPositions startsFor(const UsedSkill& used, const Forecast& before) {
    skill::ArmPositions starts;
    for (const auto& [server, place] : before.arms) {
        const bool its_own = server == used.serverUrl();
        if (!place.empty() && (its_own || used.runsOthers())) {
            starts.emplace(server, place);
        }
    }
    return starts;
}

/// Whether all that its answer depends on is known.
bool isCertain(const UsedSkill& used, const CheckReport& report, const Forecast& before) {
    const bool placed = used.runsOthers() ? !before.anyLost() : !before.isLost(used.serverUrl());
    if (report.code.empty()) {
        const bool touched = used.runsOthers() ? !before.used.empty()
                                               : before.used.contains(used.serverUrl()) ||
                                                     before.used.contains(skill::kEveryOtherArm);
        return placed && !touched;
    }
    return placed && isLasting(report.code);
}

/// Notes that an earlier step has used a skill, and with it maybe those of any server.
void noteUse(const UsedSkill& used, Forecast& forecast) {
    forecast.used.insert(used.serverUrl());
    if (used.runsOthers()) {
        forecast.used.insert(std::string(skill::kEveryOtherArm));
    }
}

/// Something of the used skill may have moved, and nobody says where it is.
void lose(const UsedSkill& used, Forecast& forecast) {
    noteUse(used, forecast);
    if (used.runsOthers()) {
        forecast.move({{std::string(skill::kEveryOtherArm), {}}});
    } else {
        forecast.lose(used.serverUrl());
    }
}

}  // namespace

StepsCheck::StepsCheck(Setup setup, skill::ValueMap parameters, const skill::ArmPositions& starts)
    : setup_(setup), scope_(std::move(parameters)) {
    begin_.move(starts);
}

StepsCheck::~StepsCheck() {
    *alive_ = false;
}

void StepsCheck::start(std::chrono::nanoseconds longest, skill::CheckDone done) {
    done_ = std::move(done);
    limit_ = setup_.executor.after(longest, [this, longest] {
        giveUp(fmt::format("the used skills have not all answered within {} s",
                           std::chrono::duration<double>(longest).count()));
    });
    inOrder(setup_.composition.definition.root.steps, "", {begin_}, [this](Finding found) {
        CheckReport report{.planned_duration = found.duration, .notes = std::move(notes_)};
        if (found.refusal) {
            report.possible = false;
            report.reason = std::move(found.refusal->text);
            report.code = std::move(found.refusal->code);
            report.first_failing_fraction = found.refusal->fraction;
            report.planned_duration = 0.0;
        } else {
            report.ends = std::move(found.after.arms);
            report.ends_known = true;
        }
        finish(std::move(report));
    });
}

void StepsCheck::giveUp(const std::string& why) {
    finish(fail(Errc::timeout, why));
}

void StepsCheck::finish(Result<CheckReport> report) {
    limit_.cancel();
    if (const auto done = std::exchange(done_, nullptr)) {
        done(std::move(report));
    }
}

void StepsCheck::note(std::string text) {
    const bool known = std::find(notes_.begin(), notes_.end(), text) != notes_.end();
    if (!known && notes_.size() < kMostNotes) {
        notes_.push_back(std::move(text));
    }
}

const UsedSkill& StepsCheck::usedBy(const Step& step) const {
    return *setup_.used.find(step.use)->second.skill;
}

std::string StepsCheck::describe(const Visit& visit) const {
    return visit.step.kind == StepKind::call
               ? fmt::format("step {}: {}", visit.path, usedBy(visit.step).name())
               : fmt::format("step {}", visit.path);
}

StepsCheck::Finding StepsCheck::impossible(const Visit& visit, const std::string& why) const {
    return {visit.before, Refusal{fmt::format("{}: {}", describe(visit), why),
                                  std::string(toString(Errc::invalid_argument))}};
}

void StepsCheck::checkStep(const Step& step, const std::string& above, Forecast before, Then then) {
    Visit visit{step, pathOf(above, step.name), std::move(before)};
    switch (step.kind) {
        case StepKind::call:
            return call(std::move(visit), then);
        case StepKind::sequence:
            return inOrder(step.steps, visit.path, {std::move(visit.before)}, std::move(then));
        case StepKind::parallel:
            return branches(std::move(visit), std::make_shared<std::vector<Finding>>(), then);
        case StepKind::fallback:
            return fallback(std::move(visit), 0, "", std::move(then));
        case StepKind::choice:
            return choice(std::move(visit), then);
        case StepKind::loop:
            return loop(std::move(visit), then);
        case StepKind::failure:
            return then(impossible(visit, step.text));
    }
}

void StepsCheck::inOrder(std::span<const Step> steps, const std::string& path, Finding so_far,
                         Then then) {
    if (steps.empty() || so_far.refusal) {
        then(std::move(so_far));
        return;
    }
    checkStep(steps.front(), path, std::move(so_far.after),
              [this, later = steps.subspan(1), path, before = so_far.duration, sure = so_far.sure,
               then = std::move(then)](Finding found) {
                  found.duration += before;
                  found.sure = found.sure && sure;
                  inOrder(later, path, std::move(found), then);
              });
}

void StepsCheck::call(Visit visit, const Then& then) {
    for (const auto& argument : visit.step.arguments) {
        if (const auto result = resultIn(argument.value)) {
            unchecked(std::move(visit),
                      fmt::format("{} comes from {}, which is not known before the run",
                                  argument.name, *result),
                      then);
            return;
        }
    }
    auto parameters = scope_.arguments(visit.step, usedBy(visit.step).description());
    if (!parameters) {
        then({std::move(visit.before),
              Refusal{fmt::format("{} {}", describe(visit), parameters.error().message),
                      std::string(toString(Errc::invalid_argument))}});
        return;
    }
    ask(std::move(visit), std::move(*parameters), then);
}

void StepsCheck::ask(Visit visit, skill::ValueMap parameters, Then then) {
    auto& used = *setup_.used.find(visit.step.use)->second.skill;
    if (const auto available = used.available(); !available) {
        unchecked(std::move(visit), "it cannot be reached: " + available.error().message, then);
    } else if (used.state() != State::ready) {
        unchecked(std::move(visit), fmt::format("it is {}", toString(used.state())), then);
    } else if (++questions_ > kMostQuestions) {
        unchecked(std::move(visit), fmt::format("only {} questions are asked", kMostQuestions),
                  then);
    } else {
        skill::CheckRequest request{std::move(parameters), startsFor(used, visit.before)};
        used.check(request, [this, alive = alive_, visit = std::move(visit),
                             then = std::move(then)](const Result<CheckReport>& report) {
            if (*alive && !over()) {
                answered(visit, report, then);
            }
        });
    }
}

void StepsCheck::answered(Visit visit, const Result<CheckReport>& report, const Then& then) {
    if (!report) {
        const auto& error = report.error();
        const bool no_check = error.code == Errc::not_supported;
        unchecked(std::move(visit), no_check ? "it has no Check" : error.message, then);
        return;
    }
    for (const auto& text : report->notes) {
        note(fmt::format("{}: {}", describe(visit), text));
    }
    if (!report->possible) {
        refused(std::move(visit), *report, then);
        return;
    }
    const auto& used = usedBy(visit.step);
    if (!report->ends_known) {
        lose(used, visit.before);
    }
    noteUse(used, visit.before);
    visit.before.move(report->ends);
    then({std::move(visit.before), {}, report->planned_duration});
}

void StepsCheck::refused(Visit visit, const CheckReport& report, const Then& then) {
    auto& used = usedBy(visit.step);
    if (isCertain(used, report, visit.before)) {
        then({std::move(visit.before),
              Refusal{fmt::format("{} cannot be done: {}", describe(visit), report.reason),
                      report.code, report.first_failing_fraction}});
        return;
    }
    note(fmt::format("{} is not possible now, and may be possible then: {}", describe(visit),
                     report.reason));
    if (!report.ends_known) {
        lose(used, visit.before);
    }
    noteUse(used, visit.before);
    then({.after = std::move(visit.before), .sure = false});
}

void StepsCheck::unchecked(Visit visit, const std::string& why, const Then& then) {
    note(fmt::format("{} is not checked: {}", describe(visit), why));
    lose(usedBy(visit.step), visit.before);
    then({.after = std::move(visit.before), .sure = false});
}

}  // namespace metier::composition
