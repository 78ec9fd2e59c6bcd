// Events of a used skill that do not arrive: what became of it is asked, so that nothing waits.
#include <gmock/gmock.h>

#include <optional>

#include "bench_server.hpp"
#include "metier/client/remote_server.hpp"
#include "metier/skill/testing/manual_executor.hpp"
#include "remote_skill/connection.hpp"
#include "remote_skill/remote_used_skill.hpp"

namespace metier::client {
namespace {

using composition::UsedSkillEnd;
using skill::State;

const skill::Caller kPanel{"session", "panel", "user"};

class Listener final : public composition::UsedSkillListener {
public:
    void onEnd(UsedSkillEnd how) override { end = std::move(how); }

    std::optional<UsedSkillEnd> end;
};

class LostEvents : public ::testing::Test {
protected:
    LostEvents() {
        skill::SkillFunctions functions;
        functions.start = [this](const skill::ValueMap& /*parameters*/,
                                 const skill::ExecutionHandle& execution) {
            execution_ = execution;
        };
        program_ = &bench_.addSkill(system_tests::benchDescription("MoveSkill"), functions);
        bench_.serve();
        connection_.emplace(
            RemoteServerOptions{
                .url = bench_.url(), .name = "other", .session_timeout = std::chrono::minutes(1)},
            std::shared_ptr(system_tests::connectAs(bench_.url(), "component")));
        link_ = std::make_shared<UsedSkillLink>(executor_);
        used_.emplace(*connection_, link_, "MoveSkill of other", "here.Test");
        const auto address = client::findSkill(connection_->client(), "MoveSkill").value();
        const auto opened = connection_->open(address, link_).value();
        used_->adopt(opened, opened->skill.now().value());
        used_->begin({"here.Test/1/move/1", {{"TargetJointPosition", std::vector{0.1, 0.2}}}},
                     listener_);
        EXPECT_TRUE(until([this] { return used_->state() == State::running; }));
    }
    ~LostEvents() override {
        used_.reset();
        connection_.reset();
        executor_->run();  // what is left over, so that it does not keep the executor
    }
    static opcua::ServerLimits shortQueues() {
        opcua::ServerLimits limits;
        limits.event_queue = 3;
        return limits;
    }
    bool until(const std::function<bool()>& done) {
        return executor_->runUntil(done, std::chrono::seconds(30));
    }

    skill::ExecutionHandle execution_;  // used on the server's thread
    system_tests::BenchServer bench_{{.limits = shortQueues()}};
    skill::Program* program_ = nullptr;
    std::shared_ptr<skill::testing::ManualExecutor> executor_ =
        std::make_shared<skill::testing::ManualExecutor>();
    std::shared_ptr<UsedSkillLink> link_;
    std::optional<Connection> connection_;
    std::optional<RemoteUsedSkill> used_;
    Listener listener_;
};

TEST_F(LostEvents, OfAnEndThatTheServersQueueHasDroppedDoNotHideIt) {
    bench_.onServer([this] {
        execution_.fail(skill::Reason::error, "axis 2 is hot");
        bench_.server().post([this] {
            for (int i = 0; i < 10; ++i) {  // more than the queue keeps
                EXPECT_TRUE(program_->reset(kPanel));
                EXPECT_TRUE(program_->halt(kPanel));
            }
        });
    });
    ASSERT_TRUE(until([this] { return listener_.end.has_value(); }));
    EXPECT_EQ(listener_.end->kind, UsedSkillEnd::Kind::halted);
    EXPECT_EQ(listener_.end->text, "axis 2 is hot");
}

TEST_F(LostEvents, ThatHaveEndedAreTheLossOfTheSkillUntilTheComponentHasConnectedAgain) {
    // No loss of a connection: nothing else reports that it is away
    connection_->client().close();
    ASSERT_TRUE(until([this] { return listener_.end.has_value(); }));
    EXPECT_EQ(listener_.end->kind, UsedSkillEnd::Kind::lost);
    EXPECT_THAT(listener_.end->text, ::testing::HasSubstr("its events have ended"));
    EXPECT_TRUE(until([this] { return used_->available().has_value(); }));
}

}  // namespace
}  // namespace metier::client
