#include <gmock/gmock.h>

#include <atomic>
#include <map>
#include <thread>

#include "metier/opcua_skill/namespaces.hpp"
#include "metier/skill/lambda_skill.hpp"
#include "served_skills.hpp"

namespace metier::opcua_skill::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;

class Events : public ServedSkills {
protected:
    Events() : skill_(add(jointMoveDescription())) {
        serve();
        client_ = connect();
    }

    void start() {
        ASSERT_EQ(write(*client_, skill_, "ParameterSet/TargetJointPosition",
                        opcua::Value::of(std::vector{0.5, 1.0})),
                  "Good");
        ASSERT_EQ(call(*client_, skill_, "Start"), "Good");
        ASSERT_TRUE(skill_.hand->await("start"));
    }

    ServedSkill skill_;
    std::unique_ptr<opcua::Client> client_;
};

TEST_F(Events, TellEveryFieldOfATransition) {
    TransitionWatch watch(*client_, skill_.id);
    start();
    const auto seen = watch.next();
    ASSERT_TRUE(seen);
    EXPECT_EQ(seen->source, skill_.id);
    EXPECT_EQ(seen->source_name, "JointPtpMoveSkill");
    EXPECT_GT(seen->time, UtcTime{});
    EXPECT_NE(seen->message, "");
    EXPECT_GE(seen->severity, 1);
    EXPECT_EQ(seen->from, "Ready");
    EXPECT_EQ(seen->from_id, opcua::NodeId(0, 2400U));
    EXPECT_EQ(seen->from_number, 12U);
    EXPECT_EQ(seen->to, "Running");
    EXPECT_EQ(seen->to_id, opcua::NodeId(0, 2402U));
    EXPECT_EQ(seen->to_number, 13U);
    EXPECT_EQ(seen->transition, "ReadyToRunning");
    EXPECT_EQ(seen->transition_id, opcua::NodeId(0, 2410U));
    EXPECT_EQ(seen->transition_number, 2U);
    EXPECT_EQ(seen->transition_time, seen->time);
    EXPECT_EQ(seen->execution_id, skill_.hand->execution().id());
    EXPECT_EQ(seen->reason, 2);
}

TEST_F(Events, CarryTheIntermediateResult) {
    TransitionWatch watch(*client_, skill_.id);
    start();
    EXPECT_TRUE(watch.next()->intermediate_result.isEmpty());
    skill_.hand->execution().progress(0.75);
    skill_.hand->execution().finish();
    const auto seen = watch.next();
    ASSERT_TRUE(seen);
    EXPECT_EQ(seen->transition, "RunningToReady");
    EXPECT_EQ(seen->intermediate_result, opcua::Value::of(0.75));
    EXPECT_EQ(seen->reason, 1);
}

TEST_F(Events, ReachTheSkillTheControllerTheSystemAndTheServer) {
    TransitionWatch at_skill(*client_, skill_.id);
    TransitionWatch at_controller(*client_, system().controller);
    TransitionWatch at_system(*client_, system().system);
    TransitionWatch at_server(*client_, opcua::ids::kServer);
    start();
    skill_.hand->execution().finish();
    for (auto* watch : {&at_skill, &at_controller, &at_system, &at_server}) {
        EXPECT_EQ(watch->nextName(), "ReadyToRunning");
        EXPECT_EQ(watch->nextName(), "RunningToReady");
    }
}

TEST_F(Events, AreOfTheTypeThatTheSkillDeclares) {
    TransitionWatch watch(*client_, skill_.id);
    start();
    const auto seen = watch.next();
    ASSERT_TRUE(seen);
    const auto name = client_->read(seen->event_type, opcua::AttributeId::browse_name);
    ASSERT_TRUE(name);
    EXPECT_EQ(name->as<opcua::QualifiedName>()->name, "SkillTransitionEventType");
}

TEST_F(Events, NeverComeBeforeTheStateThatTheyTell) {
    TransitionWatch watch(*client_, skill_.id);
    for (int round = 0; round < 20; ++round) {
        start();
        skill_.hand->execution().finish({{"Duration", static_cast<double>(round)}});
        ASSERT_EQ(watch.nextName(), "ReadyToRunning");
        ASSERT_EQ(watch.nextName(), "RunningToReady");
        ASSERT_EQ(readAs<double>(*client_, skill_, "FinalResultData/Duration"), round);
    }
}

TEST_F(Events, OfTheAuditTellWhatTheServerDidByItself) {
    const auto messages = std::make_shared<Queue<std::string>>(100);  // shared with the callback
    const auto subscription = client_->subscribeEvents(
        opcua::ids::kServer,
        {.fields = {{{0, "Message"}}, {{0, "EventType"}}}, .of_type = opcua::ids::kAuditEventType},
        [messages](const opcua::EventNotice& notice) {
            if (notice.kind == opcua::EventNotice::Kind::event &&
                notice.fields[1] == opcua::Value::of(opcua::ids::kAuditEventType)) {
                messages->tryPush(notice.fields[0].toString());
            }
        });
    ASSERT_TRUE(subscription) << subscription.error().message;
    start();
    skill_.hand->execution().fail(skill::Reason::device_lost, "the wire is cut");
    const auto message = messages->popUntil(std::chrono::steady_clock::now() + 10s);
    ASSERT_TRUE(message);
    EXPECT_THAT(*message, AllOf(HasSubstr("Halted of JointPtpMoveSkill"),
                                HasSubstr("by the server: DeviceLost: the wire is cut")));
}

TEST_F(Events, SayThatASkillBeginsToComeToRest) {
    const auto metier = client_->namespaceIndex(kMetierUri).value();
    const auto stops = std::make_shared<Queue<std::vector<opcua::Value>>>(10);  // with the callback
    const auto subscription = client_->subscribeEvents(
        skill_.id,
        {.fields = {{{metier, "ExecutionId"}},
                    {{metier, "StateAtRest"}},
                    {{metier, "Reason"}},
                    {{metier, "ReasonText"}}},
         .of_type = opcua::NodeId(metier, kStoppingEventTypeId)},
        [stops](const opcua::EventNotice& notice) { stops->tryPush(notice.fields); });
    ASSERT_TRUE(subscription) << subscription.error().message;
    const auto type =
        client_->read({metier, kStoppingEventTypeId}, opcua::AttributeId::browse_name);
    EXPECT_EQ(type.value().as<opcua::QualifiedName>()->name, "SkillStoppingEventType");
    start();
    ASSERT_EQ(call(*connect("panel"), skill_, "Suspend"), "Good");
    const auto stop = stops->popUntil(std::chrono::steady_clock::now() + 10s);
    ASSERT_TRUE(stop) << "before the body has come to rest";
    EXPECT_EQ((*stop)[0], opcua::Value::of(skill_.hand->execution().id()));
    EXPECT_EQ((*stop)[1], opcua::Value::of(14U));
    EXPECT_EQ((*stop)[2], opcua::Value::of(std::int32_t{2}));
    EXPECT_EQ((*stop)[3], opcua::Value::of(std::string("by panel")));
}

/// Skills that finish at once, shared by several clients.
class ManyClients : public ServedSkills {
protected:
    static constexpr std::size_t kSkills = 4;
    static constexpr std::size_t kClients = 8;
    static constexpr std::size_t kTransitions = 10'000;

    ManyClients() {
        for (std::size_t i = 0; i < kSkills; ++i) {
            auto description = streamDescription();
            description.name = "Instant" + std::to_string(i);
            auto program = skills().publish(
                system().skills,
                std::make_unique<skill::LambdaSkill>(description, skill::SkillFunctions{}));
            if (!program) {
                throw std::runtime_error(program.error().message);
            }
            ids_.push_back(
                {system().skills.namespaceIndex(),
                 std::get<std::string>(system().skills.identifier()) + "/" + description.name});
        }
        serve();
    }

    /// Starts skills in turn until `started` has reached its goal.
    void work(std::size_t first, std::atomic<std::size_t>& started) {
        const auto client = connect("worker " + std::to_string(first));
        for (std::size_t next = first; started < kTransitions / 2; ++next) {
            const auto& id = ids_[next % kSkills];
            const opcua::NodeId method(id.namespaceIndex(),
                                       std::get<std::string>(id.identifier()) + "/Start");
            if (client->call(id, method)) {
                ++started;
            }
        }
    }

    std::vector<opcua::NodeId> ids_;
};

TEST_F(ManyClients, LoseAndReorderNoEvent) {
    const auto observer = connect("observer");
    TransitionWatch watch(*observer, opcua::ids::kServer);
    std::atomic<std::size_t> started{0};
    {
        std::vector<std::jthread> workers;
        for (std::size_t i = 0; i < kClients; ++i) {
            workers.emplace_back([this, i, &started] { work(i, started); });
        }
    }
    std::map<opcua::NodeId, std::string> last;
    for (std::size_t i = 0; i < 2 * started; ++i) {
        const auto seen = watch.next();
        ASSERT_TRUE(seen) << "after " << i << " of " << 2 * started;
        auto& before = last.try_emplace(seen->source, "Ready").first->second;
        ASSERT_EQ(seen->from, before) << "event " << i;
        before = seen->to;
    }
    EXPECT_EQ(watch.overflows(), 0U);
    for (const auto& [source, state] : last) {
        EXPECT_EQ(state, "Ready");
    }
}

}  // namespace
}  // namespace metier::opcua_skill::testing
