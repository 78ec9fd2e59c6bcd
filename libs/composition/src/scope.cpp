#include "scope.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <type_traits>
#include <utility>

#include "literal.hpp"
#include "metier/motion/frame.hpp"

namespace metier::composition {

namespace {

using skill::Frame;
using skill::Value;
using skill::ValueType;
using skill::Vector3;

std::optional<double> asNumber(const Value& value) {
    return std::visit(
        [](const auto& held) -> std::optional<double> {
            using T = std::decay_t<decltype(held)>;
            if constexpr (std::is_arithmetic_v<T> && !std::is_same_v<T, bool>) {
                return static_cast<double>(held);
            } else {
                return std::nullopt;
            }
        },
        value);
}

std::optional<Value> elementOf(const Value& value, std::size_t index) {
    if (const auto* f = std::get_if<Frame>(&value)) {
        const std::array parts{f->x, f->y, f->z, f->a, f->b, f->c};
        return index < parts.size() ? std::optional<Value>(parts[index]) : std::nullopt;
    }
    if (const auto* v = std::get_if<Vector3>(&value)) {
        const std::array parts{v->x, v->y, v->z};
        return index < parts.size() ? std::optional<Value>(parts[index]) : std::nullopt;
    }
    const auto from = [&](const auto& list) {
        return index < list.size() ? std::optional<Value>(list[index]) : std::nullopt;
    };
    if (const auto* numbers = std::get_if<std::vector<double>>(&value)) {
        return from(*numbers);
    }
    if (const auto* texts = std::get_if<std::vector<std::string>>(&value)) {
        return from(*texts);
    }
    const auto* frames = std::get_if<std::vector<Frame>>(&value);
    return frames == nullptr ? std::nullopt : from(*frames);
}

void shift(Frame& frame, const std::vector<double>& by, ShiftAxes axes) {
    Eigen::Vector3d way(by[0], by[1], by[2]);
    if (axes == ShiftAxes::own) {
        way = motion::toPose(frame).rotation * way;
    }
    frame.x += way.x();
    frame.y += way.y();
    frame.z += way.z();
}

Result<Value> shifted(Value value, const std::vector<double>& by, ShiftAxes axes) {
    if (auto* number = std::get_if<double>(&value); number != nullptr && by.size() == 1) {
        return *number + by[0];
    }
    if (auto* frame = std::get_if<Frame>(&value); frame != nullptr && by.size() == 3) {
        shift(*frame, by, axes);
        return value;
    }
    if (auto* vector = std::get_if<Vector3>(&value); vector != nullptr && by.size() == 3) {
        return Vector3{vector->x + by[0], vector->y + by[1], vector->z + by[2]};
    }
    auto* numbers = std::get_if<std::vector<double>>(&value);
    if (numbers == nullptr || numbers->size() != by.size()) {
        return fail(Errc::invalid_argument, fmt::format("{} cannot be shifted by {} numbers",
                                                        skill::toString(value), by.size()));
    }
    std::transform(numbers->begin(), numbers->end(), by.begin(), numbers->begin(), std::plus<>());
    return value;
}

/// An error whose text names its place in the file.
template <typename T>
Result<T> at(const Binding& binding, Result<T> result) {
    return std::move(result).map_error([&](Error error) {
        error.message = fmt::format("{} (line {}): {}", binding.key, binding.line, error.message);
        return error;
    });
}

}  // namespace

std::string nameOf(const Reference& reference) {
    auto name = reference.step.empty() ? reference.name
                                       : fmt::format("{}.{}", reference.step, reference.name);
    return reference.element ? fmt::format("{}[{}]", name, *reference.element) : name;
}

Result<Value> Scope::read(const Reference& reference) const {
    const auto* values = &parameters_;
    if (!reference.step.empty()) {
        const auto step = results_.find(reference.step);
        if (step == results_.end()) {
            return fail(Errc::invalid_argument,
                        fmt::format("step {} has no result yet", reference.step));
        }
        values = &step->second;
    }
    const auto found = values->find(reference.name);
    if (found == values->end() || skill::isNull(found->second)) {
        return fail(Errc::invalid_argument, fmt::format("{} has no value", nameOf(reference)));
    }
    if (!reference.element) {
        return found->second;
    }
    if (auto element = elementOf(found->second, *reference.element)) {
        return std::move(*element);
    }
    return fail(Errc::out_of_range, fmt::format("there is no {} in {}", nameOf(reference),
                                                skill::toString(found->second)));
}

Result<std::vector<double>> Scope::numbersOf(const std::vector<Term>& terms) const {
    std::vector<double> numbers;
    for (const auto& term : terms) {
        if (!term.from) {
            numbers.push_back(term.constant);
            continue;
        }
        METIER_ASSIGN(const auto value, read(*term.from));
        numbers.push_back(term.factor * asNumber(value).value_or(0.0));
    }
    return numbers;
}

Result<Value> Scope::unshifted(const Binding& binding, ValueType type) const {
    if (std::holds_alternative<Literal>(binding.source)) {
        return binding.constant;
    }
    if (const auto* reference = std::get_if<Reference>(&binding.source)) {
        return read(*reference);
    }
    METIER_ASSIGN(const auto numbers, numbersOf(std::get<std::vector<Term>>(binding.source)));
    return valueOf(numbers, type).map_error([&](const Error& /*unfit*/) {
        return Error{Errc::internal, fmt::format("{} numbers for a value of type {}",
                                                 numbers.size(), skill::toString(type))};
    });
}

Result<Value> Scope::evaluate(const Binding& binding, ValueType type) const {
    auto value = unshifted(binding, type);
    if (value && !binding.shift.empty()) {
        const auto by = numbersOf(binding.shift);
        value = by ? shifted(std::move(*value), *by, binding.shift_axes)
                   : Result<Value>(fail(by.error()));
    }
    return at(binding, std::move(value));
}

bool Scope::leavesOut(const Binding& binding) const {
    const auto* reference = std::get_if<Reference>(&binding.source);
    if (!binding.optional || reference == nullptr || !reference->step.empty()) {
        return false;
    }
    const auto given = parameters_.find(reference->name);
    return given == parameters_.end() || skill::isNull(given->second);
}

Result<skill::ValueMap> Scope::arguments(const Step& call,
                                         const skill::SkillDescription& used) const {
    skill::ValueMap values;
    for (const auto& argument : call.arguments) {
        if (leavesOut(argument.value)) {
            continue;
        }
        const auto* field = skill::findField(used.parameters, argument.name);
        if (field == nullptr) {
            return fail(Errc::invalid_argument, "has no parameter " + argument.name);
        }
        auto value = evaluate(argument.value, field->type);
        if (!value) {
            return fail(value.error().code, "has no value: " + value.error().message);
        }
        values.emplace(argument.name, std::move(*value));
    }
    return values;
}

Result<double> Scope::number(const Binding& binding) const {
    METIER_ASSIGN(const auto value, evaluate(binding, ValueType::number));
    const auto number = asNumber(value);
    return number ? Result<double>(*number)
                  : at(binding, Result<double>(fail(Errc::invalid_argument, "is no number")));
}

Result<bool> Scope::compare(const Condition& condition) const {
    const auto subject = read(condition.subject);
    if (!subject) {
        return at(condition.operand, Result<bool>(fail(subject.error())));
    }
    METIER_ASSIGN(const auto operand, evaluate(condition.operand, skill::typeOf(*subject)));
    const auto left = asNumber(*subject);
    const auto right = asNumber(operand);
    if (condition.kind == Condition::Kind::is) {
        return left && right ? *left == *right : *subject == operand;
    }
    if (!left || !right) {
        return fail(Errc::internal, "a comparison of what are no numbers");
    }
    return condition.kind == Condition::Kind::less ? *left < *right : *left > *right;
}

Result<bool> Scope::holds(const Condition& condition) const {
    if (condition.parts.empty()) {
        return compare(condition);
    }
    const bool all = condition.kind == Condition::Kind::all;
    for (const auto& part : condition.parts) {
        const auto held = holds(part);
        if (!held || condition.kind == Condition::Kind::negation) {
            return held ? Result<bool>(!*held) : held;
        }
        if (*held != all) {
            return *held;
        }
    }
    return all;
}

}  // namespace metier::composition
