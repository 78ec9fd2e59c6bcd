#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "left_out.hpp"
#include "literal.hpp"
#include "metier/composition/composition.hpp"
#include "static_check.hpp"

namespace metier::composition {

namespace {

using skill::Field;
using skill::findField;
using skill::SkillDescription;
using skill::ValueType;

constexpr std::size_t kShiftOfFrame = 3;

/// Number of numbers in a value of that type; nothing if it depends on the value, or there are
/// none.
std::optional<std::size_t> sizeOf(ValueType type) {
    switch (type) {
        case ValueType::number:
            return 1;
        case ValueType::vector3:
            return 3;
        case ValueType::frame:
            return 6;
        default:
            return std::nullopt;
    }
}

/// Type of one element of a value; Null if it has none.
ValueType elementOf(ValueType type) {
    switch (type) {
        case ValueType::frame:
        case ValueType::vector3:
        case ValueType::numbers:
            return ValueType::number;
        case ValueType::frames:
            return ValueType::frame;
        case ValueType::texts:
            return ValueType::text;
        default:
            return ValueType::null;
    }
}

bool isNumber(ValueType type) {
    return type == ValueType::number || type == ValueType::int32 || type == ValueType::uint32 ||
           type == ValueType::uint64;
}

std::string namesOf(const skill::Fields& fields) {
    std::vector<std::string_view> names;
    for (const auto& field : fields) {
        names.push_back(field.name);
    }
    return fmt::format("{}", fmt::join(names, ", "));
}

/// Values that an execution publishes about itself.
const skill::Fields& executionFields() {
    static const skill::Fields kFields(
        {Field{.name = std::string(kExecutionSteps), .type = ValueType::texts},
         Field{.name = std::string(kExecutionDurations),
               .type = ValueType::numbers,
               .unit = skill::kSecond}});
    return kFields;
}

class Binder {
public:
    Binder(Definition definition, const Descriptions& used)
        : definition_(std::move(definition)), own_(descriptionOf(definition_)), used_(used) {
        forEachCall(definition_.root, [this](const Step& call) { use_of_[call.name] = call.use; });
    }

    Result<Composition> run() && {
        bindStep(definition_.root);
        for (auto& result : definition_.results) {
            if (!std::holds_alternative<Literal>(result.from.source)) {  // else left out
                bindTo(result.from, result.field);
            }
        }
        if (!problems_.empty()) {
            return fail(Errc::invalid_argument, report());
        }
        return Composition{.definition = std::move(definition_), .description = std::move(own_)};
    }

private:
    void note(const Binding& binding, std::string why) {
        problems_.push_back({binding.line, binding.key, std::move(why)});
    }

    std::string report() {
        std::stable_sort(problems_.begin(), problems_.end(),
                         [](const Problem& a, const Problem& b) { return a.line < b.line; });
        std::string text;
        for (const auto& problem : problems_) {
            text += fmt::format("{}{}:{}: {}: {}", text.empty() ? "" : "\n", definition_.file,
                                problem.line, problem.key, problem.why);
        }
        return text;
    }

    const SkillDescription* descriptionOfUse(const std::string& alias) const {
        const auto found = used_.find(alias);
        return found == used_.end() ? nullptr : &found->second;
    }

    void bindStep(Step& step) {
        if (step.kind == StepKind::call) {
            bindCall(step);
        }
        if (step.times) {
            bindTimes(*step.times);
        }
        for (auto* condition : {&step.condition, &step.until}) {
            if (*condition) {
                bindCondition(**condition);
            }
        }
        for (auto* steps : {&step.steps, &step.otherwise}) {
            for (auto& inner : *steps) {
                bindStep(inner);
            }
        }
    }

    /// A number of any type will do.
    void bindTimes(Binding& times) {
        const auto* reference = std::get_if<Reference>(&times.source);
        const auto source = reference == nullptr ? std::nullopt : fieldOf(*reference, times);
        if (!source || !isNumber(source->type)) {
            bindTo(times, {.name = "times", .type = ValueType::number});
        }
    }

    void bindCall(Step& step) {
        const auto* description = descriptionOfUse(step.use);
        if (description == nullptr) {
            problems_.push_back(
                {step.line, step.key + ".run", fmt::format("no skill serves \"{}\"", step.use)});
            return;
        }
        for (auto& argument : step.arguments) {
            const auto* field = findField(description->parameters, argument.name);
            if (field == nullptr) {
                note(argument.value,
                     fmt::format("{} has no such parameter; it has: {}", description->name,
                                 namesOf(description->parameters)));
            } else {
                bindTo(argument.value, *field);
            }
        }
        checkComplete(step, *description);
    }

    void checkComplete(const Step& step, const SkillDescription& description) {
        for (const auto& field : description.parameters) {
            const bool given =
                std::any_of(step.arguments.begin(), step.arguments.end(),
                            [&](const Argument& argument) { return argument.name == field.name; });
            if (!given && !field.optional && skill::isNull(field.default_value)) {
                problems_.push_back(
                    {step.line, step.key + ".with",
                     fmt::format("{} of {} needs a value", field.name, description.name)});
            }
        }
    }

    void bindCondition(Condition& condition) {
        for (auto& part : condition.parts) {
            bindCondition(part);
        }
        if (!condition.parts.empty()) {
            return;
        }
        auto field = fieldOf(condition.subject, condition.operand);
        if (!field) {
            return;
        }
        if (condition.kind != Condition::Kind::is && !isNumber(field->type)) {
            note(condition.operand,
                 fmt::format("{} is no number, so it is neither less nor greater", field->name));
            return;
        }
        field->range.reset();  // a comparison may ask for what never is
        field->extra_check = {};
        bindTo(condition.operand, *field);
    }

    /// Field to which a reference leads; nothing, with a noted problem, if there is no such field.
    std::optional<Field> fieldOf(const Reference& reference, const Binding& at) {
        const Field* field = nullptr;
        if (reference.step.empty()) {
            field = findField(own_.parameters, reference.name);
        } else if (reference.step == kExecution) {
            field = findField(executionFields(), reference.name);
            if (field == nullptr) {
                note(at, fmt::format("an execution has no \"{}\"; it has: {}", reference.name,
                                     namesOf(executionFields())));
                return std::nullopt;
            }
        } else {
            const auto* description = descriptionOfUse(use_of_[reference.step]);
            if (description == nullptr) {
                return std::nullopt;  // noted at the step
            }
            field = findField(description->results, reference.name);
            if (field == nullptr) {
                note(at, fmt::format("{} has no result \"{}\"; it has: {}", description->name,
                                     reference.name, namesOf(description->results)));
                return std::nullopt;
            }
        }
        if (field == nullptr) {
            return std::nullopt;  // noted when the file was read
        }
        return reference.element ? elementField(*field, *reference.element, at)
                                 : std::optional(*field);
    }

    std::optional<Field> elementField(const Field& whole, std::size_t index, const Binding& at) {
        Field part{.name = fmt::format("{}[{}]", whole.name, index),
                   .type = elementOf(whole.type),
                   .unit = whole.unit,
                   .optional = whole.optional};
        const auto size = sizeOf(whole.type);
        const auto most =
            size ? *size : (whole.length ? whole.length->most : std::size_t(SIZE_MAX));
        if (part.type == ValueType::null) {
            note(at, fmt::format("{} is of type {}, which has no elements", whole.name,
                                 skill::toString(whole.type)));
            return std::nullopt;
        }
        if (index >= most) {
            note(at, fmt::format("{} has no element {}; it has {}", whole.name, index, most));
            return std::nullopt;
        }
        return part;
    }

    void bindTo(Binding& binding, const Field& target) {
        if (const auto* literal = std::get_if<Literal>(&binding.source)) {
            bindConstant(binding, *literal, target);
        } else if (const auto* reference = std::get_if<Reference>(&binding.source)) {
            if (const auto source = fieldOf(*reference, binding)) {
                checkFit(binding, *source, target);
            }
        } else {
            checkTerms(binding, std::get<std::vector<Term>>(binding.source), target);
        }
        checkShift(binding, target);
    }

    void bindConstant(Binding& binding, const Literal& literal, const Field& target) {
        auto value = valueOf(literal, target.type);
        if (!value) {
            note(binding, value.error().message);
            return;
        }
        if (const auto fits = checkValue(target, *value); !fits) {
            note(binding, fits.error().message);
        }
        binding.constant = std::move(*value);
    }

    void checkFit(const Binding& binding, const Field& source, const Field& target) {
        if (source.type != target.type) {
            note(binding, fmt::format("{} is of type {}, {} needs {}", source.name,
                                      skill::toString(source.type), target.name,
                                      skill::toString(target.type)));
            return;
        }
        checkUnit(binding, source, target);
        const auto& given = source.length;
        const auto& wanted = target.length;
        if (given && wanted && (given->most < wanted->least || given->least > wanted->most)) {
            note(binding,
                 fmt::format("{} has {} to {} elements, {} needs {} to {}", source.name,
                             given->least, given->most, target.name, wanted->least, wanted->most));
        }
    }

    /// A number without a unit fits to every unit.
    void checkUnit(const Binding& binding, const Field& source, const Field& target) {
        if (!(source.unit == skill::kOne) && !(target.unit == skill::kOne) &&
            !(source.unit == target.unit)) {
            note(binding, fmt::format("{} is in {}, {} needs {}", source.name, source.unit.symbol,
                                      target.name, target.unit.symbol));
        }
    }

    void checkTerms(const Binding& binding, const std::vector<Term>& terms, const Field& target) {
        const auto size = sizeOf(target.type);
        if ((!size || *size == 1) && target.type != ValueType::numbers) {
            note(binding, fmt::format("is a list of numbers; {} needs {}", target.name,
                                      howToWrite(target.type)));
        } else if (size && terms.size() != *size) {
            note(binding, fmt::format("has {} numbers; {} needs {}", terms.size(), target.name,
                                      howToWrite(target.type)));
        }
        checkNumbers(binding, terms);
    }

    void checkNumbers(const Binding& binding, const std::vector<Term>& terms) {
        for (const auto& term : terms) {
            const auto field = term.from ? fieldOf(*term.from, binding) : std::nullopt;
            if (field && field->type != ValueType::number) {
                note(binding, fmt::format("{} is of type {}, a number is needed", field->name,
                                          skill::toString(field->type)));
            }
        }
    }

    void checkShift(const Binding& binding, const Field& target) {
        if (binding.shift.empty()) {
            return;
        }
        auto size = sizeOf(target.type);
        if (target.type == ValueType::frame) {
            size = kShiftOfFrame;
        } else if (binding.shift_axes == ShiftAxes::own) {
            note(binding, fmt::format("{} is of type {}, which has no axes of its own", target.name,
                                      skill::toString(target.type)));
        }
        if (!size && target.type != ValueType::numbers) {
            note(binding, fmt::format("{} is of type {}, which cannot be shifted", target.name,
                                      skill::toString(target.type)));
        } else if (size && binding.shift.size() != *size) {
            note(binding, fmt::format("shift has {} numbers; {} needs {}", binding.shift.size(),
                                      target.name, *size));
        }
        checkNumbers(binding, binding.shift);
    }

    Definition definition_;
    SkillDescription own_;
    const Descriptions& used_;
    std::map<std::string, std::string, std::less<>> use_of_;  // alias by step
    Problems problems_;
};

void collectNames(const std::vector<Step>& steps, std::vector<std::string>& names) {
    for (const auto& step : steps) {
        names.push_back(step.name);
        collectNames(step.steps, names);
        collectNames(step.otherwise, names);
    }
}

}  // namespace

SkillDescription descriptionOf(const Definition& definition) {
    SkillDescription description{.name = definition.name,
                                 .type = definition.type,
                                 .description = definition.description,
                                 .on_owner_loss = definition.on_owner_loss};
    std::vector<Field> parameters;
    for (const auto& parameter : definition.parameters) {
        parameters.push_back(parameter.field);
    }
    std::vector<Field> results;
    for (const auto& result : definition.results) {
        results.push_back(result.field);
    }
    collectNames(definition.root.steps, description.steps);
    description.parameters = std::move(parameters);
    description.results = std::move(results);
    return description;
}

Result<Composition> compose(Definition definition, const Descriptions& used) {
    auto composed = Binder(withoutMissing(definition, used), used).run();
    if (composed) {
        composed->given = std::move(definition);
    }
    return composed;
}

}  // namespace metier::composition
