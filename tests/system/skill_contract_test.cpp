// The state machine of docs/model.md through a real client: the rows that libs/opcua_skill/tests do
// not prove. docs/testing.md lists the test of each row.
#include <array>
#include <map>
#include <vector>

#include "served_contract.hpp"

namespace metier::system_tests {
namespace {

using skill::Method;
using skill::Reason;
using skill::State;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr std::array kMethods{Method::start, Method::suspend, Method::resume, Method::halt,
                              Method::reset};
const skill::Value kTarget = std::vector{0.5, 1.0};

class SkillContract : public ServedContract {
protected:
    explicit SkillContract(skill::ProgramOptions options = patient())
        : skill_(add(served::jointMoveDescription(), std::move(options))) {
        serve();
        handle_.emplace(openSkill("JointPtpMoveSkill"));
        watch_.emplace(client(), skill_.id);
    }

    /// No deadline passes between two steps of a test.
    static skill::ProgramOptions patient() {
        skill::ProgramOptions options;
        options.rest_deadline = std::chrono::minutes(1);
        options.configuration_timeout = std::chrono::minutes(1);
        return options;
    }

    void start() {
        ASSERT_TRUE(handle_->set("TargetJointPosition", kTarget));
        ASSERT_EQ(statusOf(handle_->start()), "Good");
        ASSERT_EQ(watch_->nextName(), "ReadyToRunning");
        ASSERT_TRUE(skill_.hand->await("start"));
    }
    void suspend() {
        start();
        ASSERT_EQ(statusOf(handle_->suspend()), "Good");
        ASSERT_TRUE(skill_.hand->await("suspend"));
        skill_.hand->execution().atRest();
        ASSERT_EQ(watch_->nextName(), "RunningToSuspended");
    }
    void halt() {
        ASSERT_EQ(statusOf(handle_->halt()), "Good");
        ASSERT_EQ(watch_->nextName(), "ReadyToHalted");
    }
    void deviceLost() {
        onServer([this] { skill_.program->deviceLost("arm test does not answer"); });
    }

    /// Everything that a refused call must not change.
    std::vector<std::string> picture() {
        std::vector<std::string> values;
        for (const char* path : {"CurrentState", "LastTransition", "LastTransition/TransitionTime",
                                 "ReadySubStates/CurrentState", "RunningSubStates/CurrentState",
                                 "HaltedSubStates/CurrentState", "FinalResultData/Duration"}) {
            values.push_back(served::read(client(), skill_, path));
        }
        return values;
    }

    /// The methods that the present state allows, by UserExecutable; each other one is called and
    /// must be refused without any change.
    std::vector<std::string> allowedMethods() {
        std::vector<std::string> allowed;
        for (const auto method : kMethods) {
            if (handle_->executable(method).value_or(false)) {
                allowed.emplace_back(toString(method));
                continue;
            }
            const auto before = picture();
            const auto refused = handle_->call(method);
            EXPECT_EQ(statusOf(refused), "BadInvalidState") << toString(method);
            EXPECT_THAT(handle_->reasonText(),
                        HasSubstr(fmt::format("{} is not possible while", toString(method))));
            EXPECT_EQ(picture(), before) << toString(method);
        }
        return allowed;
    }

    served::ServedSkill skill_;
    std::optional<client::SkillHandle> handle_;
    std::optional<served::TransitionWatch> watch_;
};

TEST_F(SkillContract, ReadyAllowsWhatUserExecutableTellsAndRefusesTheRest) {
    EXPECT_THAT(allowedMethods(), ElementsAre("Start", "Halt"));
}

TEST_F(SkillContract, RunningAllowsWhatUserExecutableTellsAndRefusesTheRest) {
    start();
    EXPECT_THAT(allowedMethods(), ElementsAre("Suspend", "Halt"));
}

TEST_F(SkillContract, SuspendedAllowsWhatUserExecutableTellsAndRefusesTheRest) {
    suspend();
    EXPECT_THAT(allowedMethods(), ElementsAre("Resume", "Halt", "Reset"));
}

TEST_F(SkillContract, HaltedAllowsWhatUserExecutableTellsAndRefusesTheRest) {
    halt();
    EXPECT_THAT(allowedMethods(), ElementsAre("Reset"));
}

TEST_F(SkillContract, NineTransitionsTellTheirNumbersAndStates) {
    std::vector<served::TransitionWatch::Seen> seen;
    const auto take = [&] { seen.push_back(watch_->next().value()); };
    const auto startAgain = [&] {
        ASSERT_TRUE(handle_->set("TargetJointPosition", kTarget));
        ASSERT_TRUE(handle_->start());
        take();
    };
    const auto suspendAgain = [&] {
        ASSERT_TRUE(handle_->suspend());
        skill_.hand->execution().atRest();
        take();
    };
    ASSERT_TRUE(handle_->halt());
    take();
    ASSERT_TRUE(handle_->reset());
    take();
    startAgain();
    skill_.hand->execution().finish();
    take();
    startAgain();
    suspendAgain();
    ASSERT_TRUE(handle_->resume());
    take();
    suspendAgain();
    ASSERT_TRUE(handle_->reset());
    take();
    startAgain();
    skill_.hand->execution().fail(Reason::error, "stuck");
    take();
    ASSERT_TRUE(handle_->reset());
    take();
    startAgain();
    suspendAgain();
    ASSERT_TRUE(handle_->halt());
    take();
    std::vector<std::uint32_t> numbers;
    for (std::size_t i = 0; i < seen.size(); ++i) {
        numbers.push_back(seen[i].transition_number);
        EXPECT_EQ(seen[i].transition, seen[i].from + "To" + seen[i].to);
        EXPECT_EQ(seen[i].from, i == 0 ? "Ready" : seen[i - 1].to) << "transition " << i;
        EXPECT_NE(seen[i].message, "");
        EXPECT_GE(seen[i].time, seen[i == 0 ? 0 : i - 1].time);
    }
    EXPECT_THAT(numbers, ElementsAre(9, 1, 2, 4, 2, 5, 6, 5, 8, 2, 3, 1, 2, 5, 7));
}

TEST_F(SkillContract, OneExecutionKeepsItsIdAndTheNextHasAnother) {
    suspend();
    const auto first = skill_.hand->execution().id();
    ASSERT_TRUE(handle_->resume());
    EXPECT_EQ(watch_->next()->execution_id, first);
    skill_.hand->execution().finish();
    EXPECT_EQ(watch_->next()->execution_id, first);
    start();
    EXPECT_NE(skill_.hand->execution().id(), first);
}

TEST_F(SkillContract, TheLossOfTheOwnerBrakesAndHalts) {
    start();
    onServer([this] { skill_.program->ownerLost("session closed"); });
    ASSERT_TRUE(skill_.hand->await("halt"));
    EXPECT_EQ(textAt(skill_, "RunningSubStates/CurrentState"), "Stopping");
    skill_.hand->execution().atRest();
    const auto seen = watch_->next();
    ASSERT_TRUE(seen);
    EXPECT_EQ(seen->transition, "RunningToHalted");
    EXPECT_EQ(seen->reason, static_cast<int>(Reason::owner_lost));
    EXPECT_EQ(seen->reason_text, "session closed");
    EXPECT_EQ(textAt(skill_, "HaltedSubStates/CurrentState"), "HaltedOwnerLost");
}

TEST_F(SkillContract, TheLossOfTheDeviceHaltsARunningSkillAtOnce) {
    start();
    deviceLost();
    const auto seen = watch_->next();
    ASSERT_TRUE(seen);
    EXPECT_EQ(seen->transition, "RunningToHalted");
    EXPECT_EQ(seen->reason, static_cast<int>(Reason::device_lost));
    EXPECT_EQ(seen->reason_text, "arm test does not answer");
    EXPECT_EQ(textAt(skill_, "HaltedSubStates/CurrentState"), "HaltedDeviceLost");
}

TEST_F(SkillContract, TheLossOfTheDeviceHaltsAReadySkill) {
    deviceLost();
    const auto seen = watch_->next();
    ASSERT_TRUE(seen);
    EXPECT_EQ(seen->transition, "ReadyToHalted");
    EXPECT_EQ(seen->reason, static_cast<int>(Reason::device_lost));
}

TEST_F(SkillContract, TheLossOfTheDeviceHaltsASuspendedSkill) {
    suspend();
    deviceLost();
    EXPECT_EQ(watch_->nextName(), "SuspendedToHalted");
}

TEST_F(SkillContract, TheLossOfTheDeviceInHaltedIsToldWithoutATransition) {
    halt();
    deviceLost();
    EXPECT_EQ(textAt(skill_, "HaltedSubStates/CurrentState"), "HaltedDeviceLost");
    EXPECT_EQ(handle_->reasonText(), "arm test does not answer");
    ASSERT_TRUE(handle_->reset());
    EXPECT_EQ(watch_->nextName(), "HaltedToReady");
}

TEST_F(SkillContract, AnErrorHaltsASuspendedSkill) {
    suspend();
    skill_.hand->execution().fail(Reason::error, "brake of axis 2 opened");
    const auto seen = watch_->next();
    ASSERT_TRUE(seen);
    EXPECT_EQ(seen->transition, "SuspendedToHalted");
    EXPECT_EQ(seen->reason_text, "brake of axis 2 opened");
}

TEST_F(SkillContract, EachReasonHasItsHaltedSubState) {
    const std::map<Reason, std::string> sub_states{{Reason::error, "HaltedError"},
                                                   {Reason::force_exceeded, "HaltedForce"},
                                                   {Reason::limit_violated, "HaltedLimit"},
                                                   {Reason::device_lost, "HaltedDeviceLost"}};
    for (const auto& [reason, sub_state] : sub_states) {
        start();
        EXPECT_EQ(textAt(skill_, "RunningSubStates/CurrentState"), "Executing");
        skill_.hand->execution().fail(reason, "told by the test");
        ASSERT_EQ(watch_->nextName(), "RunningToHalted");
        EXPECT_EQ(textAt(skill_, "HaltedSubStates/CurrentState"), sub_state);
        ASSERT_TRUE(handle_->reset());
        ASSERT_EQ(watch_->nextName(), "HaltedToReady");
    }
}

TEST_F(SkillContract, SuspendReturnsAtOnceAndIsCommittedAtStandstill) {
    start();
    ASSERT_EQ(statusOf(handle_->suspend()), "Good");
    EXPECT_EQ(*handle_->state(), State::running);
    EXPECT_EQ(textAt(skill_, "RunningSubStates/CurrentState"), "Stopping");
    skill_.hand->execution().atRest();
    EXPECT_EQ(watch_->nextName(), "RunningToSuspended");
    EXPECT_EQ(*handle_->state(), State::suspended);
}

TEST_F(SkillContract, HaltIsTakenWhileSuspendBrakes) {
    start();
    ASSERT_TRUE(handle_->suspend());
    ASSERT_EQ(statusOf(handle_->halt()), "Good");
    skill_.hand->execution().atRest();
    EXPECT_EQ(watch_->nextName(), "RunningToHalted");
}

class SkillWithAShortRestDeadline : public SkillContract {
protected:
    SkillWithAShortRestDeadline() : SkillContract(shortly()) {}
    static skill::ProgramOptions shortly() {
        auto options = patient();
        options.rest_deadline = std::chrono::milliseconds(50);
        return options;
    }
};

TEST_F(SkillWithAShortRestDeadline, ABodyThatDoesNotComeToRestIsStoppedByItsDevice) {
    start();
    ASSERT_TRUE(handle_->suspend());
    ASSERT_TRUE(skill_.hand->await("forceStop"));
    const auto seen = watch_->next();
    ASSERT_TRUE(seen);
    EXPECT_EQ(seen->transition, "RunningToHalted");
    EXPECT_EQ(seen->reason_text, "not at rest within 50 ms, the device's own stop was used");
}

TEST_F(SkillContract, SubStatesChangeWithoutAnEventOfTheSkill) {
    start();
    ASSERT_TRUE(handle_->suspend());
    EXPECT_EQ(textAt(skill_, "RunningSubStates/CurrentState"), "Stopping");
    skill_.hand->execution().step("approach");
    skill_.hand->execution().progress(0.5);
    skill_.hand->execution().atRest();
    EXPECT_EQ(watch_->nextName(), "RunningToSuspended");
    ASSERT_TRUE(handle_->reset());
    EXPECT_EQ(watch_->nextName(), "SuspendedToReady");
    ASSERT_TRUE(handle_->set("TargetJointPosition", kTarget));
    EXPECT_EQ(textAt(skill_, "ReadySubStates/CurrentState"), "ReadyConfigured");
    ASSERT_TRUE(handle_->halt());
    EXPECT_EQ(watch_->nextName(), "ReadyToHalted");
}

TEST_F(SkillContract, TheLastFinishedExecutionKeepsItsResult) {
    start();
    skill_.hand->execution().finish({{"Duration", 1.5}});
    ASSERT_EQ(watch_->nextName(), "RunningToReady");
    start();
    skill_.hand->execution().fail(Reason::error, "stuck");
    ASSERT_EQ(watch_->nextName(), "RunningToHalted");
    EXPECT_EQ(handle_->result()->at("Duration"), skill::Value(1.5));
}

TEST_F(SkillContract, AResultThatIsGivenOnceIsNotLeftOverInTheNext) {
    start();
    skill_.hand->execution().finish({{"Duration", 1.5}});
    ASSERT_EQ(watch_->nextName(), "RunningToReady");
    start();
    skill_.hand->execution().finish();
    ASSERT_EQ(watch_->nextName(), "RunningToReady");
    EXPECT_EQ(handle_->result()->at("Duration"), skill::Value());
}

TEST_F(SkillContract, TheDiagnosticNamesItsCreatorAndTheLastCaller) {
    start();
    const auto other = connect("operator");
    EXPECT_EQ(served::call(*other, skill_, "Reset"), "BadInvalidState");
    const auto whole =
        served::readAs<opcua::ProgramDiagnostic>(client(), skill_, "ProgramDiagnostic");
    EXPECT_TRUE(whole.create_session_id.isNull());
    EXPECT_GT(whole.invocation_creation_time, UtcTime{});
    EXPECT_GE(whole.last_transition_time, whole.invocation_creation_time);
    EXPECT_EQ(whole.last_method_call, "Reset");
    EXPECT_EQ(whole.last_method_return_status, opcua::status::kBadInvalidState);
    EXPECT_TRUE(whole.last_method_input_arguments.empty());
    ASSERT_TRUE(handle_->suspend());
    const auto later =
        served::readAs<opcua::ProgramDiagnostic>(client(), skill_, "ProgramDiagnostic");
    EXPECT_EQ(later.last_method_call, "Suspend");
    EXPECT_EQ(later.last_method_return_status, opcua::status::kGood);
    EXPECT_NE(later.last_method_session_id, whole.last_method_session_id);
}

class SkillWithAShortConfiguration : public SkillContract {
protected:
    SkillWithAShortConfiguration() : SkillContract(shortly()) {}
    /// Long enough for the server to sample what was written.
    static skill::ProgramOptions shortly() {
        auto options = patient();
        options.configuration_timeout = std::chrono::seconds(1);
        return options;
    }
};

TEST_F(SkillWithAShortConfiguration, WrittenParametersFallBackAfterTheConfigurationTimeout) {
    const auto target = skill_.node("Options/SpeedOverride");
    auto changes = std::make_shared<Queue<opcua::Value>>(100);
    const auto subscription = client().subscribeData(
        target, {std::chrono::milliseconds(5), 10},
        [changes](const opcua::DataValue& value) { changes->tryPush(value.value); });
    ASSERT_TRUE(subscription);
    ASSERT_EQ(changes->popUntil(soon()), opcua::Value::of(1.0));
    ASSERT_TRUE(handle_->set("SpeedOverride", 0.25));
    EXPECT_EQ(changes->popUntil(soon()), opcua::Value::of(0.25));
    EXPECT_EQ(changes->popUntil(soon()), opcua::Value::of(1.0));
    EXPECT_EQ(textAt(skill_, "ReadySubStates/CurrentState"), "ReadyNotConfigured");
}

/// Skills that do what a test says in a function.
class FunctionContract : public ServedContract {
protected:
    client::SkillHandle serveSkill(skill::SkillFunctions functions,
                                   skill::ProgramOptions options = {}) {
        auto description = served::streamDescription();
        auto fields = description.parameters.toVector();
        fields.front().default_value = std::vector{0.0, 0.0};
        description.parameters = std::move(fields);
        const auto program = skills().publish(
            system().skills,
            std::make_unique<skill::LambdaSkill>(std::move(description), std::move(functions)),
            std::move(options));
        EXPECT_TRUE(program) << program.error().message;
        serve();
        return openSkill("PositionStreamSkill");
    }
};

TEST_F(FunctionContract, RunningComesBeforeReadyEvenIfTheWorkEndsInStart) {
    auto handle = serveSkill({.start = [](const auto&, const auto& run) { run.finish(); }});
    served::TransitionWatch watch(client(), handle.address().node);
    for (int round = 0; round < 20; ++round) {
        ASSERT_TRUE(handle.start());
        ASSERT_EQ(watch.nextName(), "ReadyToRunning");
        ASSERT_EQ(watch.nextName(), "RunningToReady");
    }
}

TEST_F(FunctionContract, ABodyThatFailsInStartIsHaltedAfterRunning) {
    auto handle = serveSkill({.start = [](const auto&, const auto& run) {
        run.fail(Reason::device_lost, "arm test is off");
    }});
    const auto outcome = handle.run({}, soon());
    ASSERT_FALSE(outcome);
    EXPECT_EQ(outcome.error().code, Errc::connection_lost);
    EXPECT_THAT(outcome.error().message, HasSubstr("arm test is off"));
    EXPECT_EQ(*handle.state(), State::halted);
}

TEST_F(FunctionContract, ASkillThatCannotBeSuspendedSaysSoAndRunsOn) {
    auto handle = serveSkill({.start = [](const auto&, const auto&) {}});
    ASSERT_TRUE(handle.start());
    EXPECT_FALSE(*handle.executable(Method::suspend));
    EXPECT_EQ(statusOf(handle.suspend()), "BadNotSupported");
    EXPECT_EQ(handle.reasonText(), "PositionStreamSkill cannot be suspended");
    EXPECT_EQ(*handle.state(), State::running);
}

TEST_F(FunctionContract, ASuspendThatTheBodyRefusesLeavesItRunning) {
    auto handle =
        serveSkill({.start = [](const auto&, const auto&) {},
                    .suspend = [](const auto&) { return fail(Errc::device_fault, "no brake"); },
                    .resume = [](const auto&) { return Result<void>{}; }});
    ASSERT_TRUE(handle.start());
    EXPECT_EQ(statusOf(handle.suspend()), "BadDeviceFailure");
    EXPECT_EQ(handle.reasonText(), "no brake");
    EXPECT_EQ(*handle.state(), State::running);
}

TEST_F(FunctionContract, ResumeOfAnArmThatWasMovedIsRefusedWithTheDistance) {
    constexpr const char* kMoved = "axis 2 was moved by 0.2 rad while suspended, limit 0.01 rad";
    auto handle = serveSkill(
        {.start = [](const auto&, const auto&) {},
         .suspend = [](const auto& run) -> Result<void> {
             run.atRest();
             return {};
         },
         .resume = [](const auto&) -> Result<void> { return fail(Errc::out_of_range, kMoved); }});
    ASSERT_TRUE(handle.start());
    ASSERT_TRUE(handle.suspend());
    ASSERT_TRUE(handle.awaitState(State::suspended, soon()));
    EXPECT_EQ(statusOf(handle.resume()), "BadOutOfRange");
    EXPECT_EQ(handle.reasonText(), kMoved);
    EXPECT_EQ(*handle.state(), State::suspended);
    EXPECT_EQ(statusOf(handle.reset()), "Good");
}

TEST_F(FunctionContract, AResetThatTheDeviceRefusesLeavesItHaltedUntilItAgrees) {
    auto stuck = std::make_shared<std::atomic<bool>>(true);
    auto handle = serveSkill({.reset = [stuck]() -> Result<void> {
        return *stuck ? Result<void>(fail(Errc::device_fault, "emergency stop is pressed"))
                      : Result<void>();
    }});
    ASSERT_TRUE(handle.halt());
    EXPECT_EQ(statusOf(handle.reset()), "BadDeviceFailure");
    EXPECT_EQ(*handle.state(), State::halted);
    EXPECT_EQ(served::readAs<std::string>(client(), {handle.address().node, {}, {}}, "ReasonText"),
              "emergency stop is pressed");
    *stuck = false;
    EXPECT_EQ(statusOf(handle.reset()), "Good");
    EXPECT_EQ(*handle.state(), State::ready);
}

/// Two skills of one arm.
class SharedArm : public ServedContract {
protected:
    SharedArm()
        : move_(add(served::jointMoveDescription(), sharing())),
          stream_(add(served::streamDescription(), sharing())) {
        serve();
    }
    skill::ProgramOptions sharing() {
        skill::ProgramOptions options;
        options.resource = arm_;
        return options;
    }

    // Shared by both Programs, as a Resource is.
    std::shared_ptr<skill::Resource> arm_ = std::make_shared<skill::Resource>("arm test");
    served::ServedSkill move_;
    served::ServedSkill stream_;
};

TEST_F(SharedArm, NeverRunsTwoSkillsTogether) {
    auto move = openSkill("JointPtpMoveSkill");
    auto stream = openSkill("PositionStreamSkill");
    ASSERT_TRUE(move.set("TargetJointPosition", kTarget));
    ASSERT_TRUE(move.start());
    ASSERT_TRUE(move_.hand->await("start"));
    EXPECT_FALSE(*stream.executable(Method::start));
    EXPECT_EQ(statusOf(stream.start()), "BadResourceUnavailable");
    EXPECT_EQ(stream.reasonText(), "arm test is in use by JointPtpMoveSkill");
    EXPECT_EQ(*stream.state(), State::ready);
    served::TransitionWatch watch(client(), move_.id);
    move_.hand->execution().finish();
    ASSERT_EQ(watch.nextName(), "RunningToReady");
    EXPECT_EQ(statusOf(stream.start()), "Good");
    EXPECT_TRUE(stream_.hand->await("start"));
}

}  // namespace
}  // namespace metier::system_tests
