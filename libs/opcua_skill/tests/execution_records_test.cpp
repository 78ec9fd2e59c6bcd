// The last executions of a skill, as clients browse them.
#include <gmock/gmock.h>

#include "served_skills.hpp"

namespace metier::opcua_skill::testing {
namespace {

using ::testing::HasSubstr;

class ExecutionRecords : public ServedSkills {
protected:
    ExecutionRecords() : skill_(add(linearMoveDescription())) {
        if (const auto published = skills().publishRecords(); !published) {
            throw std::runtime_error(published.error().message);
        }
        serve();
        client_ = connect("the client");
        metier_ = client_->namespaceIndex("urn:metier:skills").value();
        watch_ = std::make_unique<TransitionWatch>(*client_, skill_.id);
    }

    Result<opcua::NodeId> node(const std::string& record, const char* property) {
        return client_->translate(
            skill_.id, {{metier_, "ExecutionRecords"}, {metier_, record}, {metier_, property}});
    }
    opcua::Value value(const std::string& record, const char* property) {
        return client_->read(node(record, property).value()).value();
    }
    std::string text(const std::string& record, const char* property) {
        const auto read = client_->read(node(record, property).value());
        return read ? read->toString() : read.error().status.name();
    }
    /// Starts the skill; the id of its execution.
    std::string start() {
        EXPECT_EQ(write(*client_, skill_, "ParameterSet/TargetPosition",
                        opcua::Value::of(opcua::ThreeDFrame{0.5, 0, 1, 0, 0, 0})),
                  "Good");
        EXPECT_EQ(call(*client_, skill_, "Start"), "Good");
        EXPECT_EQ(watch_->nextName(), "ReadyToRunning");
        EXPECT_TRUE(skill_.hand->await("start"));
        return skill_.hand->execution().id();
    }
    std::string run() {
        auto id = start();
        skill_.hand->execution().finish({{"ReachedPose", skill::Frame{0.5, 0, 1, 0, 0, 0}}});
        EXPECT_EQ(watch_->nextName(), "RunningToReady");
        return id;
    }

    static constexpr std::uint32_t kReady = 12;
    static constexpr std::uint32_t kHalted = 11;
    static constexpr std::uint32_t kRunning = 13;

    ServedSkill skill_;
    std::unique_ptr<opcua::Client> client_;
    std::uint16_t metier_ = 0;
    std::unique_ptr<TransitionWatch> watch_;
};

TEST_F(ExecutionRecords, HaveNoDataBeforeTheFirstExecution) {
    for (const char* property : {"ExecutionId", "SkillName", "Client", "StartTime", "EndState"}) {
        EXPECT_EQ(text("Latest", property), "BadNoData") << property;
        EXPECT_EQ(text("Latest-9", property), "BadNoData") << property;
    }
    EXPECT_FALSE(node("Latest-10", "ExecutionId"));
}

TEST_F(ExecutionRecords, ShowWhoStartedWhatAndHowItEnded) {
    const auto id = run();
    EXPECT_EQ(text("Latest", "ExecutionId"), id);
    EXPECT_EQ(text("Latest", "SkillName"), "CartesianLinearMoveSkill");
    EXPECT_EQ(text("Latest", "Client"), "the client");
    EXPECT_EQ(text("Latest", "ParentExecution"), "");
    EXPECT_EQ(value("Latest", "EndState"), opcua::Value::of(kReady));
    EXPECT_EQ(value("Latest", "Reason"),
              opcua::Value::of(static_cast<std::int32_t>(skill::Reason::finished)));
    EXPECT_THAT(text("Latest", "Parameters"),
                HasSubstr(R"("TargetPosition":{"x":0.5,"y":0,"z":1,"a":0,"b":0,"c":0})"));
    EXPECT_EQ(text("Latest", "Result"),
              R"({"ReachedPose":{"x":0.5,"y":0,"z":1,"a":0,"b":0,"c":0}})");
    EXPECT_LE(value("Latest", "StartTime").as<UtcTime>().value(),
              value("Latest", "EndTime").as<UtcTime>().value());
}

TEST_F(ExecutionRecords, ShowAnExecutionThatRunsWithoutAnEnd) {
    start();
    EXPECT_EQ(value("Latest", "EndState"), opcua::Value::of(kRunning));
    EXPECT_EQ(value("Latest", "EndTime").as<UtcTime>().value(), UtcTime::min());
    EXPECT_EQ(text("Latest", "Result"), "");
}

TEST_F(ExecutionRecords, TellWhyAnExecutionFailed) {
    start();
    skill_.hand->execution().fail(skill::Reason::limit_violated, "axis 2: 3.2 rad over 3.0 rad");
    ASSERT_EQ(watch_->nextName(), "RunningToHalted");
    EXPECT_EQ(value("Latest", "EndState"), opcua::Value::of(kHalted));
    EXPECT_EQ(value("Latest", "Reason"),
              opcua::Value::of(static_cast<std::int32_t>(skill::Reason::limit_violated)));
    EXPECT_EQ(text("Latest", "ReasonText"), "axis 2: 3.2 rad over 3.0 rad");
    EXPECT_EQ(text("Latest", "Result"), "");
}

TEST_F(ExecutionRecords, MoveBackOnePlaceWithEachExecution) {
    std::vector<std::string> ids;
    for (int i = 0; i < 12; ++i) {
        ids.push_back(run());
    }
    EXPECT_EQ(text("Latest", "ExecutionId"), ids[11]);
    EXPECT_EQ(text("Latest-1", "ExecutionId"), ids[10]);
    EXPECT_EQ(text("Latest-9", "ExecutionId"), ids[2]);
}

TEST_F(ExecutionRecords, OfARefusedStartThereIsNone) {
    skill_.hand->refuseStart({Errc::unreachable, "out of reach"});
    ASSERT_EQ(write(*client_, skill_, "ParameterSet/TargetPosition",
                    opcua::Value::of(opcua::ThreeDFrame{0.5, 0, 1, 0, 0, 0})),
              "Good");
    EXPECT_NE(call(*client_, skill_, "Start"), "Good");
    EXPECT_EQ(text("Latest", "ExecutionId"), "BadNoData");
}

TEST_F(ExecutionRecords, CannotBeWritten) {
    run();
    const auto written =
        client_->write(node("Latest", "Client").value(), opcua::Value::of("somebody else"));
    ASSERT_FALSE(written);
    EXPECT_EQ(text("Latest", "Client"), "the client");
}

}  // namespace
}  // namespace metier::opcua_skill::testing
