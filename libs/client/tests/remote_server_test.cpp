// UsedSkills of another server; its skills are the test's.
#include "metier/client/remote_server.hpp"

#include <gmock/gmock.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>

#include "metier/skill/testing/manual_executor.hpp"
#include "remote_skill/connection.hpp"
#include "remote_skill/remote_used_skill.hpp"
#include "served_skills.hpp"

namespace metier::client {
namespace {

using namespace std::chrono_literals;
using composition::UsedSkillEnd;
using opcua_skill::testing::ServedSkill;
using skill::Reason;
using skill::State;
using ::testing::HasSubstr;

/// Keeps all that it is notified of.
class Listener final : public composition::UsedSkillListener {
public:
    void onReset(const Result<void>& outcome) override { reset = outcome; }
    void onStopping(const composition::UsedSkillStop& stop) override { stops.push_back(stop); }
    void onSuspended() override { suspended = true; }
    void onResumed() override { suspended = false; }
    void onRefused(skill::Method method, const Error& error) override {
        refusal = std::string(toString(method)) + ": " + error.message;
    }
    void onEnd(UsedSkillEnd told) override { end = std::move(told); }

    std::optional<Result<void>> reset;
    std::vector<composition::UsedSkillStop> stops;
    bool suspended = false;
    std::string refusal;
    std::optional<UsedSkillEnd> end;
};

class RemoteUsedSkillTest : public opcua_skill::testing::ServedSkills {
protected:
    RemoteUsedSkillTest() : move_(add(description())) {
        serve();
        remote_ = RemoteServer::connect(
                      {.url = server().endpointUrl(), .name = "other", .session_timeout = 1min},
                      executor_)
                      .value();
        used_ = use("here.Test");
    }
    ~RemoteUsedSkillTest() override {
        used_.reset();
        remote_.reset();
        executor_->run();  // what is left over, so that it does not keep the executor
    }

    static skill::SkillDescription description() {
        auto description = opcua_skill::testing::jointMoveDescription();
        description.on_owner_loss = skill::OwnerLossAction::keep_going;
        return description;
    }
    std::unique_ptr<composition::UsedSkill> use(const std::string& origin) {
        return remote_->use(remote_->skills().value().front(), origin).value();
    }
    void begin(const std::string& id) {
        used_->begin({id, {{"TargetJointPosition", std::vector<double>{0.1, 0.2}}}}, listener_);
    }
    void beginAndAwait(const std::string& id) {
        begin(id);
        ASSERT_TRUE(move_.hand->await("start"));
        ASSERT_TRUE(until([this] { return used_->state() == State::running; }));
    }
    bool until(const std::function<bool()>& done) { return executor_->runUntil(done, 30s); }

    std::shared_ptr<skill::testing::ManualExecutor> executor_ =
        std::make_shared<skill::testing::ManualExecutor>();
    ServedSkill move_;
    std::unique_ptr<RemoteServer> remote_;
    Listener listener_;
    std::unique_ptr<composition::UsedSkill> used_;
};

TEST_F(RemoteUsedSkillTest, RunsToItsResult) {
    EXPECT_EQ(used_->name(), "JointPtpMoveSkill of other");
    EXPECT_FALSE(remote_->awaySince());
    beginAndAwait("here.Test/1/move/1");
    EXPECT_EQ(move_.hand->execution().id(), "here.Test/1/move/1");
    EXPECT_EQ(move_.hand->snapshot().at("TargetJointPosition"),
              skill::Value(std::vector<double>{0.1, 0.2}));
    skill::ValueMap result;
    for (const auto& field : description().results) {
        if (field.type == skill::ValueType::number) {
            result.emplace(field.name, 1.5);
        }
    }
    ASSERT_FALSE(result.empty());
    move_.hand->execution().finish(result);
    ASSERT_TRUE(until([this] { return listener_.end.has_value(); }));
    EXPECT_EQ(listener_.end->kind, UsedSkillEnd::Kind::finished);
    for (const auto& [name, value] : result) {
        EXPECT_EQ(listener_.end->result.at(name), value);
    }
    EXPECT_EQ(used_->state(), State::ready);
}

TEST_F(RemoteUsedSkillTest, TellsARefusedStartInTheServersWords) {
    move_.hand->refuseStart({Errc::unreachable, "2 m is beyond the reach of 1 m"});
    begin("here.Test/1/move/1");
    ASSERT_TRUE(until([this] { return listener_.end.has_value(); }));
    EXPECT_EQ(listener_.end->kind, UsedSkillEnd::Kind::refused);
    EXPECT_EQ(listener_.end->text, "2 m is beyond the reach of 1 m");
}

TEST_F(RemoteUsedSkillTest, IsSuspendedResumedAndHalted) {
    beginAndAwait("here.Test/1/move/1");
    ASSERT_TRUE(used_->suspend());
    ASSERT_TRUE(move_.hand->await("suspend"));
    move_.hand->execution().atRest();
    ASSERT_TRUE(until([this] { return listener_.suspended; }));
    ASSERT_TRUE(used_->resume());
    ASSERT_TRUE(until([this] { return !listener_.suspended; }));
    used_->halt();
    ASSERT_TRUE(move_.hand->await("halt"));
    move_.hand->execution().atRest();
    ASSERT_TRUE(until([this] { return listener_.end.has_value(); }));
    EXPECT_EQ(listener_.end->kind, UsedSkillEnd::Kind::halted);
    EXPECT_EQ(listener_.end->reason, Reason::by_client);
    ASSERT_TRUE(used_->reset(listener_));
    ASSERT_TRUE(until([this] { return listener_.reset.has_value(); }));
    EXPECT_TRUE(*listener_.reset);
    EXPECT_EQ(used_->state(), State::ready);
}

TEST_F(RemoteUsedSkillTest, HearsThatAnotherClientBringsItToRestBeforeItStands) {
    beginAndAwait("here.Test/1/move/1");
    const auto panel = connect("panel");
    ASSERT_EQ(call(*panel, move_, "Suspend"), "Good");
    ASSERT_TRUE(until([this] { return !listener_.stops.empty(); }));
    EXPECT_FALSE(listener_.suspended);
    EXPECT_EQ(listener_.stops[0].to, State::suspended);
    EXPECT_EQ(listener_.stops[0].reason, Reason::by_client);
    EXPECT_EQ(listener_.stops[0].text, "by panel");
    ASSERT_EQ(call(*panel, move_, "Halt"), "Good");
    ASSERT_TRUE(until([this] { return listener_.stops.size() == 2; }));
    EXPECT_EQ(listener_.stops[1].to, State::halted);
    move_.hand->execution().atRest();
    ASSERT_TRUE(until([this] { return listener_.end.has_value(); }));
}

TEST_F(RemoteUsedSkillTest, HaltsRightAfterItsStartWasAskedFor) {
    begin("here.Test/1/move/1");
    used_->halt();
    EXPECT_TRUE(until([&] { return used_->state() == State::running; }));
    ASSERT_TRUE(move_.hand->await("halt"));
    move_.hand->execution().atRest();
    ASSERT_TRUE(until([this] { return listener_.end.has_value(); }));
    EXPECT_EQ(listener_.end->kind, UsedSkillEnd::Kind::halted);
}

TEST_F(RemoteUsedSkillTest, TellsARefusedReset) {
    beginAndAwait("here.Test/1/move/1");
    move_.hand->execution().fail(Reason::error, "stuck");
    ASSERT_TRUE(until([this] { return listener_.end.has_value(); }));
    EXPECT_EQ(listener_.end->text, "stuck");
    move_.hand->refuseReset({Errc::device_fault, "the emergency stop is pressed"});
    ASSERT_TRUE(used_->reset(listener_));
    ASSERT_TRUE(until([this] { return listener_.reset.has_value(); }));
    ASSERT_FALSE(*listener_.reset);
    EXPECT_EQ(listener_.reset->error().message, "the emergency stop is pressed");
}

TEST_F(RemoteUsedSkillTest, TellsTheServersWordsWhenResumeIsRefusedToIt) {
    beginAndAwait("here.Test/1/move/1");
    ASSERT_TRUE(used_->resume()) << "it is sent; the server refuses it, since it is Running";
    ASSERT_TRUE(until([this] { return !listener_.refusal.empty(); }));
    EXPECT_THAT(listener_.refusal, HasSubstr("Resume: Resume is not possible while Running"));
}

TEST_F(RemoteUsedSkillTest, TellsNobodyTheAnswerToAResetThatIsGivenUp) {
    beginAndAwait("here.Test/1/move/1");
    move_.hand->execution().fail(Reason::error, "stuck");
    ASSERT_TRUE(until([this] { return listener_.end.has_value(); }));
    move_.hand->refuseReset({Errc::device_fault, "the emergency stop is pressed"});
    ASSERT_TRUE(used_->reset(listener_));
    ASSERT_TRUE(move_.hand->await("reset"));
    used_->release();
    move_.hand->allowReset();
    Listener next;
    ASSERT_TRUE(used_->reset(next));
    ASSERT_TRUE(move_.hand->await("reset")) << "the next one is sent, too";
    ASSERT_TRUE(until([&] { return next.reset.has_value(); }));
    EXPECT_TRUE(*next.reset) << "the answer to its own Reset, not to the one before";
    EXPECT_FALSE(listener_.reset);
}

TEST_F(RemoteUsedSkillTest, TakesASkillThatIsReadyMeanwhileForReset) {
    beginAndAwait("here.Test/1/move/1");
    move_.hand->execution().fail(Reason::error, "stuck");
    ASSERT_TRUE(until([this] { return listener_.end.has_value(); }));
    ASSERT_TRUE(used_->reset(listener_));
    ASSERT_TRUE(move_.hand->await("reset"));
    Listener next;  // its Reset comes to a skill that is Ready
    ASSERT_TRUE(used_->reset(next));
    ASSERT_TRUE(until([&] { return next.reset.has_value(); }));
    EXPECT_TRUE(*next.reset);
    EXPECT_EQ(used_->state(), State::ready);
}

TEST_F(RemoteUsedSkillTest, TellsARefusalToNoOtherExecution) {
    // A Resume that was refused when its execution had just ended made the next one fail.
    beginAndAwait("here.Test/1/move/1");
    const auto before = executor_->posts();
    ASSERT_TRUE(used_->resume()) << "it is Running: refused";
    ASSERT_TRUE(executor_->awaitPosts(before + 1));
    move_.hand->execution().fail(Reason::error, "stuck");
    ASSERT_TRUE(executor_->awaitPosts(before + 2)) << "the end, right behind the refusal";
    ASSERT_TRUE(until([this] { return listener_.end.has_value(); }));
    listener_ = {};
    begin("here.Test/2/move/1");  // it is Halted: refused, later than the Resume
    ASSERT_TRUE(until([this] { return listener_.end.has_value(); }));
    EXPECT_EQ(listener_.end->kind, UsedSkillEnd::Kind::refused);
    EXPECT_EQ(listener_.refusal, "");
}

TEST_F(RemoteUsedSkillTest, SuspendsRightAfterItsStartWasAskedFor) {
    begin("here.Test/1/move/1");
    ASSERT_TRUE(used_->suspend());
    EXPECT_TRUE(until([&] { return used_->state() == State::running; }));
    ASSERT_TRUE(move_.hand->await("suspend"));
    move_.hand->execution().atRest();
    ASSERT_TRUE(until([this] { return listener_.suspended; }));
    EXPECT_FALSE(listener_.end);
}

TEST_F(RemoteUsedSkillTest, ChecksWithoutMoving) {
    std::optional<Result<skill::CheckReport>> report;
    const auto checked = [&](Result<skill::CheckReport> answer) { report = std::move(answer); };
    used_->check({.parameters = {{"TargetJointPosition", std::vector<double>{0.1, 0.2}}}}, checked);
    EXPECT_FALSE(report) << "in a later turn";
    ASSERT_TRUE(until([&] { return report.has_value(); }));
    ASSERT_TRUE(*report) << report->error().message;
    EXPECT_TRUE((*report)->possible);
    report.reset();
    used_->check({.parameters = {{"TargetJointPosition", std::vector<double>{9.0, 0.2}}}}, checked);
    ASSERT_TRUE(until([&] { return report.has_value(); }));
    EXPECT_TRUE(!*report || !(*report)->possible) << "9 rad is over the limit of 3 rad";
    EXPECT_EQ(used_->state(), State::ready);
}

TEST_F(RemoteUsedSkillTest, AsksAgainUntilASkillThatAsksOthersHasAnswered) {
    move_.hand->keepChecks();
    const auto url = used_->serverUrl();
    std::optional<Result<skill::CheckReport>> report;
    used_->check({.parameters = {{"TargetJointPosition", std::vector<double>{0.1, 0.2}}},
                  .starts = {{url, {1.0, 2.0}}, {"opc.tcp://else:1", {3.0}}, {"", {4.0}}}},
                 [&](Result<skill::CheckReport> answer) { report = std::move(answer); });
    ASSERT_TRUE(move_.hand->await("check"));
    EXPECT_EQ(move_.hand->checkedStarts(),
              (skill::ArmPositions{{"", {1.0, 2.0}}, {"opc.tcp://else:1", {3.0}}}))
        << "as that server names them; it knows nothing of the arm of this one";
    // Its first answer is that it is not done.
    ASSERT_TRUE(until([this] { return executor_->timerCount() > 0; }));
    EXPECT_FALSE(report);
    skill::CheckReport found{.planned_duration = 1.5,
                             .ends = {{"", {0.1, 0.2}}, {"opc.tcp://else:1", {}}},
                             .ends_known = true,
                             .notes = {"step x: hm"}};
    ASSERT_TRUE(server().call([&] { move_.hand->answerCheck(found); }));
    executor_->advance(10ms);
    ASSERT_TRUE(until([&] { return report.has_value(); }));
    ASSERT_TRUE(*report) << report->error().message;
    EXPECT_TRUE((*report)->possible);
    EXPECT_DOUBLE_EQ((*report)->planned_duration, 1.5);
    EXPECT_EQ((*report)->ends, (skill::ArmPositions{{url, {0.1, 0.2}}, {"opc.tcp://else:1", {}}}));
    EXPECT_TRUE((*report)->ends_known);
    EXPECT_EQ((*report)->notes, std::vector<std::string>{"step x: hm"});
}

TEST_F(RemoteUsedSkillTest, TellsTheKindOfARefusalAndThatItsEndIsNotKnown) {
    std::optional<Result<skill::CheckReport>> report;
    const auto checked = [&](Result<skill::CheckReport> answer) { report = std::move(answer); };
    move_.hand->refuseStart({Errc::unreachable, "x 2.4 m, reach 0.85 m"});
    used_->check({.parameters = {{"TargetJointPosition", std::vector<double>{0.1, 0.2}}}}, checked);
    ASSERT_TRUE(until([&] { return report.has_value(); }));
    ASSERT_TRUE(*report);
    EXPECT_FALSE((*report)->possible);
    EXPECT_EQ((*report)->code, "unreachable");
    EXPECT_FALSE((*report)->ends_known) << "the skill does not report it";
    EXPECT_FALSE(used_->runsOthers());
}

TEST_F(RemoteUsedSkillTest, ComparesClocksWithinHalfARoundTrip) {
    std::optional<Result<composition::ClockOffset>> offset;
    used_->compareClocks(
        [&](Result<composition::ClockOffset> answer) { offset = std::move(answer); });
    ASSERT_TRUE(until([&] { return offset.has_value(); }));
    ASSERT_TRUE(*offset) << offset->error().message;
    EXPECT_GT((*offset)->uncertainty, 0ns);
    EXPECT_LT((*offset)->uncertainty, 5s);
    EXPECT_LE(std::chrono::abs((*offset)->ahead), (*offset)->uncertainty + 50ms)
        << "it is the same clock, but for the server's steps of it";
}

TEST_F(RemoteUsedSkillTest, IsHaltedIfItIsResetWhileItIsSuspended) {
    beginAndAwait("here.Test/1/move/1");
    ASSERT_TRUE(used_->suspend());
    ASSERT_TRUE(move_.hand->await("suspend"));
    move_.hand->execution().atRest();
    ASSERT_TRUE(until([this] { return listener_.suspended; }));
    ASSERT_EQ(call(*connect("panel"), move_, "Reset"), "Good");
    ASSERT_TRUE(until([this] { return listener_.end.has_value(); }));
    EXPECT_EQ(listener_.end->kind, UsedSkillEnd::Kind::halted);
    EXPECT_EQ(listener_.end->text, "it was reset while it was suspended");
    EXPECT_EQ(used_->state(), State::ready);
}

TEST_F(RemoteUsedSkillTest, ShowsWhatOtherClientsDoAndTellsItToNobody) {
    const auto panel = connect("panel");
    beginAndAwait("here.Test/1/move/1");
    move_.hand->execution().finish();
    ASSERT_TRUE(until([this] { return listener_.end.has_value(); }));
    listener_ = {};
    ASSERT_EQ(call(*panel, move_, "Halt"), "Good");
    ASSERT_TRUE(until([this] { return used_->state() == State::halted; }));
    ASSERT_EQ(call(*panel, move_, "Reset"), "Good");
    ASSERT_TRUE(until([this] { return used_->state() == State::ready; }));
    EXPECT_FALSE(listener_.end);
    EXPECT_TRUE(listener_.stops.empty());
}

TEST_F(RemoteUsedSkillTest, TellsWhyItIsHalted) {
    beginAndAwait("here.Test/1/move/1");
    move_.hand->execution().fail(Reason::limit_violated, "too fast");
    ASSERT_TRUE(until([this] { return listener_.end.has_value(); }));
    EXPECT_EQ(listener_.end->reason, Reason::limit_violated);
    EXPECT_EQ(used_->state(), State::halted);
    EXPECT_EQ(used_->reasonText(), "too fast");
    EXPECT_EQ(use("there.Test")->reasonText(), "too fast") << "also to who comes later";
}

TEST_F(RemoteUsedSkillTest, TellsNobodyWhoHasLetGo) {
    beginAndAwait("here.Test/1/move/1");
    used_->release();
    move_.hand->execution().finish();
    ASSERT_TRUE(until([this] { return used_->state() == State::ready; }));
    executor_->run();
    EXPECT_FALSE(listener_.end);
}

TEST_F(RemoteUsedSkillTest, ThatIsLostSaysSoToEverythingThatIsAsked) {
    shutDown();
    ASSERT_TRUE(until([this] { return !used_->available(); }));
    EXPECT_EQ(used_->available().error().code, Errc::connection_lost);
    EXPECT_EQ(used_->suspend().error().code, Errc::connection_lost);
    EXPECT_EQ(used_->resume().error().code, Errc::connection_lost);
    EXPECT_EQ(used_->reset(listener_).error().code, Errc::connection_lost);
    std::optional<Result<skill::CheckReport>> report;
    used_->check({}, [&](Result<skill::CheckReport> answer) { report = std::move(answer); });
    ASSERT_TRUE(until([&] { return report.has_value(); }));
    EXPECT_FALSE(*report);
    std::optional<Result<composition::ClockOffset>> offset;
    used_->compareClocks(
        [&](Result<composition::ClockOffset> answer) { offset = std::move(answer); });
    ASSERT_TRUE(until([&] { return offset.has_value(); }));
    ASSERT_FALSE(*offset);
    EXPECT_EQ(offset->error().code, Errc::connection_lost);
    begin("here.Test/1/move/1");
    EXPECT_FALSE(listener_.end) << "not from inside the call";
    ASSERT_TRUE(until([this] { return listener_.end.has_value(); }));
    EXPECT_EQ(listener_.end->kind, UsedSkillEnd::Kind::lost);
    EXPECT_FALSE(listener_.reset);
}

TEST_F(RemoteUsedSkillTest, TellsItsServersNameAndAddress) {
    EXPECT_EQ(remote_->name(), "other");
    EXPECT_EQ(remote_->url(), server().endpointUrl());
    EXPECT_EQ(used_->description().name, "JointPtpMoveSkill");
    const auto unnamed =
        RemoteServer::connect({.url = server().endpointUrl(), .name = ""}, executor_).value();
    EXPECT_EQ(unnamed->name(), server().endpointUrl());
    shutDown();
    const auto nobody = RemoteServer::connect({.url = remote_->url(), .name = "x"}, executor_);
    ASSERT_FALSE(nobody);
    EXPECT_THAT(nobody.error().message, HasSubstr(remote_->url() + ": "));
}

TEST_F(RemoteUsedSkillTest, IsLostWithItsServer) {
    beginAndAwait("here.Test/1/move/1");
    shutDown();
    ASSERT_TRUE(until([this] { return listener_.end.has_value(); }));
    EXPECT_EQ(listener_.end->kind, UsedSkillEnd::Kind::lost);
    EXPECT_EQ(listener_.end->reason, Reason::device_lost);
    EXPECT_FALSE(used_->available());
    ASSERT_TRUE(remote_->awaySince());
    EXPECT_LE(*remote_->awaySince(), std::chrono::steady_clock::now());
}

TEST_F(RemoteUsedSkillTest, HaltsWhatIsLeftOverOfItsOwnAndNothingElse) {
    beginAndAwait("here.Test/1/move/1");
    const auto other = use("there.Test");
    EXPECT_EQ(other->state(), State::running);
    EXPECT_FALSE(other->leftOver());
    const auto again = use("here.Test");
    EXPECT_TRUE(again->leftOver());
    ASSERT_TRUE(move_.hand->await("halt"));
    move_.hand->execution().atRest();
    ASSERT_TRUE(until([&] { return again->state() == State::halted; }));
}

// ---- the log ------------------------------------------------------------------------------------

/// Counts what is logged while it is there.
class Log final : public spdlog::sinks::base_sink<std::mutex> {
public:
    /// Waits until `text` was logged that often, at any level.
    bool await(const std::string& text, int count) {
        std::unique_lock lock(reported_mutex_);
        return changed_.wait_for(lock, 30s,
                                 [&] { return countOf(text, spdlog::level::trace) >= count; });
    }
    int warnings(const std::string& text) {
        const std::lock_guard lock(reported_mutex_);
        return countOf(text, spdlog::level::warn);
    }

private:
    void sink_it_(const spdlog::details::log_msg& message) override {
        {
            const std::lock_guard lock(reported_mutex_);
            reported_.emplace_back(message.level,
                                   std::string(message.payload.data(), message.payload.size()));
        }
        changed_.notify_all();
    }
    void flush_() override {}
    int countOf(const std::string& text, spdlog::level::level_enum least) const {
        return static_cast<int>(
            std::count_if(reported_.begin(), reported_.end(), [&](const auto& line) {
                return line.first >= least && line.second.find(text) != std::string::npos;
            }));
    }

    std::mutex reported_mutex_;
    std::condition_variable changed_;
    std::vector<std::pair<spdlog::level::level_enum, std::string>> reported_;
};

/// Takes the place of the program's log, with all levels.
class LoggedRemoteUsedSkill : public RemoteUsedSkillTest {
protected:
    LoggedRemoteUsedSkill() {
        auto logger = std::make_shared<spdlog::logger>("test", log_);
        logger->set_level(spdlog::level::trace);
        spdlog::set_default_logger(std::move(logger));
        used_.reset();
        remote_ = RemoteServer::connect({.url = server().endpointUrl(),
                                         .name = "other",
                                         .session_timeout = 1min,
                                         .retry_interval = 10ms},
                                        executor_)
                      .value();
        used_ = use("here.Test");
    }
    ~LoggedRemoteUsedSkill() override {
        used_.reset();
        remote_.reset();
        spdlog::set_default_logger(former_);
    }

    std::shared_ptr<spdlog::logger> former_ = spdlog::default_logger();  // as spdlog shares it
    std::shared_ptr<Log> log_ = std::make_shared<Log>();                 // shared with the logger
};

TEST_F(LoggedRemoteUsedSkill, TellsOnceThatItsServerIsAway) {
    shutDown();
    ASSERT_TRUE(log_->await("connecting again", 1));
    ASSERT_TRUE(log_->await("BadConnectionRejected", 5)) << "it tries again and again";
    EXPECT_EQ(log_->warnings(""), 2) << "the loss, and why it cannot be mended";
}

TEST_F(LoggedRemoteUsedSkill, TellsALossOnceThatIsHeardOfInTwoWays) {
    Connection connection({.url = server().endpointUrl(),
                           .name = "other",
                           .session_timeout = 1min,
                           .retry_interval = 10ms},
                          connect("component"));
    used_.reset();
    remote_.reset();
    shutDown();
    ASSERT_TRUE(log_->await("connecting again", 1));
    connection.noteLoss(connection.client(), "its events have ended");
    ASSERT_TRUE(log_->await("BadConnectionRejected", 5)) << "it tries again and again";
    EXPECT_EQ(log_->warnings("its events have ended"), 0);
}

/// A used skill that gets no transition, as if all were lost on their way.
class DeafUsedSkill : public RemoteUsedSkillTest {
protected:
    DeafUsedSkill()
        : connection_({.url = server().endpointUrl(), .name = "other", .session_timeout = 1min},
                      connect("deaf")) {
        link_ = std::make_shared<UsedSkillLink>(executor_);
        deaf_.emplace(connection_, link_, "JointPtpMoveSkill of other", "here.Test");
        auto opened =
            client::AsyncSkill::open(connection_.client(), remote_->skills().value().front(), {});
        const auto now = opened->now();
        deaf_->adopt(std::make_shared<OpenSkill>(OpenSkill{nullptr, std::move(*opened)}), *now);
        deaf_->begin({"here.Test/1/move/1", {{"TargetJointPosition", std::vector{0.1, 0.2}}}},
                     listener_);
        EXPECT_TRUE(move_.hand->await("start"));
        // The answer to its start has come once this one has, which was asked for later.
        bool checked = false;
        deaf_->check({}, [&](const auto& /*report*/) { checked = true; });
        EXPECT_TRUE(until([&] { return checked; }));
    }

    Connection connection_;
    std::shared_ptr<UsedSkillLink> link_;
    std::optional<RemoteUsedSkill> deaf_;
};

TEST_F(DeafUsedSkill, LearnsTheEndWhenTransitionsMayHaveBeenMissed) {
    move_.hand->execution().finish();
    ASSERT_TRUE(until([this] { return used_->state() == State::ready; }));
    EXPECT_FALSE(listener_.end);
    deaf_->onMissed();
    ASSERT_TRUE(until([this] { return listener_.end.has_value(); }));
    EXPECT_EQ(listener_.end->kind, UsedSkillEnd::Kind::finished);
    EXPECT_EQ(deaf_->state(), State::ready);
}

TEST_F(DeafUsedSkill, LearnsWhyItWasHalted) {
    move_.hand->execution().fail(Reason::error, "axis 2 is hot");
    ASSERT_TRUE(until([this] { return used_->state() == State::halted; }));
    deaf_->onMissed();
    ASSERT_TRUE(until([this] { return listener_.end.has_value(); }));
    EXPECT_EQ(listener_.end->kind, UsedSkillEnd::Kind::halted);
    EXPECT_EQ(listener_.end->reason, Reason::error);
    EXPECT_EQ(listener_.end->text, "axis 2 is hot");
}

TEST_F(DeafUsedSkill, LearnsThatItWasSuspendedAndResumed) {
    ASSERT_EQ(call(*connect(), move_, "Suspend"), "Good");
    ASSERT_TRUE(move_.hand->await("suspend"));
    move_.hand->execution().atRest();
    ASSERT_TRUE(until([this] { return used_->state() == State::suspended; }));
    deaf_->onMissed();
    ASSERT_TRUE(until([this] { return listener_.suspended; }));
    ASSERT_EQ(call(*connect(), move_, "Resume"), "Good");
    deaf_->onMissed();
    ASSERT_TRUE(until([this] { return !listener_.suspended; }));
    EXPECT_FALSE(listener_.end);
}

TEST_F(DeafUsedSkill, LearnsThatItWasResetWhileItWasSuspended) {
    const auto panel = connect();
    ASSERT_EQ(call(*panel, move_, "Suspend"), "Good");
    ASSERT_TRUE(move_.hand->await("suspend"));
    move_.hand->execution().atRest();
    ASSERT_TRUE(until([this] { return used_->state() == State::suspended; }));
    ASSERT_EQ(call(*panel, move_, "Reset"), "Good");
    ASSERT_TRUE(until([this] { return used_->state() == State::ready; }));
    deaf_->onMissed();
    ASSERT_TRUE(until([this] { return listener_.end.has_value(); }));
    EXPECT_EQ(listener_.end->kind, UsedSkillEnd::Kind::halted);
    EXPECT_EQ(listener_.end->text, "it was reset while it was suspended");
}

TEST_F(DeafUsedSkill, LearnsItsResult) {
    move_.hand->execution().finish({{"Duration", 1.5}});
    ASSERT_TRUE(until([this] { return used_->state() == State::ready; }));
    deaf_->onMissed();
    ASSERT_TRUE(until([this] { return listener_.end.has_value(); }));
    EXPECT_EQ(listener_.end->result.at("Duration"), skill::Value(1.5));
}

TEST_F(DeafUsedSkill, IsToldASuspendOnceAlsoIfItIsAskedAgain) {
    ASSERT_EQ(call(*connect(), move_, "Suspend"), "Good");
    ASSERT_TRUE(move_.hand->await("suspend"));
    move_.hand->execution().atRest();
    ASSERT_TRUE(until([this] { return used_->state() == State::suspended; }));
    deaf_->onMissed();
    ASSERT_TRUE(until([this] { return listener_.suspended; }));
    listener_.suspended = false;
    deaf_->onMissed();
    bool checked = false;
    deaf_->check({}, [&](const auto& /*report*/) { checked = true; });
    EXPECT_TRUE(until([&] { return checked; }));
    EXPECT_FALSE(listener_.suspended);
    EXPECT_FALSE(listener_.end);
}

TEST_F(DeafUsedSkill, SeesTheStateOnceNothingRunsFromHere) {
    move_.hand->execution().finish();
    ASSERT_TRUE(until([this] { return used_->state() == State::ready; }));
    deaf_->onMissed();
    ASSERT_TRUE(until([this] { return listener_.end.has_value(); }));
    ASSERT_EQ(call(*connect(), move_, "Halt"), "Good");
    ASSERT_TRUE(until([this] { return used_->state() == State::halted; }));
    EXPECT_EQ(deaf_->state(), State::ready);
    deaf_->onMissed();
    EXPECT_TRUE(until([this] { return deaf_->state() == State::halted; }));
}

TEST_F(DeafUsedSkill, TellsAResetThatIsUnderWayWhenItsServerIsLost) {
    move_.hand->execution().fail(Reason::error, "stuck");
    ASSERT_TRUE(until([this] { return used_->state() == State::halted; }));
    deaf_->onMissed();
    ASSERT_TRUE(until([this] { return listener_.end.has_value(); }));
    ASSERT_TRUE(deaf_->reset(listener_));
    deaf_->lost("the cable is cut");
    ASSERT_TRUE(listener_.reset);
    ASSERT_FALSE(*listener_.reset);
    EXPECT_EQ(listener_.reset->error().code, Errc::connection_lost);
    EXPECT_EQ(listener_.reset->error().message, "the cable is cut");
    listener_.reset.reset();
    executor_->run();
    EXPECT_FALSE(listener_.reset) << "once";
}

TEST_F(RemoteUsedSkillTest, IsLostWithItsEventsAndComesBackByItself) {
    Connection connection({.url = server().endpointUrl(), .name = "other", .session_timeout = 1min},
                          connect("component"));
    const auto link = std::make_shared<UsedSkillLink>(executor_);
    RemoteUsedSkill used(connection, link, "JointPtpMoveSkill of other", "here.Test");
    const auto opened = connection.open(remote_->skills().value().front(), link).value();
    used.adopt(opened, opened->skill.now().value());
    used.begin({"here.Test/1/move/1", {{"TargetJointPosition", std::vector{0.1, 0.2}}}}, listener_);
    ASSERT_TRUE(move_.hand->await("start"));
    connection.noteLoss(connection.client(), "its events have ended: BadTimeout");
    ASSERT_TRUE(until([this] { return listener_.end.has_value(); }));
    EXPECT_EQ(listener_.end->kind, UsedSkillEnd::Kind::lost);
    EXPECT_EQ(listener_.end->text, "its events have ended: BadTimeout");
    ASSERT_TRUE(until([&] { return used.leftOver(); }));
    ASSERT_TRUE(move_.hand->await("halt")) << "nobody waits for it any more";
    move_.hand->execution().atRest();
    ASSERT_TRUE(until([&] { return used.available() && used.state() == State::halted; }));
    EXPECT_FALSE(connection.awaySince());
}

}  // namespace
}  // namespace metier::client
