#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <utility>

#include "definition_reader.hpp"
#include "literal.hpp"

namespace metier::composition {

namespace {

using cell::TomlTable;
using cell::TomlValue;

constexpr std::int64_t kMostRounds = 1'000'000;
constexpr std::int64_t kMostRetries = 1'000;
constexpr double kLongestTime = 7.0 * 24 * 3600;

/// Kind of a step, and the key that stands for it.
struct KindKey {
    std::string_view key;
    StepKind kind;
};
constexpr std::array kKinds{
    KindKey{"run", StepKind::call},          KindKey{"sequence", StepKind::sequence},
    KindKey{"parallel", StepKind::parallel}, KindKey{"fallback", StepKind::fallback},
    KindKey{"if", StepKind::choice},         KindKey{"repeat", StepKind::loop},
    KindKey{"fail", StepKind::failure}};

std::string joined(const std::string& path, std::string_view key) {
    return path.empty() ? std::string(key) : fmt::format("{}.{}", path, key);
}

std::chrono::nanoseconds readTime(const TomlTable& table, std::string_view key, double least) {
    const double time = table.numberOr(key, least);
    if (time < least || time > kLongestTime) {
        table.reject(key,
                     fmt::format("{} s is not within {} s to {} s", time, least, kLongestTime));
        return {};
    }
    return std::chrono::duration_cast<std::chrono::nanoseconds>(
        std::chrono::duration<double>(time));
}

void readCall(const TomlTable& table, Step& step) {
    step.use = table.text("run");
    if (!table.has("with")) {
        return;
    }
    const auto with = table.table("with");
    for (const auto& name : with.keys()) {
        const auto key = fmt::format("{}.with.{}", step.key, name);
        const auto value = *with.value(name);
        step.arguments.push_back({name, readBinding(value, key)});
        if (const auto reference = value.table()) {
            step.arguments.back().value.optional = reference->flagOr("optional", false);
        }
    }
}

void readParallel(const TomlTable& table, Step& step) {
    step.steps = readSteps(table, "parallel", step.key);
    const auto wait_for = table.textOr("wait_for", "all");
    step.wait_for = wait_for == "any" ? WaitFor::any : WaitFor::all;
    if (wait_for != "all" && wait_for != "any") {
        table.reject("wait_for", fmt::format("\"{}\" is none of: \"all\", \"any\"", wait_for));
    }
}

void readChoice(const TomlTable& table, Step& step) {
    step.condition = readCondition(table.table("if"), step.key + ".if");
    step.steps = readSteps(table, "then", step.key);
    step.otherwise = readSteps(table, "else", step.key);
}

void readLoop(const TomlTable& table, Step& step) {
    step.steps = readSteps(table, "repeat", step.key);
    if (const auto times = table.value("times")) {
        step.times = readBinding(*times, step.key + ".times");
    }
    if (table.has("at_most")) {
        step.at_most = static_cast<std::uint32_t>(table.integerOr("at_most", 1, 1, kMostRounds));
    }
    if (table.has("while")) {
        step.condition = readCondition(table.table("while"), step.key + ".while");
    }
    if (table.has("until")) {
        step.until = readCondition(table.table("until"), step.key + ".until");
    }
}

void readWhatItDoes(const TomlTable& table, Step& step) {
    switch (step.kind) {
        case StepKind::call:
            return readCall(table, step);
        case StepKind::sequence:
            step.steps = readSteps(table, "sequence", step.key);
            return;
        case StepKind::parallel:
            return readParallel(table, step);
        case StepKind::fallback:
            step.steps = readSteps(table, "fallback", step.key);
            return;
        case StepKind::choice:
            return readChoice(table, step);
        case StepKind::loop:
            return readLoop(table, step);
        case StepKind::failure:
            step.text = table.text("fail");
            return;
    }
}

void readLimits(const TomlTable& table, Step& step) {
    if (table.has("timeout")) {
        step.timeout = readTime(table, "timeout", 0.001);
    }
    if (table.has("retry")) {
        step.retry =
            Retry{static_cast<std::uint32_t>(table.integerOr("retry", 1, 1, kMostRetries)),
                  table.has("pause") ? readTime(table, "pause", 0.0) : std::chrono::nanoseconds(0)};
    }
}

std::optional<StepKind> kindOf(const TomlTable& table) {
    std::vector<KindKey> given;
    for (const auto& kind : kKinds) {
        if (table.has(kind.key)) {
            given.push_back(kind);
        }
    }
    if (given.empty()) {
        table.reject("run",
                     "missing; a step says what it does by one of: run, sequence, "
                     "parallel, fallback, if, repeat, fail");
        return std::nullopt;
    }
    if (given.size() > 1) {
        table.reject(given[1].key, fmt::format("a step that says {} cannot say {}, too",
                                               given[0].key, given[1].key));
    }
    return given.front().kind;
}

Step readStep(const TomlTable& table, std::string key) {
    Step step;
    step.line = table.line();
    step.key = std::move(key);
    step.name = table.text("name");
    if (!step.name.empty()) {
        checkName(table, "name", step.name, kLongestStepName);
    }
    const auto kind = kindOf(table);
    if (!kind) {
        return step;
    }
    step.kind = *kind;
    step.background = table.flagOr("background", false);
    readWhatItDoes(table, step);
    readLimits(table, step);
    if (step.kind != StepKind::call && step.kind != StepKind::failure && step.steps.empty()) {
        table.reject(step.kind == StepKind::choice ? "then" : "name", "has no steps");
    }
    return step;
}

/// Element of a frame or vector by its letter, else of a list by its number from 0.
std::optional<std::size_t> readElement(const TomlTable& table, std::string_view key) {
    constexpr std::array<std::string_view, 6> kLetters{"x", "y", "z", "a", "b", "c"};
    const auto given = table.value(key);
    if (!given) {
        return std::nullopt;
    }
    if (const auto index = given->integer(); index && *index >= 0) {
        return static_cast<std::size_t>(*index);
    }
    const auto letter = std::find(kLetters.begin(), kLetters.end(), given->text().value_or(""));
    if (letter == kLetters.end()) {
        given->reject("is not a number from 0, nor one of x, y, z, a, b, c");
        return std::nullopt;
    }
    return static_cast<std::size_t>(letter - kLetters.begin());
}

Term readTerm(const TomlValue& value) {
    if (const auto number = value.number()) {
        return {*number, {}};
    }
    if (const auto table = value.table()) {
        return {0.0, readReference(*table, "from", "element"), table->numberOr("times", 1.0)};
    }
    value.reject("is neither a number nor { from = \"...\" }");
    return {};
}

std::vector<Term> readTerms(const TomlValue& list) {
    std::vector<Term> terms;
    for (const auto& item : list.items()) {
        terms.push_back(readTerm(item));
    }
    return terms;
}

ShiftAxes readShiftAxes(const TomlTable& table) {
    const auto axes = table.textOr("shift_axes", "base");
    if (axes != "base" && axes != "own") {
        table.reject("shift_axes", fmt::format("\"{}\" is none of: \"base\", \"own\"", axes));
    }
    return axes == "own" ? ShiftAxes::own : ShiftAxes::base;
}

void readComparison(const TomlTable& table, Condition& condition) {
    constexpr std::array kComparisons{std::pair("is", Condition::Kind::is),
                                      std::pair("less", Condition::Kind::less),
                                      std::pair("greater", Condition::Kind::greater)};
    condition.subject = readReference(table, "from", "element");
    for (const auto& [key, kind] : kComparisons) {
        if (const auto operand = table.value(key)) {
            condition.kind = kind;
            condition.operand = readBinding(*operand, fmt::format("{}.{}", condition.key, key));
            return;
        }
    }
    table.reject("from", "is compared with nothing; needs one of: is, less, greater");
}

}  // namespace

std::vector<Step> readSteps(const TomlTable& table, const std::string& key,
                            const std::string& path) {
    std::vector<Step> steps;
    for (const auto& inner : table.tables(key)) {
        steps.push_back(readStep(inner, fmt::format("{}[{}]", joined(path, key), steps.size())));
    }
    return steps;
}

Reference readReference(const TomlTable& table, std::string_view key,
                        std::string_view element_key) {
    const auto text = table.text(key);
    const auto point = text.find('.');
    Reference reference;
    if (point == std::string::npos) {
        reference.name = text;
    } else {
        reference.step = text.substr(0, point);
        reference.name = text.substr(point + 1);
    }
    if (!text.empty() && (reference.name.empty() || point == 0)) {
        table.reject(key, fmt::format("\"{}\" is neither a parameter nor \"step.Result\"", text));
    }
    reference.element = readElement(table, element_key);
    return reference;
}

Binding readBinding(const TomlValue& value, std::string key) {
    Binding binding{.line = value.line(), .key = std::move(key)};
    if (const auto table = value.table()) {
        binding.source = readReference(*table, "from", "element");
        if (const auto shift = table->value("shift")) {
            binding.shift = shift->isList() ? readTerms(*shift) : std::vector{readTerm(*shift)};
            binding.shift_axes = readShiftAxes(*table);
        }
        return binding;
    }
    const auto items = value.items();
    if (std::any_of(items.begin(), items.end(),
                    [](const auto& item) { return item.table().has_value(); })) {
        binding.source = readTerms(value);
        return binding;
    }
    if (auto literal = literalOf(value)) {
        binding.source = std::move(*literal);
    } else {
        value.reject("is neither a constant nor { from = \"...\" }");
    }
    return binding;
}

Condition readCondition(const TomlTable& table, std::string key) {
    constexpr std::array kLists{std::pair("all", Condition::Kind::all),
                                std::pair("any", Condition::Kind::any)};
    Condition condition{.line = table.line(), .key = std::move(key)};
    for (const auto& [list, kind] : kLists) {
        if (!table.has(list)) {
            continue;
        }
        condition.kind = kind;
        for (const auto& part : table.tables(list)) {
            condition.parts.push_back(readCondition(
                part, fmt::format("{}.{}[{}]", condition.key, list, condition.parts.size())));
        }
        return condition;
    }
    if (table.has("not")) {
        condition.kind = Condition::Kind::negation;
        condition.parts.push_back(readCondition(table.table("not"), condition.key + ".not"));
        return condition;
    }
    readComparison(table, condition);
    return condition;
}

}  // namespace metier::composition
