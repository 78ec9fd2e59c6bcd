#include "metier/records/program_recorder.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>

#include "metier/skill/lambda_skill.hpp"
#include "metier/skill/testing/manual_executor.hpp"
#include "metier/skill/testing/manual_work.hpp"
#include "recording_bench.hpp"

namespace metier::records {
namespace {

using skill::Reason;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::PlacedArm;
using testing::RecordedFile;

const skill::Caller kAlice{"session 1", "Alice's client", "alice", "ab12"};

/// A Program whose work ends when the test says so.
struct RecordedProgram : ::testing::Test {
    static skill::SkillDescription description() {
        skill::SkillDescription description;
        description.name = "WeldSkill";
        description.type = "WeldSkillType";
        description.parameters = {
            {.name = "Speed", .type = skill::ValueType::number, .default_value = 0.5}};
        description.results = {{.name = "Length", .type = skill::ValueType::number}};
        return description;
    }
    ExecutionRow only() {
        const auto listed = file.store()->list({}, {});
        EXPECT_TRUE(listed);
        EXPECT_EQ(listed->executions.size(), 1U);
        return listed->executions.at(0);
    }
    std::vector<std::string> ways(std::int64_t number) {
        std::vector<std::string> ways;
        const auto all = file.store()->transitions(number);
        EXPECT_TRUE(all);
        for (const auto& one : *all) {
            ways.push_back(one.from + ">" + one.to + (one.step.empty() ? "" : " at " + one.step) +
                           (one.sub_state.empty() ? "" : " " + one.sub_state));
        }
        return ways;
    }

    RecordedFile file;
    PlacedArm arm;
    PathSampler sampler{arm, nullptr, file.recorder()};
    std::shared_ptr<skill::testing::ManualExecutor> executor =
        std::make_shared<skill::testing::ManualExecutor>();
    skill::ExecutionHandle execution;
    std::unique_ptr<skill::Program> program = std::make_unique<skill::Program>(
        skill::ProgramOptions{},
        std::make_unique<skill::LambdaSkill>(description(), skill::testing::manualWork(execution)),
        executor, executor->clock());
    std::unique_ptr<ProgramRecorder> recorder = std::make_unique<ProgramRecorder>(
        *program, file.recorder(), &sampler, ProgramRecorder::Place{"ur5", "Controller", "UR5"});
};

TEST_F(RecordedProgram, IsRecordedWithItsClientParametersAndResult) {
    const auto id = program->startWith(
        kAlice, {.parameters = {{"Speed", 0.25}}, .parent = {"parent 7", "urn:cell:pick"}});
    ASSERT_TRUE(id);
    execution.finish({{"Length", 1.5}});
    executor->run();
    const auto record = only();
    EXPECT_EQ(record.id, *id);
    EXPECT_EQ(record.server, "urn:test");
    EXPECT_EQ(record.server_name, "ur5");
    EXPECT_EQ(record.skill, "WeldSkill");
    EXPECT_EQ(record.controller, "Controller");
    EXPECT_EQ(record.device, "UR5");
    EXPECT_EQ(record.parent, "parent 7");
    EXPECT_EQ(record.parent_server, "urn:cell:pick");
    EXPECT_EQ(record.session, "session 1");
    EXPECT_EQ(record.client_name, "Alice's client");
    EXPECT_EQ(record.user, "alice");
    EXPECT_EQ(record.thumbprint, "ab12");
    EXPECT_EQ(record.parameters, R"({"Speed":0.25})");
    EXPECT_EQ(record.state, "Ready");
    EXPECT_EQ(record.reason, "Finished");
    EXPECT_EQ(record.result, R"({"Length":1.5})");
    EXPECT_TRUE(record.isOver());
    EXPECT_THAT(ways(record.number),
                ElementsAre("Ready>Running Executing", "Running>Ready ReadyNotConfigured"));
}

TEST_F(RecordedProgram, IsRecordedWithThePathOfItsArm) {
    arm.place({0.5, 0.25}, {0.5, 0.25});
    ASSERT_TRUE(program->start(kAlice));
    arm.place({1.5, 1.25}, {1.6, 1.25}, 3);
    execution.finish({});
    executor->run();
    const auto path = file.store()->path(only().number);
    ASSERT_TRUE(path);
    ASSERT_GE(path->size(), 2U);
    EXPECT_EQ(path->front().actual[0], 0.5);
    EXPECT_EQ(path->back().actual[0], 1.5);
}

TEST_F(RecordedProgram, IsRecordedWhenItIsSuspendedAndHalted) {
    ASSERT_TRUE(program->start(kAlice));
    ASSERT_TRUE(program->suspend(kAlice));
    executor->run();
    ASSERT_TRUE(program->resume(kAlice));
    ASSERT_TRUE(program->halt(kAlice));
    executor->run();
    const auto record = only();
    EXPECT_EQ(record.state, "Halted");
    EXPECT_EQ(record.reason, "ByClient");
    EXPECT_EQ(record.result, "");
    EXPECT_THAT(ways(record.number),
                ElementsAre("Ready>Running Executing", "Running>Running Stopping",
                            "Running>Suspended", "Suspended>Running Executing",
                            "Running>Running Stopping", "Running>Halted HaltedByClient"));
}

TEST_F(RecordedProgram, IsRecordedWithStepsProgressAndChildren) {
    ASSERT_TRUE(program->start(kAlice));
    execution.step("approach");
    execution.progress(0.5);
    execution.started({"pick/1", "GraspGripperSkill", "opc.tcp://10.0.0.2:4840"});
    executor->run();
    execution.fail(Reason::error, "no \"part\"");
    executor->run();
    const auto record = only();
    EXPECT_EQ(record.reason, "Error");
    EXPECT_EQ(record.reason_text, "no \"part\"");
    EXPECT_THAT(ways(record.number),
                ElementsAre("Ready>Running Executing", "Running>Running at approach Executing",
                            "Running>Halted HaltedError"));
    const auto found = file.store()->intermediates(record.number);
    ASSERT_TRUE(found);
    ASSERT_EQ(found->size(), 2U);
    EXPECT_EQ(found->at(0).value, "0.5");
    EXPECT_EQ(
        found->at(1).value,
        R"({"started":{"id":"pick/1","skill":"GraspGripperSkill","server_url":"opc.tcp://10.0.0.2:4840"}})");
}

TEST_F(RecordedProgram, HasTheCheckOfTheSameValuesForTheSameSession) {
    static_cast<void>(program->check(kAlice, {{"Speed", 0.25}}));
    ASSERT_TRUE(program->startWith(kAlice, {.parameters = {{"Speed", 0.25}}}));
    executor->run();
    EXPECT_EQ(only().check,
              R"({"possible":true,"reason":"","first_failing_fraction":1.0,"planned_duration":0.0,)"
              R"("stopping_time":0.0,"stopping_distance":0.0})");
}

TEST_F(RecordedProgram, HasNoCheckOfOtherValuesOrForAnotherSession) {
    static_cast<void>(program->check(kAlice, {{"Speed", 0.75}}));
    ASSERT_TRUE(program->startWith(kAlice, {.parameters = {{"Speed", 0.25}}}));
    execution.finish();
    executor->run();
    auto bob = kAlice;
    bob.session_id = "session 2";
    static_cast<void>(program->check(bob, {}));
    ASSERT_TRUE(program->startWith(kAlice, {}));
    const auto listed = file.store()->list({}, {});
    ASSERT_TRUE(listed);
    ASSERT_EQ(listed->executions.size(), 2U);
    EXPECT_EQ(listed->executions[0].check, "");
    EXPECT_EQ(listed->executions[1].check, "");
}

TEST_F(RecordedProgram, HasNoRecordOfWhatIsRefusedOrIsNoExecution) {
    EXPECT_FALSE(program->startWith(kAlice, {.parameters = {{"Nothing", 1.0}}}));
    EXPECT_FALSE(program->suspend(kAlice));
    ASSERT_TRUE(program->halt(kAlice));
    ASSERT_TRUE(program->reset(kAlice));
    const auto listed = file.store()->list({}, {});
    ASSERT_TRUE(listed);
    EXPECT_TRUE(listed->executions.empty());
}

TEST_F(RecordedProgram, CountsTheMissedCyclesOfItsArm) {
    arm.place({0.0, 0.0}, {0.0, 0.0}, 10);
    ASSERT_TRUE(program->start(kAlice));
    arm.place({0.0, 0.0}, {0.0, 0.0}, 12);
    execution.finish();
    executor->run();
    EXPECT_EQ(only().missed_cycles, 2U);
}

/// A Program that moves no arm.
struct ArmlessProgram : RecordedProgram {
    ArmlessProgram() {
        recorder = std::make_unique<ProgramRecorder>(
            *program, file.recorder(), nullptr, ProgramRecorder::Place{"ur5", "Controller", ""});
    }
    std::vector<ExecutionRow> all() {
        const auto listed = file.store()->list({}, {.count = 500});
        EXPECT_TRUE(listed);
        auto executions = listed->executions;
        std::sort(executions.begin(), executions.end(),
                  [](const auto& a, const auto& b) { return a.number < b.number; });
        return executions;
    }
};

TEST_F(ArmlessProgram, IsRecordedInItsOrderHoweverOftenItRuns) {
    std::vector<std::string> ids;
    for (int i = 1; i <= 200; ++i) {
        const auto id = program->startWith(kAlice, {});
        ASSERT_TRUE(id);
        ids.push_back(*id);
        execution.finish({{"Length", static_cast<double>(i)}});
        executor->run();
    }
    const auto records = all();
    ASSERT_EQ(records.size(), ids.size());
    for (std::size_t i = 0; i < ids.size(); ++i) {
        EXPECT_EQ(records[i].id, ids[i]);
        EXPECT_EQ(records[i].result, fmt::format(R"({{"Length":{}}})", i + 1));
    }
    EXPECT_THAT(ways(records.back().number),
                ElementsAre("Ready>Running Executing", "Running>Ready ReadyNotConfigured"));
}

TEST_F(ArmlessProgram, IsRecordedWhileItRunsAndWithItsReasonOnceItFailed) {
    ASSERT_TRUE(program->startWith(kAlice, {.parameters = {{"Speed", 0.25}}}));
    EXPECT_EQ(only().state, "Running");
    EXPECT_FALSE(only().isOver());
    execution.fail(Reason::error, "no wire");
    executor->run();
    ASSERT_TRUE(program->reset(kAlice));
    const auto record = only();
    EXPECT_EQ(record.state, "Halted");
    EXPECT_EQ(record.reason, "Error");
    EXPECT_EQ(record.reason_text, "no wire");
    EXPECT_EQ(record.result, "");
    EXPECT_EQ(record.parameters, R"({"Speed":0.25})");
    EXPECT_EQ(record.missed_cycles, 0U);
    EXPECT_THAT(ways(record.number),
                ElementsAre("Ready>Running Executing", "Running>Halted HaltedError"));
}

TEST_F(RecordedProgram, ThatEndsWithItsServerWasHalted) {
    ASSERT_TRUE(program->start(kAlice));
    recorder.reset();
    const auto record = only();
    EXPECT_EQ(record.state, "Halted");
    EXPECT_THAT(record.reason_text, HasSubstr("the server was stopped"));
    EXPECT_TRUE(record.isOver());
}

}  // namespace
}  // namespace metier::records
