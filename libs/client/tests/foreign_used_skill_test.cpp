// Used skills of a server that names no executions.
#include <gmock/gmock.h>

#include <optional>

#include "metier/client/remote_server.hpp"
#include "metier/skill/testing/manual_executor.hpp"
#include "remote_skill/connection.hpp"
#include "remote_skill/remote_used_skill.hpp"
#include "served_lamps.hpp"

namespace metier::client {
namespace {

using composition::UsedSkillEnd;
using skill::State;
using ::testing::ElementsAre;

/// Keeps the end that it is notified of.
class End final : public composition::UsedSkillListener {
public:
    void onSuspended() override { ++suspended; }
    void onResumed() override { ++resumed; }
    void onEnd(UsedSkillEnd told) override { end = std::move(told); }

    int suspended = 0;
    int resumed = 0;
    std::optional<UsedSkillEnd> end;
};

/// Two lamps that a component uses.
class ForeignUsedSkills : public testing::LockedDevice {
protected:
    ~ForeignUsedSkills() override {
        left_.reset();
        right_.reset();
        connection_.reset();
        executor_->run();  // what is left over, so that it does not keep the executor
    }

    /// The server has all its nodes now.
    void connect() {
        const RemoteServerOptions options{.url = served_.url(), .name = "lights"};
        connection_.emplace(options, Connection::connect(options).value());
        left_ = use("Left");
        right_ = use("Right");
    }
    std::unique_ptr<RemoteUsedSkill> use(const std::string& lamp) {
        const auto link = std::make_shared<UsedSkillLink>(executor_);
        auto used =
            std::make_unique<RemoteUsedSkill>(*connection_, link, lamp + " of lights", "here.Test");
        const auto opened = connection_->open(lamps_.at(lamp).address, link).value();
        used->adopt(opened, opened->skill.now().value());
        return used;
    }
    void begin(RemoteUsedSkill& used, End& end) {
        used.begin({.execution_id = "here.Test/1/on/1", .parameters = {{"Level", 1.0}}}, end);
    }
    bool until(const std::function<bool()>& done) { return executor_->runUntil(done); }

    std::shared_ptr<skill::testing::ManualExecutor> executor_ =
        std::make_shared<skill::testing::ManualExecutor>();
    std::optional<Connection> connection_;
    std::unique_ptr<RemoteUsedSkill> left_;
    std::unique_ptr<RemoteUsedSkill> right_;
    End left_end_;
    End right_end_;
};

TEST_F(ForeignUsedSkills, SayWhatTheyLack) {
    connect();
    EXPECT_EQ(left_->lacks(), "no atomic start, no dead-man");
}

TEST_F(ForeignUsedSkills, OfADeviceWithALockStartAtomically) {
    addLock();
    connect();
    EXPECT_EQ(left_->lacks(), "no dead-man");
}

TEST_F(ForeignUsedSkills, ShareTheLockOfTheirDeviceUntilBothAreOver) {
    addLock();
    connect();
    begin(*left_, left_end_);
    ASSERT_TRUE(calls_.await("Left Start 1", 1));
    begin(*right_, right_end_);
    ASSERT_TRUE(calls_.await("Right Start 1", 1));
    end("Left");
    ASSERT_TRUE(until([this] { return left_end_.end.has_value(); }));
    EXPECT_EQ(left_end_.end->kind, UsedSkillEnd::Kind::finished);
    end("Right");
    ASSERT_TRUE(until([this] { return right_end_.end.has_value(); }));
    ASSERT_TRUE(calls_.await("ExitLock", 1));
    EXPECT_THAT(calls_.all(), ElementsAre("InitLock", "Left Start 1", "Right Start 1", "Left End",
                                          "Right End", "ExitLock"));
}

TEST_F(ForeignUsedSkills, ReportOnceThatTheyAreSuspendedAndResumed) {
    connect();
    begin(*left_, left_end_);
    ASSERT_TRUE(until([this] { return left_->state() == State::running; }));
    ASSERT_TRUE(left_->suspend());
    ASSERT_TRUE(until([this] { return left_end_.suspended > 0; }));
    ASSERT_TRUE(left_->resume());
    ASSERT_TRUE(until([this] { return left_end_.resumed > 0; }));
    end("Left");
    ASSERT_TRUE(until([this] { return left_end_.end.has_value(); }));
    EXPECT_EQ(left_end_.end->kind, UsedSkillEnd::Kind::finished);
    EXPECT_EQ(left_end_.suspended, 1);
    EXPECT_EQ(left_end_.resumed, 1);
}

TEST_F(ForeignUsedSkills, AreRefusedByTheLockOfAnotherClient) {
    addLock();
    connect();
    lock_status_ = -1;
    begin(*left_, left_end_);
    ASSERT_TRUE(until([this] { return left_end_.end.has_value(); }));
    EXPECT_EQ(left_end_.end->kind, UsedSkillEnd::Kind::refused);
    EXPECT_EQ(left_end_.end->text, "the device Light is locked by \"the panel\"");
}

TEST_F(ForeignUsedSkills, ThatRunOnWithoutTheirUserAreHaltedOnceTheConnectionIsBack) {
    connect();
    begin(*left_, left_end_);
    ASSERT_TRUE(calls_.await("Left Start 1", 1));
    ASSERT_TRUE(until([this] { return left_->state() == State::running; }));
    connection_->noteLoss(connection_->client(), "its events have ended");
    ASSERT_TRUE(until([this] { return left_end_.end.has_value(); }));
    EXPECT_EQ(left_end_.end->kind, UsedSkillEnd::Kind::lost);
    ASSERT_TRUE(until([this] { return left_->leftOver(); }));
    EXPECT_TRUE(calls_.await("Left Halt", 1));
    ASSERT_TRUE(until([this] { return left_->state() == State::halted; }));
    EXPECT_FALSE(right_->leftOver());
}

TEST_F(ForeignUsedSkills, ThatAnotherClientRunsAreLeftAlone) {
    connect();
    const auto& lamp = lamps_.at("Left").address;
    const auto start = served_.client().translate(lamp.node, {{1, "Start"}}).value();
    ASSERT_TRUE(served_.client().call(lamp.node, start));
    ASSERT_TRUE(until([this] { return left_->state() == State::running; }));
    connection_->noteLoss(connection_->client(), "its events have ended");
    ASSERT_TRUE(until([this] { return !left_->available(); }));
    ASSERT_TRUE(until([this] { return left_->available() && !connection_->awaySince(); }));
    EXPECT_FALSE(left_->leftOver());
    EXPECT_THAT(calls_.all(), ElementsAre("Left Start 0"));
}

}  // namespace
}  // namespace metier::client
