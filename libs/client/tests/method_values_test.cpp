// Arguments of methods, also of a server that answers nonsense.
#include "method_values.hpp"

#include <gmock/gmock.h>

namespace metier::client {
namespace {

using opcua::Value;
using ::testing::HasSubstr;
using ::testing::SizeIs;

const skill::Fields kResults{{.name = "Duration", .type = skill::ValueType::number},
                             {.name = "Name", .type = skill::ValueType::text}};

std::vector<Value> execution(std::int32_t reason, const std::vector<opcua::KeyValue>& results) {
    return {Value::of(12U),
            Value::of(reason),
            Value::of("a\x1b[2J"),
            Value::of(UtcTime(std::chrono::seconds(1))),
            Value::of(UtcTime(std::chrono::seconds(2))),
            Value::of(results)};
}

TEST(MethodValues, OfAnExecutionAreReadByTheNamesOfItsResults) {
    const auto record = executionFrom(execution(1, {{{3, "Duration"}, Value::of(0.5)},
                                                    {{3, "Other"}, Value::of(1.0)},
                                                    {{3, "Name"}, Value::of(7.0)}}),
                                      "id", kResults, "Move");
    ASSERT_TRUE(record);
    EXPECT_EQ(record->id, "id");
    EXPECT_EQ(record->state, skill::State::ready);
    EXPECT_EQ(record->reason, skill::Reason::finished);
    EXPECT_EQ(record->reason_text.find('\x1b'), std::string::npos);
    EXPECT_EQ(record->start_time, UtcTime(std::chrono::seconds(1)));
    EXPECT_THAT(record->result, SizeIs(2));
    EXPECT_EQ(record->result.at("Duration"), skill::Value(0.5));
    EXPECT_TRUE(skill::isNull(record->result.at("Name"))) << "of another type";
}

TEST(MethodValues, AReasonThatIsNoneIsNotTakenForAnother) {
    const auto record = executionFrom(execution(257, {}), "id", kResults, "Move");
    EXPECT_EQ(toString(record->reason), "unknown");
    EXPECT_EQ(reasonFrom(7), skill::Reason::limit_violated);
    EXPECT_EQ(toString(reasonFrom(-1)), "unknown");
}

TEST(MethodValues, OfOtherNumbersAreAFailureThatNamesTheSkill) {
    auto outputs = execution(1, {});
    outputs.pop_back();
    const auto record = executionFrom(outputs, "id", kResults, "Move");
    ASSERT_FALSE(record);
    EXPECT_EQ(record.error().status, opcua::status::kBadUnexpectedError);
    EXPECT_THAT(record.error().message, HasSubstr("Move GetExecution"));
    const auto report = checkReportFrom({Value::of(true)}, "Move");
    ASSERT_FALSE(report);
    EXPECT_THAT(report.error().message, HasSubstr("Move Check"));
}

TEST(MethodValues, OfACheckWithoutAnEstimateOfTheStopHaveNone) {
    std::vector<Value> outputs{Value::of(true), Value::of(""), Value::of(1.0), Value::of(2.5),
                               Value::ofRows({{0.0, 1.0}, {0.5, 1.5}})};
    const auto without = checkReportFrom(outputs, "Move").value();
    EXPECT_TRUE(without.possible);
    EXPECT_EQ(without.planned_duration, 2.5);
    EXPECT_THAT(without.joint_path, SizeIs(2));
    EXPECT_EQ(without.stopping_time, 0.0);
    outputs.push_back(Value::of(0.25));
    outputs.push_back(Value::of(0.01));
    EXPECT_EQ(checkReportFrom(outputs, "Move").value().stopping_time, 0.25);
}

TEST(MethodValues, OfACheckOfOtherTypesSayThatItIsNotPossible) {
    const std::vector<Value> nonsense(5, Value::of("yes"));
    const auto report = checkReportFrom(nonsense, "Move").value();
    EXPECT_FALSE(report.possible);
    EXPECT_THAT(report.joint_path, SizeIs(0));
}

TEST(MethodValues, OfAStartNameItsParentOnlyToServersWithRecords) {
    skill::StartRequest request;
    request.execution_id = "one";
    request.parameters = {{"Speed", skill::Value(0.5)}};
    request.parent = {"above", "urn:server"};
    SkillNodes nodes;
    const auto parametersOf = [&] {
        return startWithInputs(request, nodes)[1].as<std::vector<opcua::KeyValue>>().value();
    };
    EXPECT_THAT(parametersOf(), SizeIs(1));
    nodes.records = opcua::NodeId(1, 7U);
    ASSERT_THAT(parametersOf(), SizeIs(3));
    EXPECT_EQ(parametersOf()[1].value, Value::of("above"));
    EXPECT_EQ(startWithInputs(request, nodes)[0], Value::of("one"));
    EXPECT_EQ(startWithInputs(request, nodes)[4], Value::of(UtcTime{})) << "no deadline";
    request.parent = {};
    EXPECT_THAT(parametersOf(), SizeIs(1));
}

}  // namespace
}  // namespace metier::client
