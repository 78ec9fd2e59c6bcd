// A client of skills whose server is started again, or whose network is cut, at the worst moments.
#include <gmock/gmock.h>

#include <atomic>
#include <future>
#include <mutex>

#include "metier/base/queue.hpp"
#include "metier/client/control_handle.hpp"
#include "metier/client/skill_handle.hpp"
#include "metier/opcua/server.hpp"
#include "metier/opcua_skill/motion_device_system.hpp"
#include "metier/opcua_skill/skill_server.hpp"
#include "metier/skill/lambda_skill.hpp"
#include "tcp_relay.hpp"

namespace metier::client {
namespace {

using namespace std::chrono_literals;
using metier::testing::TcpRelay;
using opcua::ConnectionChange;
using skill::Reason;
using skill::State;
using ::testing::HasSubstr;
using Delivery = opcua::Failure::Delivery;
using Change = ConnectionChange::Kind;

SteadyTime soon() {
    return std::chrono::steady_clock::now() + 60s;
}

/// Totals over all runs of the server.
class Works {
public:
    void begin(const skill::ExecutionHandle& execution) {
        ++begun_;
        const std::lock_guard lock(mutex_);
        current_ = execution;
    }
    int begun() const { return begun_; }
    void finish() { current().finish({{"Duration", 0.25}}); }
    void fail() { current().fail(Reason::error, "axis 2 is hot: 91 °C"); }

private:
    skill::ExecutionHandle current() {
        const std::lock_guard lock(mutex_);
        return current_;
    }

    std::atomic<int> begun_ = 0;
    std::mutex mutex_;
    skill::ExecutionHandle current_;
};

skill::SkillDescription description() {
    return {.name = "JointPtpMoveSkill",
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
            .on_owner_loss = skill::OwnerLossAction::halt};
}

/// One run of a server with one skill that works until the test ends it.
class ServedSkill {
public:
    ServedSkill(std::uint16_t port, Works& works, std::vector<std::string> namespaces = {}) {
        opcua::ServerOptions options;
        options.port = port;
        options.nodesets = {"device", "robotics", "metier"};
        options.namespaces = std::move(namespaces);
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
        skill::SkillFunctions functions;
        functions.start = [&works](const skill::ValueMap&,
                                   const skill::ExecutionHandle& execution) {
            works.begin(execution);
        };
        functions.suspend = [](const skill::ExecutionHandle& execution) -> Result<void> {
            execution.atRest();
            return {};
        };
        functions.resume = [](const skill::ExecutionHandle&) -> Result<void> { return {}; };
        EXPECT_TRUE(skills_->publish(system.skills,
                                     std::make_unique<skill::LambdaSkill>(description(), functions),
                                     {.control = control_}));
        EXPECT_TRUE(skills_->serveControl(system.controller, control_));
        EXPECT_TRUE(server_->start());
    }
    ~ServedSkill() { skills_.reset(); }
    ServedSkill(const ServedSkill&) = delete;
    ServedSkill& operator=(const ServedSkill&) = delete;

    std::string url() const { return server_->endpointUrl(); }
    std::uint16_t port() const {
        return static_cast<std::uint16_t>(std::stoi(url().substr(url().rfind(':') + 1)));
    }

private:
    SystemClock clock_;
    std::unique_ptr<opcua::Server> server_;
    std::unique_ptr<opcua_skill::SkillServer> skills_;
    std::shared_ptr<skill::Control> control_;  // shared with the Program
};

using Outcome = opcua::Answer<skill::ValueMap>;

/// A client behind a network that can be cut; the bystander sees the server whatever happens there.
class SurvivingClient : public ::testing::Test {
protected:
    SurvivingClient() {
        client_->onConnectionChange(
            [this](const ConnectionChange& change) { changes_.tryPush(change); });
    }

    static std::unique_ptr<opcua::Client> connect(const std::string& url) {
        opcua::ClientOptions options;
        options.session_timeout = 20s;
        options.publishing_interval = 20ms;
        options.reconnect = opcua::ReconnectOptions{.shortest_pause = 20ms, .longest_pause = 200ms};
        return opcua::Client::connect(url, options).value();
    }
    static SkillHandle open(opcua::Client& client) {
        return std::move(
            SkillHandle::open(client, findSkill(client, "JointPtpMoveSkill").value()).value());
    }
    static skill::StartRequest request(const std::string& id = {}) {
        return {.execution_id = id,
                .parameters = {{"TargetJointPosition", std::vector<double>{1.0, 0.0}}},
                .on_owner_loss = skill::OwnerLossAction::keep_going};
    }
    std::future<Outcome> runInBackground(const std::string& id = {}) {
        return std::async(std::launch::async,
                          [this, id] { return skill_.runWith(request(id), soon()); });
    }
    std::future<Outcome> runUntilRunning(const std::string& id = {}) {
        auto outcome = runInBackground(id);
        EXPECT_TRUE(bystanding_.awaitState(State::running, soon()));
        return outcome;
    }
    ConnectionChange nextIs(Change kind) {
        auto change = changes_.popUntil(soon()).value();
        EXPECT_EQ(change.kind, kind) << change.why.message;
        return change;
    }
    void cut() {
        relay_.cut();
        nextIs(Change::lost);
    }
    void comeBack() {
        relay_.pass();
        nextIs(Change::back);
    }
    void restart(const std::vector<std::string>& namespaces = {}) {
        const auto port = served_->port();
        served_.reset();
        served_ = std::make_unique<ServedSkill>(port, works_, namespaces);
        nextIs(Change::lost);
        EXPECT_TRUE(nextIs(Change::back).server_restarted);
        ASSERT_TRUE(bystander_->awaitConnected(soon()));
    }

    Works works_;
    std::unique_ptr<ServedSkill> served_ = std::make_unique<ServedSkill>(0, works_);
    TcpRelay relay_{served_->port()};
    Queue<ConnectionChange> changes_{100};
    std::unique_ptr<opcua::Client> bystander_ = connect(served_->url());
    SkillHandle bystanding_ = open(*bystander_);
    std::unique_ptr<opcua::Client> client_ = connect(relay_.url());
    SkillHandle skill_ = open(*client_);
};

TEST_F(SurvivingClient, LearnsTheResultOfWhatFinishedWhileItWasAway) {
    auto outcome = runUntilRunning();
    cut();
    works_.finish();
    ASSERT_TRUE(bystanding_.awaitState(State::ready, soon()));
    comeBack();
    const auto result = outcome.get();
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_EQ(result->at("Duration"), skill::Value(0.25));
    EXPECT_EQ(works_.begun(), 1);
}

TEST_F(SurvivingClient, LearnsWhyWhatItStartedWasHaltedWhileItWasAway) {
    auto outcome = runUntilRunning();
    cut();
    works_.fail();
    ASSERT_TRUE(bystanding_.awaitState(State::halted, soon()));
    comeBack();
    const auto result = outcome.get();
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, Errc::device_fault);
    EXPECT_THAT(result.error().message, HasSubstr("91 °C"));
}

TEST_F(SurvivingClient, GoesOnWaitingForWhatStillRuns) {
    auto outcome = runUntilRunning();
    cut();
    comeBack();
    EXPECT_EQ(*bystanding_.state(), State::running);
    works_.finish();
    const auto result = outcome.get();
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_EQ(works_.begun(), 1);
}

TEST_F(SurvivingClient, GoesOnWaitingForWhatWasSuspendedAndIsResumedByAnother) {
    auto outcome = runUntilRunning();
    ASSERT_TRUE(bystanding_.suspend());
    ASSERT_TRUE(bystanding_.awaitState(State::suspended, soon()));
    cut();
    comeBack();
    EXPECT_EQ(*bystanding_.state(), State::suspended) << "nobody resumed it";
    ASSERT_TRUE(bystanding_.resume());
    works_.finish();
    EXPECT_TRUE(outcome.get());
}

TEST_F(SurvivingClient, LearnsThatASuspendedExecutionWasGivenUpMeanwhile) {
    auto outcome = runUntilRunning();
    ASSERT_TRUE(bystanding_.suspend());
    ASSERT_TRUE(bystanding_.awaitState(State::suspended, soon()));
    cut();
    ASSERT_TRUE(bystanding_.reset());
    comeBack();
    const auto result = outcome.get();
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, Errc::cancelled);
}

TEST_F(SurvivingClient, IsToldThatTheMotionIsOverWhenTheServerWasStartedAgain) {
    auto outcome = runUntilRunning("order 66");
    restart();
    const auto result = outcome.get();
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, Errc::execution_lost);
    EXPECT_THAT(result.error().message, HasSubstr("order 66"));
    EXPECT_THAT(result.error().message, HasSubstr("not resumed, the motion is over"));
    EXPECT_EQ(*bystanding_.state(), State::ready);
    EXPECT_EQ(works_.begun(), 1) << "nothing was started again";
}

TEST_F(SurvivingClient, IsGoodForAnotherRunAfterARestartThatMovedItsNodes) {
    for (int run = 1; run < 4; ++run) {
        auto outcome = runUntilRunning();
        works_.finish();
        const auto result = outcome.get();
        ASSERT_TRUE(result) << result.error().message;
        EXPECT_EQ(works_.begun(), run);
        restart({"urn:metier:test:" + std::to_string(run), "urn:metier:test:more"});
    }
}

TEST_F(SurvivingClient, KnowsThatAStartThatDidNotArriveMovedNothing) {
    relay_.cutAt("order 66", TcpRelay::Moment::before);
    auto outcome = runInBackground("order 66");
    ASSERT_TRUE(relay_.awaitCut(soon()));
    nextIs(Change::lost);
    comeBack();
    const auto result = outcome.get();
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, Errc::connection_lost);
    EXPECT_EQ(result.error().delivery, Delivery::not_sent);
    EXPECT_THAT(result.error().message, HasSubstr("nothing was started"));
    EXPECT_EQ(works_.begun(), 0);
}

TEST_F(SurvivingClient, FindsTheExecutionWhoseStartWasNotAnswered) {
    relay_.cutAt("order 66", TcpRelay::Moment::after);
    auto outcome = runInBackground("order 66");
    ASSERT_TRUE(relay_.awaitCut(soon()));
    nextIs(Change::lost);
    ASSERT_TRUE(bystanding_.awaitState(State::running, soon()));
    comeBack();
    works_.finish();
    const auto result = outcome.get();
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_EQ(works_.begun(), 1);
}

TEST_F(SurvivingClient, StartsAtMostOnceHoweverOftenItsUserAsks) {
    relay_.cutAt("order 66", TcpRelay::Moment::after);
    const auto first = skill_.startWith(request("order 66"));
    ASSERT_FALSE(first);
    EXPECT_EQ(first.error().delivery, Delivery::unknown);
    EXPECT_THAT(first.error().message, HasSubstr("unknown whether it was carried out"));
    nextIs(Change::lost);
    EXPECT_EQ(skill_.startWith(request("order 66")).error().delivery, Delivery::not_sent);
    comeBack();
    EXPECT_EQ(skill_.startWith(request("order 66")).value(), "order 66");
    works_.finish();
    ASSERT_TRUE(bystanding_.awaitState(State::ready, soon()));
    const auto again = skill_.runWith(request("order 66"), soon());
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->at("Duration"), skill::Value(0.25));
    EXPECT_EQ(works_.begun(), 1);
}

TEST_F(SurvivingClient, SendsNoCommandLater) {
    auto outcome = runUntilRunning();
    ASSERT_TRUE(bystanding_.suspend());
    ASSERT_TRUE(bystanding_.awaitState(State::suspended, soon()));
    cut();
    for (const auto method : {skill::Method::resume, skill::Method::reset, skill::Method::halt}) {
        const auto called = skill_.call(method);
        ASSERT_FALSE(called);
        EXPECT_EQ(called.error().delivery, Delivery::not_sent);
    }
    comeBack();
    EXPECT_EQ(*skill_.state(), State::suspended);
    ASSERT_TRUE(bystanding_.halt());
    EXPECT_EQ(outcome.get().error().code, Errc::cancelled);
}

TEST_F(SurvivingClient, WaitsNoLongerThanItsDeadlineForTheConnection) {
    relay_.cutAt("order 66", TcpRelay::Moment::after);
    const auto result = skill_.runWith(request("order 66"), std::chrono::steady_clock::now() + 2s);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().delivery, Delivery::unknown);
    EXPECT_THAT(result.error().message, HasSubstr("unknown what became of the execution"));
    const auto reached = skill_.awaitState(State::ready, std::chrono::steady_clock::now() + 50ms);
    EXPECT_EQ(reached.error().code, Errc::connection_lost);
    EXPECT_TRUE(bystanding_.awaitState(State::running, soon()));
}

TEST_F(SurvivingClient, SaysAtItsDeadlineThatNobodyKnowsWhatBecameOfWhatItCouldNotHalt) {
    auto outcome = std::async(std::launch::async, [this] {
        return skill_.runWith(request(), std::chrono::steady_clock::now() + 8s);
    });
    ASSERT_TRUE(bystanding_.awaitState(State::running, soon()));
    // Answers come in their order: that of the start is there.
    ASSERT_TRUE(client_->read(skill_.address().node, opcua::AttributeId::browse_name));
    cut();
    const auto result = outcome.get();
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().delivery, Delivery::unknown);
    EXPECT_THAT(result.error().message, HasSubstr("unknown what became of the execution"));
    EXPECT_THAT(result.error().message, HasSubstr("Halt did not reach it"));
    EXPECT_EQ(*bystanding_.state(), State::running);
}

TEST_F(SurvivingClient, DoesNotKnowTheEndOfWhatItResumedIfTheConnectionStaysAway) {
    ASSERT_TRUE(skill_.startWith(request()));
    cut();
    const auto end = skill_.awaitEnd(std::chrono::steady_clock::now() + 200ms);
    ASSERT_FALSE(end);
    EXPECT_EQ(end.error().delivery, Delivery::unknown);
    EXPECT_THAT(end.error().message, HasSubstr("unknown what became of the execution"));
}

TEST_F(SurvivingClient, SeesAStateThatWasReachedWhileItWasAway) {
    ASSERT_TRUE(skill_.startWith(request()));
    auto reached =
        std::async(std::launch::async, [this] { return skill_.awaitState(State::halted, soon()); });
    cut();
    ASSERT_TRUE(bystanding_.halt());
    ASSERT_TRUE(bystanding_.awaitState(State::halted, soon()));
    relay_.pass();
    EXPECT_TRUE(reached.get());
}

TEST_F(SurvivingClient, DoesNotTakeControlAgainByItself) {
    const auto controller = skill_.address().controller()->node;
    auto control = ControlHandle::acquire(*client_, controller, {}).value();
    const auto epoch = control.epoch();
    std::promise<opcua::Failure> lost;
    control.onLost([&](const opcua::Failure& failure) { lost.set_value(failure); });
    cut();
    auto told = lost.get_future();
    ASSERT_EQ(told.wait_for(60s), std::future_status::ready);
    EXPECT_EQ(told.get().code, Errc::connection_lost);
    control.onLost(nullptr);  // the callback must not be called again, and is not
    comeBack();
    EXPECT_FALSE(control.held());
    auto again = ControlHandle::acquire(*client_, controller, {});
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_NE(again->epoch(), epoch);
    auto stale = request();
    stale.epoch = epoch;
    EXPECT_EQ(skill_.startWith(stale).error().code, Errc::locked) << "it moves nothing any more";
    EXPECT_EQ(works_.begun(), 0);
}

TEST_F(SurvivingClient, LosesControlWhenItsHeartbeatsAreNotAnswered) {
    const auto controller = skill_.address().controller()->node;
    auto control = ControlHandle::acquire(*client_, controller, {.lease = 300ms}).value();
    std::promise<void> lost;
    control.onLost([&](const opcua::Failure& /*failure*/) { lost.set_value(); });
    relay_.stall();
    EXPECT_EQ(lost.get_future().wait_for(60s), std::future_status::ready);
    EXPECT_FALSE(control.held());
}

}  // namespace
}  // namespace metier::client
