#include "execution_records.hpp"

#include <array>
#include <string>

#include "metier/opcua/status_code.hpp"
#include "metier/opcua/value.hpp"
#include "metier/skill/json.hpp"
#include "model_ids.hpp"

namespace metier::opcua_skill {

namespace {

using opcua::AddressSpace;
using opcua::NodeId;
using opcua::Value;
using skill::ExecutionRecord;

constexpr const char* kExecutionRecords = "ExecutionRecords";

/// A property of a record.
struct Item {
    const char* name;
    Value (*read)(const ExecutionRecord& record, const skill::Program& program);
};

Value timeValue(UtcTime time) {
    return Value::of(time == UtcTime{} ? UtcTime::min() : time);
}

const std::array<Item, 13>& items() {
    using Record = const ExecutionRecord&;
    using Program = const skill::Program&;
    static const std::array<Item, 13> kItems{
        {{"ExecutionId", [](Record r, Program) { return Value::of(r.id); }},
         {"SkillName", [](Record, Program p) { return Value::of(p.description().name); }},
         {"Client", [](Record r, Program) { return Value::of(r.client.client_name); }},
         {"User", [](Record r, Program) { return Value::of(r.client.user_name); }},
         {"ParentExecution", [](Record r, Program) { return Value::of(r.parent.id); }},
         {"ParentServer", [](Record r, Program) { return Value::of(r.parent.server); }},
         {"StartTime", [](Record r, Program) { return timeValue(r.start_time); }},
         {"EndTime", [](Record r, Program) { return timeValue(r.end_time); }},
         {"EndState",
          [](Record r, Program) { return Value::of(static_cast<std::uint32_t>(r.state)); }},
         {"Reason",
          [](Record r, Program) { return Value::of(static_cast<std::int32_t>(r.reason)); }},
         {"ReasonText", [](Record r, Program) { return Value::of(r.reason_text); }},
         {"Parameters",
          [](Record r, Program) {
              return Value::of(r.parameters ? skill::jsonOf(*r.parameters) : std::string());
          }},
         {"Result", [](Record r, Program) {
              return Value::of(r.result.empty() ? std::string() : skill::jsonOf(r.result));
          }}}};
    return kItems;
}

Result<NodeId> folderOf(AddressSpace& nodes, const NodeId& skill, std::uint16_t metier) {
    return foundOrAdded(nodes,
                        {.node = {.parent = skill,
                                  .browse_name = {metier, kExecutionRecords},
                                  .description = {"en", "The last executions, the latest first."}},
                         .type = opcua::ids::kFolderType});
}

/// The execution of a program that came `back` before the latest.
struct PastExecution {
    const skill::Program& program;
    std::size_t back;
};

/// Adds its record to the folder.
Result<void> addRecord(AddressSpace& nodes, const NodeId& folder, const NodeId& type,
                       const PastExecution& execution) {
    const auto name = execution.back == 0 ? "Latest" : "Latest-" + std::to_string(execution.back);
    METIER_ASSIGN(
        const auto object,
        nodes.addObject({.node = {.parent = folder,
                                  .browse_name = {type.namespaceIndex(), name},
                                  .description = {"en", "What is kept of one execution."}},
                         .type = type}));
    for (const auto& item : items()) {
        METIER_ASSIGN(const auto node, nodes.find(object, {type.namespaceIndex(), item.name}));
        const auto read = [execution, &item](const opcua::Session& /*reader*/) {
            const auto* record = execution.program.recentExecution(execution.back);
            return record == nullptr ? opcua::DataValue{{}, opcua::status::kBadNoData}
                                     : opcua::DataValue{item.read(*record, execution.program)};
        };
        METIER_TRY(nodes.setDataSource(node, {read}));
    }
    return {};
}

}  // namespace

Result<void> publishExecutionRecords(AddressSpace& nodes, const NodeId& skill,
                                     const skill::Program& program) {
    METIER_ASSIGN(const auto metier, nodes.namespaceIndex(kMetierUri));
    METIER_ASSIGN(const auto type, typeDirectlyBelow(nodes, opcua::ids::kBaseObjectType,
                                                     {metier, "ExecutionRecordType"}));
    METIER_ASSIGN(const auto folder, folderOf(nodes, skill, metier));
    for (std::size_t back = 0; back < kBrowsableExecutions; ++back) {
        METIER_TRY(addRecord(nodes, folder, type, {program, back}));
    }
    return {};
}

}  // namespace metier::opcua_skill
