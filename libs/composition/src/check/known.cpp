#include "check/known.hpp"

#include <vector>

#include "scope.hpp"

namespace metier::composition {

namespace {

std::optional<std::string> resultIn(const Reference& reference) {
    return reference.step.empty() ? std::nullopt : std::optional(nameOf(reference));
}

std::optional<std::string> resultIn(const std::vector<Term>& terms) {
    for (const auto& term : terms) {
        if (auto result = term.from ? resultIn(*term.from) : std::nullopt) {
            return result;
        }
    }
    return std::nullopt;
}

}  // namespace

std::optional<std::string> resultIn(const Binding& binding) {
    if (auto result = resultIn(binding.shift)) {
        return result;
    }
    if (const auto* reference = std::get_if<Reference>(&binding.source)) {
        return resultIn(*reference);
    }
    const auto* terms = std::get_if<std::vector<Term>>(&binding.source);
    return terms == nullptr ? std::nullopt : resultIn(*terms);
}

std::optional<std::string> resultIn(const Condition& condition) {
    for (const auto& part : condition.parts) {
        if (auto result = resultIn(part)) {
            return result;
        }
    }
    if (!condition.parts.empty()) {
        return std::nullopt;
    }
    auto result = resultIn(condition.subject);
    return result ? result : resultIn(condition.operand);
}

}  // namespace metier::composition
