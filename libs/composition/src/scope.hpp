#pragma once

#include <map>
#include <string>

#include "metier/base/error.hpp"
#include "metier/composition/definition.hpp"

namespace metier::composition {

/// A reference as it stands in messages: "grip.Width", "Target[2]".
std::string nameOf(const Reference& reference);

/// The values of one execution: its parameters, and the results of the steps so far.
class Scope {
public:
    explicit Scope(skill::ValueMap parameters) : parameters_(std::move(parameters)) {}

    /// Sets the result of the latest run of the step.
    void setResult(const std::string& step, skill::ValueMap result) {
        results_[step] = std::move(result);
    }

    /// The value of a binding for a target of that type.
    /// Errors: invalid_argument, out_of_range, with the place in the file.
    Result<skill::Value> evaluate(const Binding& binding, skill::ValueType type) const;
    /// Parameters that a call gives to the used skill. One that is `optional`, and that refers to a
    /// parameter which has no value in this execution, is left out.
    /// Errors: invalid_argument, out_of_range: "has no ..."
    Result<skill::ValueMap> arguments(const Step& call, const skill::SkillDescription& used) const;
    Result<bool> holds(const Condition& condition) const;
    /// Value of a binding to a number of any type.
    Result<double> number(const Binding& binding) const;
    Result<skill::Value> read(const Reference& reference) const;
    /// Parameters of the execution.
    const skill::ValueMap& parameters() const noexcept { return parameters_; }

private:
    bool leavesOut(const Binding& binding) const;
    Result<skill::Value> unshifted(const Binding& binding, skill::ValueType type) const;
    Result<std::vector<double>> numbersOf(const std::vector<Term>& terms) const;
    Result<bool> compare(const Condition& condition) const;

    skill::ValueMap parameters_;
    std::map<std::string, skill::ValueMap, std::less<>> results_;
};

}  // namespace metier::composition
