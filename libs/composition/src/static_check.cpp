#include "static_check.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <unordered_set>
#include <utility>

namespace metier::composition {

namespace {

using Names = std::set<std::string, std::less<>>;

/// Calls that a step adds to those that have certainly finished.
struct Added {
    std::vector<std::string_view> names{};
    bool nothing_after = false;  ///< it always fails, so no step after it runs
};

/// Calls that both of them add.
Added intersection(Added a, Added b) {
    if (a.nothing_after || b.nothing_after) {
        return a.nothing_after ? std::move(b) : std::move(a);
    }
    const std::unordered_set<std::string_view> others(b.names.begin(), b.names.end());
    std::erase_if(a.names, [&](std::string_view name) { return !others.contains(name); });
    return a;
}

/// Adds the calls of `one` to `all`.
void append(Added& all, Added&& one) {
    all.names.insert(all.names.end(), one.names.begin(), one.names.end());
    all.nothing_after = all.nothing_after || one.nothing_after;
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
            if (use.optional) {
                optional_.insert(use.alias);
            }
        }
    }

    Problems run() {
        collectNames(definition_.root);
        after(definition_.root);
        for (const auto& result : definition_.results) {
            const auto& reference = std::get<Reference>(result.from.source);
            if (reference.step != kExecution) {
                checkReference(reference, {result.line, result.from.key, ""});
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
        checkOptional(step, step.steps);
        checkOptional(step, step.otherwise);
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

    bool isOptional(const Step& step) const {
        return step.kind == StepKind::call && optional_.contains(step.use);
    }

    /// Checks that something is left to do when optional steps are left out.
    void checkOptional(const Step& step, const std::vector<Step>& steps) {
        const bool possible = step.kind != StepKind::fallback && step.wait_for == WaitFor::all &&
                              std::any_of(steps.begin(), steps.end(), [this](const Step& inner) {
                                  return !isOptional(inner) && !inner.background;
                              });
        for (const auto& inner : steps) {
            if (isOptional(inner) && !possible) {
                note(inner.line, inner.key + ".run",
                     fmt::format("\"{}\" is optional: its step needs another one beside it that is "
                                 "always there, and is for no fallback and no wait_for = \"any\"",
                                 inner.use));
            }
        }
    }

    /// Whether that call has certainly finished at the step that is looked at.
    bool knows(std::string_view name) const { return dead_ends_ > 0 || known_.contains(name); }
    void take(const Added& added) {
        known_.insert(added.names.begin(), added.names.end());
        dead_ends_ += added.nothing_after ? 1 : 0;
    }
    void drop(const Added& added) {
        for (const auto& name : added.names) {
            known_.erase(name);
        }
        dead_ends_ -= added.nothing_after ? 1 : 0;
    }

    /// Calls that have certainly finished once the step has, besides the earlier ones. They are in
    /// known_ then.
    Added after(const Step& step) {
        switch (step.kind) {
            case StepKind::call:
                return afterCall(step);
            case StepKind::sequence:
                return afterAll(step.steps);
            case StepKind::parallel:
                return afterParallel(step);
            case StepKind::fallback:
                return afterOneOf(step.steps);
            case StepKind::choice:
                return afterChoice(step);
            case StepKind::loop:
                return afterLoop(step);
            case StepKind::failure:
                ++dead_ends_;
                return {{}, true};
        }
        return {};
    }

    Added afterCall(const Step& step) {
        if (!step.use.empty() && !aliases_.contains(step.use)) {
            note(
                step.line, step.key + ".run",
                fmt::format("\"{}\" is not among [uses]: {}", step.use, fmt::join(aliases_, ", ")));
        }
        for (const auto& argument : step.arguments) {
            checkBinding(argument.value);
        }
        if (isOptional(step)) {
            return {};
        }
        return known_.insert(step.name).second ? Added{{step.name}} : Added{};
    }

    Added afterAll(const std::vector<Step>& steps) {
        Added all;
        for (const auto& step : steps) {
            auto one = after(step);
            if (one.nothing_after && all.nothing_after) {
                --dead_ends_;  // counted once for all of them
            }
            append(all, std::move(one));
        }
        return all;
    }

    Added afterOneOf(const std::vector<Step>& steps) {
        std::optional<Added> common;
        for (const auto& step : steps) {
            auto one = after(step);
            drop(one);
            common = common ? intersection(std::move(*common), std::move(one)) : std::move(one);
        }
        auto both = std::move(common).value_or(Added{});
        take(both);
        return both;
    }

    Added afterChoice(const Step& step) {
        checkCondition(*step.condition);
        auto then = afterAll(step.steps);
        drop(then);
        auto otherwise = afterAll(step.otherwise);
        drop(otherwise);
        auto both = intersection(std::move(then), std::move(otherwise));
        take(both);
        return both;
    }

    Added afterParallel(const Step& step) {
        checkBranches(step);
        if (step.wait_for == WaitFor::any) {
            return afterOneOf(step.steps);
        }
        Added all;
        for (const auto& branch : step.steps) {
            auto finished = after(branch);
            drop(finished);
            if (!branch.background) {
                append(all, std::move(finished));
            }
        }
        take(all);
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

    Added afterLoop(const Step& step) {
        checkBound(step);
        if (step.times) {
            checkBinding(*step.times);
        }
        if (step.condition) {
            checkCondition(*step.condition);
        }
        auto within = afterAll(step.steps);
        if (step.until) {
            checkCondition(*step.until);
        }
        if (!runsAtLeastOnce(step)) {
            drop(within);
            return {};
        }
        return within;
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

    void checkCondition(const Condition& condition) {
        for (const auto& part : condition.parts) {
            checkCondition(part);
        }
        if (condition.parts.empty()) {
            checkReference(condition.subject, {condition.line, condition.key + ".from", ""});
            checkBinding(condition.operand);
        }
    }

    void checkBinding(const Binding& binding) {
        const Problem place{binding.line, binding.key, ""};
        if (const auto* reference = std::get_if<Reference>(&binding.source)) {
            checkReference(*reference, place);
        }
        if (const auto* terms = std::get_if<std::vector<Term>>(&binding.source)) {
            checkTerms(*terms, place);
        }
        checkTerms(binding.shift, place);
    }

    void checkTerms(const std::vector<Term>& terms, const Problem& place) {
        for (const auto& term : terms) {
            if (term.from) {
                checkReference(*term.from, place);
            }
        }
    }

    void checkReference(const Reference& reference, const Problem& place) {
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
        } else if (!knows(reference.step)) {
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
    Names optional_;  // aliases that may be served by nobody
    // Calls that have certainly finished where the check is now, and how many steps on the way
    // there always fail: sets of their own for each step would take a time that grows with the
    // square.
    std::unordered_set<std::string_view> known_;
    int dead_ends_ = 0;
    Problems problems_;
};

}  // namespace

Problems checkDefinition(const Definition& definition) {
    return Check(definition).run();
}

}  // namespace metier::composition
