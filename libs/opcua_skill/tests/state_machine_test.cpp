#include <gmock/gmock.h>

#include "metier/robot_skills/move_parameters.hpp"
#include "served_skills.hpp"

namespace metier::opcua_skill::testing {
namespace {

using ::testing::HasSubstr;

class StateMachine : public ServedSkills {
protected:
    StateMachine() : skill_(add(jointMoveDescription())) {
        serve();
        client_ = connect();
        watch_ = std::make_unique<TransitionWatch>(*client_, skill_.id);
    }

    std::string call(std::string_view method) { return testing::call(*client_, skill_, method); }
    std::string state() {
        return readAs<opcua::LocalizedText>(*client_, skill_, "CurrentState").text;
    }
    void writeTarget() {
        ASSERT_EQ(write(*client_, skill_, "ParameterSet/TargetJointPosition",
                        opcua::Value::of(std::vector{0.5, 1.0})),
                  "Good");
    }
    void start() {
        writeTarget();
        ASSERT_EQ(call("Start"), "Good");
        ASSERT_EQ(watch_->nextName(), "ReadyToRunning");
        ASSERT_TRUE(skill_.hand->await("start"));
    }
    void suspend() {
        start();
        ASSERT_EQ(call("Suspend"), "Good");
        ASSERT_TRUE(skill_.hand->await("suspend"));
        skill_.hand->execution().atRest();
        ASSERT_EQ(watch_->nextName(), "RunningToSuspended");
    }
    void halt() {
        ASSERT_EQ(call("Halt"), "Good");
        ASSERT_EQ(watch_->nextName(), "ReadyToHalted");
    }
    /// Answers of the methods in the present state, which must not change by them.
    std::string refusals(std::initializer_list<const char*> methods) {
        std::string answers;
        for (const char* method : methods) {
            answers += std::string(method) + " " + call(method) + "; ";
        }
        return answers;
    }

    ServedSkill skill_;
    std::unique_ptr<opcua::Client> client_;
    std::unique_ptr<TransitionWatch> watch_;
};

TEST_F(StateMachine, BeginsReady) {
    EXPECT_EQ(state(), "Ready");
    EXPECT_EQ(readAs<std::uint32_t>(*client_, skill_, "CurrentState/Number"), 12U);
    EXPECT_EQ(readAs<opcua::NodeId>(*client_, skill_, "CurrentState/Id"), opcua::NodeId(0, 2400U));
}

TEST_F(StateMachine, HasNoTransitionAndNoResultBeforeTheFirst) {
    for (const auto* path : {"LastTransition", "LastTransition/Id", "LastTransition/Number",
                             "LastTransition/TransitionTime", "FinalResultData/Duration",
                             "FinalResultData/ReachedJointPosition"}) {
        EXPECT_EQ(read(*client_, skill_, path), "BadNoData") << path;
    }
    halt();
    EXPECT_EQ(readAs<std::uint32_t>(*client_, skill_, "LastTransition/Number"), 9U);
    EXPECT_EQ(read(*client_, skill_, "FinalResultData/Duration"), "BadNoData");
}

TEST_F(StateMachine, HasAName) {
    EXPECT_EQ(readAs<std::string>(*client_, skill_, "Name"), jointMoveDescription().name);
}

TEST_F(StateMachine, RefusesInReadyWhatReadyDoesNotAllow) {
    EXPECT_EQ(refusals({"Suspend", "Resume", "Reset"}),
              "Suspend BadInvalidState; Resume BadInvalidState; Reset BadInvalidState; ");
    EXPECT_EQ(state(), "Ready");
}

TEST_F(StateMachine, RefusesInRunningWhatRunningDoesNotAllow) {
    start();
    EXPECT_EQ(refusals({"Start", "Resume", "Reset"}),
              "Start BadInvalidState; Resume BadInvalidState; Reset BadInvalidState; ");
    EXPECT_EQ(state(), "Running");
}

TEST_F(StateMachine, RefusesInSuspendedWhatSuspendedDoesNotAllow) {
    suspend();
    EXPECT_EQ(refusals({"Start", "Suspend"}), "Start BadInvalidState; Suspend BadInvalidState; ");
    EXPECT_EQ(state(), "Suspended");
}

TEST_F(StateMachine, RefusesInHaltedWhatHaltedDoesNotAllow) {
    halt();
    EXPECT_EQ(refusals({"Start", "Suspend", "Resume", "Halt"}),
              "Start BadInvalidState; Suspend BadInvalidState; Resume BadInvalidState; "
              "Halt BadInvalidState; ");
    EXPECT_EQ(state(), "Halted");
}

TEST_F(StateMachine, RunsToReadyWithTheResultBeforeTheEvent) {
    start();
    skill_.hand->execution().finish(
        {{"Duration", 1.5}, {"ReachedJointPosition", std::vector{0.5, 1.0}}});
    ASSERT_EQ(watch_->nextName(), "RunningToReady");
    EXPECT_EQ(readAs<double>(*client_, skill_, "FinalResultData/Duration"), 1.5);
    EXPECT_EQ(readAs<std::vector<double>>(*client_, skill_, "FinalResultData/ReachedJointPosition"),
              (std::vector{0.5, 1.0}));
    EXPECT_EQ(state(), "Ready");
}

TEST_F(StateMachine, HaltIsCommittedAtStandstill) {
    start();
    ASSERT_EQ(call("Halt"), "Good");
    ASSERT_TRUE(skill_.hand->await("halt"));
    EXPECT_EQ(state(), "Running");
    EXPECT_EQ(readAs<opcua::LocalizedText>(*client_, skill_, "RunningSubStates/CurrentState").text,
              "Stopping");
    skill_.hand->execution().atRest();
    EXPECT_EQ(watch_->nextName(), "RunningToHalted");
    EXPECT_EQ(state(), "Halted");
}

TEST_F(StateMachine, ResumesAndHaltsFromSuspended) {
    suspend();
    ASSERT_EQ(call("Resume"), "Good");
    EXPECT_EQ(watch_->nextName(), "SuspendedToRunning");
    ASSERT_EQ(call("Suspend"), "Good");
    ASSERT_TRUE(skill_.hand->await("suspend"));
    skill_.hand->execution().atRest();
    EXPECT_EQ(watch_->nextName(), "RunningToSuspended");
    ASSERT_EQ(call("Halt"), "Good");
    EXPECT_EQ(watch_->nextName(), "SuspendedToHalted");
}

TEST_F(StateMachine, ResetLeadsFromSuspendedAndHaltedToReady) {
    suspend();
    ASSERT_EQ(call("Reset"), "Good");
    EXPECT_EQ(watch_->nextName(), "SuspendedToReady");
    halt();
    ASSERT_EQ(call("Reset"), "Good");
    EXPECT_EQ(watch_->nextName(), "HaltedToReady");
}

TEST_F(StateMachine, StaysHaltedAndSaysWhyIfTheDeviceDoesNotAgreeToReset) {
    halt();
    skill_.hand->refuseReset({Errc::device_fault, "axis 2: brake still closed"});
    EXPECT_EQ(call("Reset"), "BadDeviceFailure");
    EXPECT_EQ(state(), "Halted");
    EXPECT_THAT(read(*client_, skill_, "ReasonText"), HasSubstr("axis 2: brake still closed"));
}

TEST_F(StateMachine, SaysWhyItIsHaltedAlsoAfterARefusedCommand) {
    start();
    skill_.hand->execution().fail(skill::Reason::error, "axis 2 is hot: 91 C");
    EXPECT_EQ(watch_->nextName(), "RunningToHalted");
    EXPECT_EQ(call("Start"), "BadInvalidState");
    EXPECT_THAT(read(*client_, skill_, "ReasonText"), HasSubstr("axis 2 is hot: 91 C"));
    skill_.hand->refuseReset({Errc::device_fault, "brake still closed"});
    EXPECT_EQ(call("Reset"), "BadDeviceFailure");
    EXPECT_EQ(write(*client_, skill_, "ParameterSet/TargetJointPosition",
                    opcua::Value::of(std::string("no numbers"))),
              "BadTypeMismatch");
    EXPECT_THAT(read(*client_, skill_, "ReasonText"), HasSubstr("brake still closed"));
}

TEST_F(StateMachine, TellsTheCallerWhyStartWasRefused) {
    writeTarget();
    skill_.hand->refuseStart({Errc::unreachable, "axis 1 would need 3.4 rad, limit 2.9 rad"});
    const auto refused = call("Start");
    EXPECT_EQ(refused, opcua::statusFrom(Errc::unreachable).name());
    EXPECT_EQ(read(*client_, skill_, "ReasonText"), "axis 1 would need 3.4 rad, limit 2.9 rad");
    const auto other = connect("bystander");
    EXPECT_EQ(read(*other, skill_, "ReasonText"), "");
    EXPECT_EQ(state(), "Ready");
}

TEST_F(StateMachine, InactiveSubStatesAnswerBadStateNotActive) {
    EXPECT_EQ(readAs<opcua::LocalizedText>(*client_, skill_, "ReadySubStates/CurrentState").text,
              "ReadyNotConfigured");
    EXPECT_EQ(read(*client_, skill_, "RunningSubStates/CurrentState"), "BadStateNotActive");
    EXPECT_EQ(read(*client_, skill_, "HaltedSubStates/CurrentState/Number"), "BadStateNotActive");
    halt();
    EXPECT_EQ(read(*client_, skill_, "ReadySubStates/CurrentState/Id"), "BadStateNotActive");
    EXPECT_EQ(readAs<opcua::LocalizedText>(*client_, skill_, "HaltedSubStates/CurrentState").text,
              "HaltedByClient");
    EXPECT_EQ(readAs<std::uint32_t>(*client_, skill_, "HaltedSubStates/CurrentState/Number"), 111U);
}

/// A force move: its type has a state machine of how it ended.
class ForceMove : public ServedSkills {
protected:
    static skill::SkillDescription description() {
        auto description = linearMoveDescription();
        description.name = "CartesianLinearForceMoveSkill";
        description.type = "CartesianLinearForceMoveSkillType";
        auto parameters = description.parameters.toVector();
        parameters.front().default_value = skill::Frame{0, 0, 1, 0, 0, 0};
        description.parameters = std::move(parameters);
        auto results = robot_skills::forceMoveResultFields().fields();
        for (auto& result : results) {
            result.place = skill::Place::final_result;
        }
        description.results = std::move(results);
        return description;
    }
    ForceMove() : skill_(add(description())) {
        serve();
        client_ = connect();
        watch_ = std::make_unique<TransitionWatch>(*client_, skill_.id);
    }
    void start() {
        ASSERT_EQ(call(*client_, skill_, "Start"), "Good");
        ASSERT_EQ(watch_->nextName(), "ReadyToRunning");
        ASSERT_TRUE(skill_.hand->await("start"));
    }
    std::string finish() { return read(*client_, skill_, "FinishStateMachine/CurrentState"); }
    std::string text() {
        return readAs<opcua::LocalizedText>(*client_, skill_, "FinishStateMachine/CurrentState")
            .text;
    }
    opcua::NodeId id() {
        return readAs<opcua::NodeId>(*client_, skill_, "FinishStateMachine/CurrentState/Id");
    }

    ServedSkill skill_;
    std::unique_ptr<opcua::Client> client_;
    std::unique_ptr<TransitionWatch> watch_;
};

TEST_F(ForceMove, TellsWhetherAForceEndedIt) {
    EXPECT_EQ(finish(), "BadStateNotActive");
    start();
    EXPECT_EQ(finish(), "BadStateNotActive");
    skill_.hand->execution().finish({{"ForcesExceeded", skill::Vector3{}}});
    ASSERT_EQ(watch_->nextName(), "RunningToReady");
    const auto success = id();
    EXPECT_EQ(text(), "Success");
    EXPECT_EQ(success, opcua::NodeId(success.namespaceIndex(), 16106U));
    start();
    skill_.hand->execution().finish({{"ForcesExceeded", skill::Vector3{0, 0, 21}}});
    ASSERT_EQ(watch_->nextName(), "RunningToReady");
    EXPECT_EQ(text(), "ForceExceeded");
    EXPECT_EQ(id(), opcua::NodeId(success.namespaceIndex(), 16105U));
}

TEST_F(ForceMove, ThatHaltsOnAForceTellsSo) {
    start();
    skill_.hand->execution().fail(skill::Reason::force_exceeded, "21 N over 20 N");
    ASSERT_EQ(watch_->nextName(), "RunningToHalted");
    EXPECT_EQ(text(), "ForceExceeded");
    ASSERT_EQ(call(*client_, skill_, "Reset"), "Good");
    ASSERT_EQ(watch_->nextName(), "HaltedToReady");
    EXPECT_EQ(finish(), "BadStateNotActive");
    ASSERT_EQ(call(*client_, skill_, "Halt"), "Good");
    ASSERT_EQ(watch_->nextName(), "ReadyToHalted");
    EXPECT_EQ(finish(), "BadStateNotActive");
}

TEST_F(StateMachine, AnErrorHaltsWithItsReason) {
    start();
    skill_.hand->execution().fail(skill::Reason::limit_violated,
                                  "axis 1: 2.6 rad/s over 2.5 rad/s");
    const auto seen = watch_->next();
    ASSERT_TRUE(seen);
    EXPECT_EQ(seen->transition, "RunningToHalted");
    EXPECT_EQ(seen->reason, 7);
    EXPECT_EQ(seen->reason_text, "axis 1: 2.6 rad/s over 2.5 rad/s");
    EXPECT_EQ(readAs<opcua::LocalizedText>(*client_, skill_, "HaltedSubStates/CurrentState").text,
              "HaltedLimit");
}

TEST_F(StateMachine, UserExecutableTellsBeforehand) {
    const auto executable = [&](std::string_view method) {
        return client_->readUserExecutable(skill_.node(method)).value_or(false);
    };
    writeTarget();
    EXPECT_TRUE(executable("Start"));
    EXPECT_TRUE(executable("Halt"));
    EXPECT_FALSE(executable("Resume"));
    EXPECT_FALSE(executable("Reset"));
    const auto other = connect("other");
    EXPECT_FALSE(other->readUserExecutable(skill_.node("Start")).value_or(true));
    halt();
    EXPECT_FALSE(executable("Start"));
    EXPECT_TRUE(executable("Reset"));
}

TEST_F(StateMachine, LastTransitionIsKept) {
    start();
    EXPECT_EQ(readAs<opcua::LocalizedText>(*client_, skill_, "LastTransition").text,
              "ReadyToRunning");
    EXPECT_EQ(readAs<std::uint32_t>(*client_, skill_, "LastTransition/Number"), 2U);
    EXPECT_EQ(readAs<opcua::NodeId>(*client_, skill_, "LastTransition/Id"),
              opcua::NodeId(0, 2410U));
    EXPECT_GT(readAs<UtcTime>(*client_, skill_, "LastTransition/TransitionTime"), UtcTime{});
}

TEST_F(StateMachine, TheDiagnosticTellsWhoCalledWhatWithWhichOutcome) {
    start();
    EXPECT_EQ(call("Reset"), "BadInvalidState");
    EXPECT_EQ(read(*client_, skill_, "ProgramDiagnostic/LastMethodCall"), "Reset");
    EXPECT_EQ(
        readAs<opcua::StatusCode>(*client_, skill_, "ProgramDiagnostic/LastMethodReturnStatus"),
        opcua::status::kBadInvalidState);
    const auto whole = readAs<opcua::ProgramDiagnostic>(*client_, skill_, "ProgramDiagnostic");
    EXPECT_FALSE(whole.last_method_session_id.isNull());
    EXPECT_GT(whole.last_method_call_time, whole.invocation_creation_time);
    EXPECT_EQ(whole.last_method_return_status, opcua::status::kBadInvalidState);
}

TEST_F(StateMachine, TheDiagnosticKeepsWhatStartWasCalledWith) {
    start();
    const auto whole = readAs<opcua::ProgramDiagnostic>(*client_, skill_, "ProgramDiagnostic");
    ASSERT_EQ(whole.last_method_input_arguments.size(), 1U);
    EXPECT_EQ(whole.last_method_input_arguments[0].name, "TargetJointPosition");
    EXPECT_EQ(whole.last_method_input_values[0], opcua::Value::of(std::vector{0.5, 1.0}));
}

}  // namespace
}  // namespace metier::opcua_skill::testing
