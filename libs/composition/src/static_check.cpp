#include "static_check.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string_view>

namespace metier::composition {

namespace {

using Names = std::set<std::string, std::less<>>;

/// All conditions of a step, with those within them.
template <typename Visit>
void forEachComparison(const Condition& condition, const Visit& visit) {
    if (condition.parts.empty()) {
        visit(condition);
    }
    for (const auto& part : condition.parts) {
        forEachComparison(part, visit);
    }
}

Names intersection(const Names& a, const Names& b) {
    Names both;
    std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::inserter(both, both.end()),
                          std::less<>{});
    return both;
}

Names aliasesOf(const Step& step) {
    Names aliases;
    forEachCall(step, [&](const Step& call) { aliases.insert(call.use); });
    return aliases;
}

class Check {
public:
    explicit Check(const Definition& definition) : definition_(definition) {
        for (const auto& parameter : definition.parameters) {
            parameters_.emplace(parameter.field.name, &parameter.field);
        }
        for (const auto& use : definition.uses) {
            aliases_.insert(use.alias);
        }
    }

    Problems run() {
        collectNames(definition_.root);
        const auto known = after(definition_.root, {});
        for (const auto& result : definition_.results) {
            const auto& reference = std::get<Reference>(result.from.source);
            if (reference.step != kExecution) {
                checkReference(reference, {result.line, result.from.key, ""}, known);
            }
        }
        const auto used = aliasesOf(definition_.root);
        for (const auto& use : definition_.uses) {
            if (!used.contains(use.alias)) {
                note(use.line, "uses." + use.alias, "no step runs it");
            }
        }
        return std::move(problems_);
    }

private:
    void note(std::uint32_t line, std::string key, std::string why) {
        problems_.push_back({line, std::move(key), std::move(why)});
    }

    void collectNames(const Step& step) {
        if (step.name == kExecution) {
            note(step.line, step.key + ".name",
                 fmt::format("\"{}\" stands for the execution itself", kExecution));
        }
        checkBackground(step);
        if (!step.name.empty() && !steps_.emplace(step.name, &step).second) {
            note(step.line, step.key + ".name",
                 fmt::format("\"{}\" is the name of the step at line {}, too", step.name,
                             steps_.at(step.name)->line));
        }
        for (const auto* steps : {&step.steps, &step.otherwise}) {
            for (const auto& inner : *steps) {
                collectNames(inner);
            }
        }
    }

    /// Only beside others of a parallel that waits for all can a step be in the background.
    void checkBackground(const Step& step) {
        const auto in_background =
            std::count_if(step.steps.begin(), step.steps.end(),
                          [](const Step& inner) { return inner.background; });
        const auto all = static_cast<std::ptrdiff_t>(step.steps.size());
        const bool possible =
            step.kind == StepKind::parallel && step.wait_for == WaitFor::all && in_background < all;
        for (const auto* steps : {&step.steps, &step.otherwise}) {
            for (const auto& inner : *steps) {
                if (inner.background && !possible) {
                    note(inner.line, inner.key + ".background",
                         "is for some of the steps of a parallel that waits for all");
                }
            }
        }
    }

    /// The calls that have certainly finished once the step has, if those of `known` had before.
    Names after(const Step& step, Names known) {
        switch (step.kind) {
            case StepKind::call:
                return afterCall(step, std::move(known));
            case StepKind::sequence:
                return afterAll(step.steps, std::move(known));
            case StepKind::parallel:
                return afterParallel(step, known);
            case StepKind::fallback:
                return afterOneOf(step.steps, known);
            case StepKind::choice: {
                checkCondition(*step.condition, known);
                const auto then = afterAll(step.steps, known);
                return intersection(then, afterAll(step.otherwise, known));
            }
            case StepKind::loop:
                return afterLoop(step, known);
            case StepKind::failure:
                return all();  // nothing comes after it
        }
        return known;
    }

    Names all() const {
        Names names;
        for (const auto& [name, step] : steps_) {
            names.insert(name);
        }
        return names;
    }

    Names afterCall(const Step& step, Names known) {
        if (!step.use.empty() && !aliases_.contains(step.use)) {
            note(
                step.line, step.key + ".run",
                fmt::format("\"{}\" is not among [uses]: {}", step.use, fmt::join(aliases_, ", ")));
        }
        for (const auto& argument : step.arguments) {
            checkBinding(argument.value, known);
        }
        known.insert(step.name);
        return known;
    }

    Names afterAll(const std::vector<Step>& steps, Names known) {
        for (const auto& step : steps) {
            known = after(step, std::move(known));
        }
        return known;
    }

    Names afterOneOf(const std::vector<Step>& steps, const Names& known) {
        std::optional<Names> common;
        for (const auto& step : steps) {
            auto one = after(step, known);
            common = common ? intersection(*common, one) : std::move(one);
        }
        return common.value_or(known);
    }

    Names afterParallel(const Step& step, const Names& known) {
        checkBranches(step);
        if (step.wait_for == WaitFor::any) {
            return afterOneOf(step.steps, known);
        }
        Names all = known;
        for (const auto& branch : step.steps) {
            auto finished = after(branch, known);
            if (!branch.background) {
                all.merge(finished);
            }
        }
        return all;
    }

    void checkBranches(const Step& step) {
        std::map<std::string, std::string> branch_of;
        for (const auto& branch : step.steps) {
            for (const auto& alias : aliasesOf(branch)) {
                const auto [other, first] = branch_of.emplace(alias, branch.name);
                if (!first) {
                    note(branch.line, branch.key,
                         fmt::format("\"{}\" would run at the same time in \"{}\" and \"{}\"",
                                     alias, other->second, branch.name));
                }
            }
        }
    }

    Names afterLoop(const Step& step, const Names& known) {
        checkBound(step);
        if (step.times) {
            checkBinding(*step.times, known);
        }
        if (step.condition) {
            checkCondition(*step.condition, known);
        }
        auto within = afterAll(step.steps, known);
        if (step.until) {
            checkCondition(*step.until, within);
        }
        return runsAtLeastOnce(step) ? within : known;
    }

    /// Every loop ends: it has a number of rounds, or a most.
    void checkBound(const Step& step) {
        if (step.at_most) {
            return;
        }
        if (!step.times) {
            note(step.line, step.key + ".at_most",
                 "missing; a loop without times needs the most rounds that it may take");
            return;
        }
        const auto* reference = std::get_if<Reference>(&step.times->source);
        const auto* field = reference == nullptr ? nullptr : parameter(*reference);
        if (reference != nullptr && (field == nullptr || !field->range)) {
            note(step.times->line, step.times->key,
                 "has no range, so the loop needs at_most, the most rounds that it may take");
        }
    }

    bool runsAtLeastOnce(const Step& step) const {
        if (step.condition) {
            return false;
        }
        const auto* reference = step.times ? std::get_if<Reference>(&step.times->source) : nullptr;
        if (reference == nullptr) {
            return true;
        }
        const auto* field = parameter(*reference);
        return field != nullptr && field->range && field->range->low >= 1.0;
    }

    const skill::Field* parameter(const Reference& reference) const {
        const auto found =
            reference.step.empty() ? parameters_.find(reference.name) : parameters_.end();
        return found == parameters_.end() ? nullptr : found->second;
    }

    void checkCondition(const Condition& condition, const Names& known) {
        forEachComparison(condition, [&](const Condition& comparison) {
            checkReference(comparison.subject, {comparison.line, comparison.key + ".from", ""},
                           known);
            checkBinding(comparison.operand, known);
        });
    }

    void checkBinding(const Binding& binding, const Names& known) {
        const Problem place{binding.line, binding.key, ""};
        if (const auto* reference = std::get_if<Reference>(&binding.source)) {
            checkReference(*reference, place, known);
        }
        if (const auto* terms = std::get_if<std::vector<Term>>(&binding.source)) {
            checkTerms(*terms, place, known);
        }
        checkTerms(binding.shift, place, known);
    }

    void checkTerms(const std::vector<Term>& terms, const Problem& place, const Names& known) {
        for (const auto& term : terms) {
            if (term.from) {
                checkReference(*term.from, place, known);
            }
        }
    }

    void checkReference(const Reference& reference, const Problem& place, const Names& known) {
        if (reference.name.empty()) {
            return;  // noted when it was read
        }
        if (reference.step.empty()) {
            checkParameter(reference, place);
            return;
        }
        const auto step = steps_.find(reference.step);
        if (step == steps_.end()) {
            note(place.line, place.key, fmt::format("there is no step \"{}\"", reference.step));
        } else if (step->second->kind != StepKind::call) {
            note(place.line, place.key,
                 fmt::format("step \"{}\" runs no skill, so it has no results", reference.step));
        } else if (!known.contains(reference.step)) {
            note(place.line, place.key,
                 fmt::format("the result of step \"{}\" (line {}) is not there yet on every way "
                             "to here",
                             reference.step, step->second->line));
        }
    }

    void checkParameter(const Reference& reference, const Problem& place) {
        if (parameter(reference) != nullptr) {
            return;
        }
        Names names;
        for (const auto& [name, field] : parameters_) {
            names.insert(name);
        }
        note(place.line, place.key,
             fmt::format("there is no parameter \"{}\"; there are: {}", reference.name,
                         fmt::join(names, ", ")));
    }

    const Definition& definition_;
    std::map<std::string, const skill::Field*, std::less<>> parameters_;
    std::map<std::string, const Step*, std::less<>> steps_;
    Names aliases_;
    Problems problems_;
};

}  // namespace

Problems checkDefinition(const Definition& definition) {
    return Check(definition).run();
}

}  // namespace metier::composition
