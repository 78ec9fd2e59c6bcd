#include "metier/client/control_handle.hpp"

#include <gmock/gmock.h>

#include <future>

#include "metier/base/queue.hpp"
#include "metier/client/skill_handle.hpp"
#include "metier/opcua/server.hpp"
#include "metier/opcua_skill/motion_device_system.hpp"
#include "metier/opcua_skill/skill_server.hpp"
#include "metier/skill/lambda_skill.hpp"

namespace metier::client {
namespace {

using namespace std::chrono_literals;
using skill::OwnerLossAction;
using skill::Reason;
using skill::State;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

SteadyTime soon() {
    return std::chrono::steady_clock::now() + 30s;
}

/// A server with one skill under control, and two clients. The skill works until it is stopped.
class ControlOfASkill : public ::testing::Test {
protected:
    ControlOfASkill() {
        opcua::ServerOptions options;
        options.port = 0;
        options.nodesets = {"device", "robotics", "metier"};
        server_ = opcua::Server::create(options).value();
        skills_ = opcua_skill::SkillServer::create(*server_, clock_).value();
        control_ = std::make_shared<skill::Control>(skills_->executor(), clock_);
        const auto system =
            opcua_skill::publishMotionDeviceSystem(server_->nodes(), {.name = "Arm",
                                                                      .description = "An arm",
                                                                      .manufacturer = "metier",
                                                                      .model = "Two axes",
                                                                      .axis_names = {"A", "B"}})
                .value();
        EXPECT_TRUE(skills_->publish(system.skills, makeSkill(), {.control = control_}));
        const auto served = skills_->serveControl(system.controller, control_);
        EXPECT_TRUE(served) << served.error().message;
        EXPECT_TRUE(server_->start());
        alice_ = connect("Alice");
        bob_ = connect("Bob");
    }
    ~ControlOfASkill() override {
        alice_.reset();
        bob_.reset();
        skills_.reset();
    }

    static std::unique_ptr<skill::Skill> makeSkill() {
        skill::SkillDescription description{.name = "JointPtpMoveSkill",
                                            .type = "JointPtpMoveSkillType",
                                            .parameters = {{.name = "TargetJointPosition",
                                                            .type = skill::ValueType::numbers,
                                                            .unit = skill::kRadian,
                                                            .range = skill::Range{-3, 3},
                                                            .length = skill::LengthLimit{2, 2}}},
                                            .results = {{.name = "Duration",
                                                         .type = skill::ValueType::number,
                                                         .unit = skill::kSecond,
                                                         .place = skill::Place::final_result}},
                                            .on_owner_loss = OwnerLossAction::halt};
        skill::SkillFunctions functions;
        functions.start = [](const skill::ValueMap& given,
                             const skill::ExecutionHandle& execution) {
            const auto& target = std::get<std::vector<double>>(given.at("TargetJointPosition"));
            if (target.front() == 0.0) {
                execution.finish({{"Duration", 0.25}});
            }
        };
        functions.suspend = [](const skill::ExecutionHandle& execution) -> Result<void> {
            execution.atRest();
            return {};
        };
        functions.resume = [](const skill::ExecutionHandle&) -> Result<void> { return {}; };
        return std::make_unique<skill::LambdaSkill>(description, functions);
    }

    std::unique_ptr<opcua::Client> connect(const std::string& name) {
        opcua::ClientOptions options;
        options.application_name = name;
        return opcua::Client::connect(server_->endpointUrl(), options).value();
    }
    static SkillHandle open(opcua::Client& client) {
        return std::move(
            SkillHandle::open(client, findSkill(client, "JointPtpMoveSkill").value()).value());
    }
    static opcua::Answer<ControlHandle> acquire(opcua::Client& client,
                                                const ControlOptions& options = {}) {
        const auto address = findSkill(client, "JointPtpMoveSkill").value();
        return ControlHandle::acquire(client, address.controller()->node, options);
    }

    static skill::StartRequest endless(const std::string& id = {}) {
        return {.execution_id = id,
                .parameters = {{"TargetJointPosition", std::vector<double>{1.0, 0.0}}}};
    }
    static skill::StartRequest brief(const std::string& id = {}) {
        return {.execution_id = id,
                .parameters = {{"TargetJointPosition", std::vector<double>{0.0, 0.0}}}};
    }

    SystemClock clock_;
    std::unique_ptr<opcua::Server> server_;
    std::unique_ptr<opcua_skill::SkillServer> skills_;
    std::shared_ptr<skill::Control> control_;  // shared with the Programs
    std::unique_ptr<opcua::Client> alice_;
    std::unique_ptr<opcua::Client> bob_;
};

TEST_F(ControlOfASkill, StartWithBringsItsParametersAndFindsItsExecutionAgain) {
    auto skill = open(*alice_);
    const auto result = skill.runWith(brief("order 66"), soon());
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_EQ(result->at("Duration"), skill::Value(0.25));
    auto other = open(*bob_);
    EXPECT_EQ(other.startWith(brief("order 66")).value(), "order 66") << "nothing starts again";
    const auto record = other.execution("order 66");
    ASSERT_TRUE(record) << record.error().message;
    EXPECT_EQ(record->state, State::ready);
    EXPECT_EQ(record->reason, Reason::finished);
    EXPECT_EQ(record->result.at("Duration"), skill::Value(0.25));
    EXPECT_GE(record->end_time, record->start_time);
    EXPECT_EQ(other.execution("order 67").error().code, Errc::not_found);
}

TEST_F(ControlOfASkill, StartWithTellsWhyItRefuses) {
    auto skill = open(*alice_);
    const auto out_of_range =
        skill.startWith({.parameters = {{"TargetJointPosition", std::vector<double>{4.0, 0.0}}}});
    ASSERT_FALSE(out_of_range);
    EXPECT_EQ(out_of_range.error().code, Errc::out_of_range);
    EXPECT_THAT(out_of_range.error().message, HasSubstr("4"));
    EXPECT_FALSE(skill.startWith({}));
    auto late = endless();
    late.deadline = std::chrono::system_clock::now() - 1s;
    EXPECT_EQ(skill.startWith(late).error().code, Errc::timeout);
    auto stale = endless();
    stale.epoch = 4711;
    EXPECT_EQ(skill.startWith(stale).error().code, Errc::locked);
    EXPECT_EQ(*skill.state(), State::ready);
}

TEST_F(ControlOfASkill, CheckAnswersLikeStartWithoutStarting) {
    auto skill = open(*alice_);
    const auto fine = skill.check(brief().parameters);
    ASSERT_TRUE(fine) << fine.error().message;
    EXPECT_TRUE(fine->possible);
    const auto over = skill.check({{"TargetJointPosition", std::vector<double>{4.0, 0.0}}});
    ASSERT_TRUE(over);
    EXPECT_FALSE(over->possible);
    EXPECT_THAT(over->reason, HasSubstr("TargetJointPosition"));
    EXPECT_EQ(*skill.state(), State::ready);
}

TEST_F(ControlOfASkill, OneClientKeepsTheOthersOutButNotTheirHalt) {
    const auto control = acquire(*alice_);
    ASSERT_TRUE(control) << control.error().message;
    const auto second = acquire(*bob_);
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, Errc::locked);
    EXPECT_THAT(second.error().message, HasSubstr("Alice"));
    auto bobs = open(*bob_);
    EXPECT_EQ(bobs.startWith(endless()).error().code, Errc::locked);
    EXPECT_EQ(bobs.set("TargetJointPosition", std::vector<double>{0, 0}).error().code,
              Errc::locked);
    EXPECT_FALSE(*bobs.executable(skill::Method::start));
    auto alices = open(*alice_);
    auto request = endless();
    request.epoch = control->epoch();
    ASSERT_TRUE(alices.startWith(request));
    EXPECT_FALSE(bobs.suspend());
    EXPECT_TRUE(bobs.halt());
    EXPECT_TRUE(bobs.awaitState(State::halted, soon()));
}

TEST_F(ControlOfASkill, NeedsALeaseThatHeartbeatsCanKeep) {
    for (const auto lease : {-1ms, 0ms, 99ms, 3'600'001ms}) {
        const auto control = acquire(*alice_, {.lease = lease});
        ASSERT_FALSE(control) << lease.count();
        EXPECT_THAT(control.error().message, HasSubstr("100 to 3600000 ms"));
    }
    EXPECT_TRUE(acquire(*alice_, {.lease = 100ms}));
}

/// Whether a lease that was acquired now is kept for three times its length.
bool outlivesItsLease(ControlHandle acquired) {
    std::promise<void> lost;
    auto control = std::move(acquired);  // ends before what it calls
    control.onLost([&](const opcua::Failure&) { lost.set_value(); });
    return lost.get_future().wait_for(3s) == std::future_status::timeout && control.held();
}

TEST_F(ControlOfASkill, LastsWithHeartbeatsAndIsGivenBackAtTheEnd) {
    bool lasts = false;
    for (int i = 0; i < 5 && !lasts; ++i) {  // the machine does not hold up all of them
        auto control = acquire(*alice_);
        ASSERT_TRUE(control);
        lasts = outlivesItsLease(std::move(*control));
    }
    EXPECT_TRUE(lasts);
    EXPECT_TRUE(acquire(*bob_));
}

TEST_F(ControlOfASkill, WithoutAHeartbeatTheSkillOfItsHolderIsHaltedInTime) {
    // Acquired by a plain call, so that no heartbeats are sent.
    const auto controller = findSkill(*alice_, "JointPtpMoveSkill").value().controller()->node;
    const auto index = alice_->namespaceIndex("urn:metier:skills").value();
    const auto method = alice_->translate(controller, {{index, "AcquireControl"}}).value();
    Queue<std::pair<skill::TransitionEvent, SteadyTime>> seen(10);
    auto watcher = open(*bob_);
    watcher.onTransition([&](const auto& event) {
        seen.tryPush({event, std::chrono::steady_clock::now()});
    });
    auto skill = open(*alice_);
    const auto before = std::chrono::steady_clock::now();
    ASSERT_TRUE(
        alice_->call(controller, method,
                     {opcua::Value::of(std::uint32_t{3'000}), opcua::Value::of(std::int32_t{0})}));
    ASSERT_TRUE(skill.startWith(endless()));
    EXPECT_EQ(seen.popUntil(soon())->first.to, State::running);
    const auto halted = seen.popUntil(soon());
    ASSERT_TRUE(halted);
    EXPECT_EQ(halted->first.to, State::halted);
    EXPECT_EQ(halted->first.reason, Reason::owner_lost);
    EXPECT_THAT(halted->first.reason_text, HasSubstr("no heartbeat"));
    EXPECT_GE(halted->second - before, 3s);
}

TEST_F(ControlOfASkill, ASessionThatEndsIsTheLossOfItsOwner) {
    Queue<skill::TransitionEvent> seen(10);
    auto watcher = open(*bob_);
    watcher.onTransition([&](const auto& event) { seen.tryPush(event); });
    {
        auto carol = connect("Carol");
        auto skill = open(*carol);
        auto request = endless();
        request.on_owner_loss = OwnerLossAction::suspend;
        ASSERT_TRUE(skill.startWith(request));
    }
    EXPECT_EQ(seen.popUntil(soon())->to, State::running);
    const auto suspended = seen.popUntil(soon());
    ASSERT_TRUE(suspended);
    EXPECT_EQ(suspended->to, State::suspended);
    EXPECT_EQ(suspended->reason, Reason::owner_lost);
    EXPECT_TRUE(watcher.resume()) << "anybody may take over";
    EXPECT_TRUE(watcher.halt());
    EXPECT_TRUE(watcher.awaitState(State::halted, soon()));
    watcher.onTransition({});
}

}  // namespace
}  // namespace metier::client
