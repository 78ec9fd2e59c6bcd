#include "method_values.hpp"

#include <algorithm>
#include <iterator>

#include "metier/opcua/text.hpp"
#include "metier/opcua/types.hpp"
#include "metier/opcua_skill/arm_places.hpp"
#include "metier/opcua_skill/start_keys.hpp"
#include "metier/opcua_skill/values.hpp"

namespace metier::client {
namespace {

constexpr std::size_t kCheckOutputs = 5;  // least number; values of the stop may follow
constexpr std::size_t kWithStoppingEstimate = 7;
constexpr std::size_t kWithEnds = 10;
constexpr std::size_t kExecutionOutputs = 6;

skill::ValueMap resultsIn(const opcua::Value& pairs, const skill::Fields& results) {
    skill::ValueMap values;
    for (const auto& [key, value] :
         pairs.as<std::vector<opcua::KeyValue>>().value_or(std::vector<opcua::KeyValue>{})) {
        const auto field =
            std::find_if(results.begin(), results.end(),
                         [&name = key.name](const auto& result) { return result.name == name; });
        if (field != results.end()) {
            values[key.name] = opcua_skill::fromOpcua(value, field->type).value_or(skill::Value{});
        }
    }
    return values;
}

/// Values of a server that reports where its arms end. Arms whose place is not an array of numbers
/// may be anywhere.
void readEnds(const std::vector<opcua::Value>& outputs, skill::CheckReport& report) {
    report.code = opcua::sanitise(outputs[7].as<std::string>().value_or(""));
    report.ends_known = !outputs[8].isEmpty();
    for (const auto& [key, value] :
         outputs[8].as<std::vector<opcua::KeyValue>>().value_or(std::vector<opcua::KeyValue>{})) {
        if (auto arm = opcua_skill::armIn(key.name, opcua_skill::kEndJointPosition)) {
            report.ends[std::move(*arm)] =
                value.as<std::vector<double>>().value_or(std::vector<double>{});
        }
    }
    for (const auto& note :
         outputs[9].as<std::vector<std::string>>().value_or(std::vector<std::string>{})) {
        report.notes.push_back(opcua::sanitise(note));
    }
}

std::vector<opcua::KeyValue> listOf(const skill::ValueMap& values) {
    std::vector<opcua::KeyValue> pairs;
    for (const auto& [name, value] : values) {
        pairs.push_back({{0, name}, opcua_skill::toOpcua(value)});
    }
    return pairs;
}

}  // namespace

skill::Reason reasonFrom(std::int32_t number) {
    constexpr std::int32_t kNone = 255;
    return static_cast<skill::Reason>(number >= 0 && number < kNone ? number : kNone);
}

std::vector<opcua::Value> checkInputs(const skill::CheckRequest& request) {
    auto pairs = listOf(request.parameters);
    auto starts = opcua_skill::pairsOf(request.starts, opcua_skill::kStartJointPosition);
    std::move(starts.begin(), starts.end(), std::back_inserter(pairs));
    return {opcua::Value::of(pairs)};
}

std::vector<opcua::Value> startWithInputs(const skill::StartRequest& request,
                                          const SkillNodes& nodes) {
    auto parameters = listOf(request.parameters);
    if (!nodes.records.isNull() && !request.parent.id.empty()) {
        parameters.push_back(
            {{0, std::string(opcua_skill::kParentExecution)}, opcua::Value::of(request.parent.id)});
        parameters.push_back({{0, std::string(opcua_skill::kParentServer)},
                              opcua::Value::of(request.parent.server)});
    }
    return {opcua::Value::of(request.execution_id), opcua::Value::of(parameters),
            opcua::Value::of(static_cast<std::int32_t>(request.on_owner_loss)),
            opcua::Value::of(request.epoch),
            opcua::Value::of(request.deadline.value_or(UtcTime{}))};
}

opcua::Answer<skill::CheckReport> checkReportFrom(const std::vector<opcua::Value>& outputs,
                                                  std::string_view skill) {
    if (outputs.size() < kCheckOutputs) {
        return opcua::failed(opcua::status::kBadUnexpectedError, std::string(skill) + " Check");
    }
    skill::CheckReport report;
    report.possible = outputs[0].as<bool>().value_or(false);
    report.reason = opcua::sanitise(outputs[1].as<std::string>().value_or(""));
    report.first_failing_fraction = outputs[2].as<double>().value_or(0.0);
    report.planned_duration = outputs[3].as<double>().value_or(0.0);
    report.joint_path = outputs[4].asRows().value_or(std::vector<std::vector<double>>{});
    if (outputs.size() >= kWithStoppingEstimate) {
        report.stopping_time = outputs[5].as<double>().value_or(0.0);
        report.stopping_distance = outputs[6].as<double>().value_or(0.0);
    }
    if (outputs.size() >= kWithEnds) {
        readEnds(outputs, report);
    }
    return report;
}

opcua::Answer<skill::ExecutionRecord> executionFrom(const std::vector<opcua::Value>& outputs,
                                                    const std::string& id,
                                                    const skill::Fields& results,
                                                    std::string_view skill) {
    if (outputs.size() != kExecutionOutputs) {
        return opcua::failed(opcua::status::kBadUnexpectedError,
                             std::string(skill) + " GetExecution");
    }
    skill::ExecutionRecord record;
    record.id = id;
    record.state = static_cast<skill::State>(outputs[0].as<std::uint32_t>().value_or(0));
    record.reason = reasonFrom(outputs[1].as<std::int32_t>().value_or(0));
    record.reason_text = opcua::sanitise(outputs[2].as<std::string>().value_or(""));
    record.start_time = outputs[3].as<UtcTime>().value_or(UtcTime{});
    record.end_time = outputs[4].as<UtcTime>().value_or(UtcTime{});
    record.result = resultsIn(outputs[5], results);
    return record;
}

}  // namespace metier::client
