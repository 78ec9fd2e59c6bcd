#include "left_out.hpp"

#include <map>
#include <set>
#include <string>
#include <utility>

#include "metier/skill/field.hpp"

namespace metier::composition {
namespace {

using Names = std::set<std::string, std::less<>>;

void leaveOutCalls(std::vector<Step>& steps, const Names& missing) {
    std::erase_if(steps, [&](const Step& step) {
        return step.kind == StepKind::call && missing.contains(step.use);
    });
    for (auto& step : steps) {
        leaveOutCalls(step.steps, missing);
        leaveOutCalls(step.otherwise, missing);
    }
}

void leaveOutArguments(std::vector<Step>& steps, const Descriptions& used) {
    for (auto& step : steps) {
        if (const auto found = used.find(step.use); found != used.end()) {
            std::erase_if(step.arguments, [&](const Argument& argument) {
                return argument.value.optional &&
                       skill::findField(found->second.parameters, argument.name) == nullptr;
            });
        }
        leaveOutArguments(step.steps, used);
        leaveOutArguments(step.otherwise, used);
    }
}

void leaveOutResults(Definition& definition, const Descriptions& used) {
    std::map<std::string, std::string, std::less<>> use_of;  // alias by step
    forEachCall(definition.root, [&](const Step& call) { use_of[call.name] = call.use; });
    for (auto& result : definition.results) {
        const auto* from = std::get_if<Reference>(&result.from.source);
        const auto use = from == nullptr ? use_of.end() : use_of.find(from->step);
        const auto found = use == use_of.end() ? used.end() : used.find(use->second);
        if (result.field.optional && found != used.end() &&
            skill::findField(found->second.results, from->name) == nullptr) {
            result.from.source = Literal{};
        }
    }
}

}  // namespace

Definition withoutMissing(Definition definition, const Descriptions& used) {
    Names missing;
    for (const auto& use : definition.uses) {
        if (use.optional && !used.contains(use.alias)) {
            missing.insert(use.alias);
        }
    }
    std::erase_if(definition.uses, [&](const Use& use) { return missing.contains(use.alias); });
    leaveOutCalls(definition.root.steps, missing);
    leaveOutArguments(definition.root.steps, used);
    leaveOutResults(definition, used);
    return definition;
}

}  // namespace metier::composition
