// A gripper on its maker's wire: parts that are held, missed, lost or of another width, its own
// faults, and its cable.
#include <gmock/gmock.h>

#include <ostream>

#include "metier/base/queue.hpp"
#include "metier_program.hpp"
#include "running_cell.hpp"

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;
using skill::Reason;
using skill::State;
using ::testing::HasSubstr;

constexpr auto kNoticed = 5s;

/// A gripper on its maker's wire, with its jaws open.
class GripperOnItsWire : public ::testing::Test {
protected:
    void SetUp() override {
        resetAll();
        const auto opened = release_.run({}, inAMinute());
        ASSERT_TRUE(opened) << opened.error().message;
    }

    /// Makes both skills ready: Reset acknowledges the gripper's fault and homes it.
    void resetAll() {
        const auto deadline = inAMinute();
        for (auto* skill : {&grasp_, &release_}) {
            while (*skill->state() != State::ready && !skill->reset()) {
                ASSERT_LT(std::chrono::steady_clock::now(), deadline) << skill->reasonText();
            }
        }
    }

    /// Starts a grasp of some seconds, and waits until the jaws move.
    void startGrasp() {
        ASSERT_TRUE(grasp_.start());
        const auto deadline = inAMinute();
        while (cell_.state("controller").at("velocity") == 0.0) {
            ASSERT_LT(std::chrono::steady_clock::now(), deadline) << "the jaws do not move";
        }
    }
    /// Hears of the gripper's live PartHeld, its value now first.
    opcua::Subscription watchPartHeld(Queue<bool>& heard) {
        const auto metier = client_->namespaceIndex("urn:metier:skills").value();
        const auto node =
            client_->translate(grasp_.address().controller()->node, {{metier, "PartHeld"}});
        return client_
            ->subscribeData(node.value(), {},
                            [&](const opcua::DataValue& now) {
                                if (const auto held = now.value.as<bool>()) {
                                    heard.tryPush(*held);
                                }
                            })
            .value();
    }
    void inject(const std::string& fault, const std::string& value = "") {
        injected_ = std::chrono::system_clock::now();
        cell_.inject("controller", fault, value);
    }
    /// The Halted of a skill that runs, within kNoticed by the product's own time stamps.
    skill::TransitionEvent endOfGrasp() {
        const auto end = grasp_.awaitEnd(inAMinute()).value();
        EXPECT_EQ(end.to, State::halted);
        EXPECT_LT(end.time - injected_, kNoticed);
        return end;
    }
    void expectReleases() {
        resetAll();
        const auto released = release_.run({}, inAMinute());
        EXPECT_TRUE(released) << released.error().message;
    }

    UtcTime injected_{};
    RunningCell cell_{deviceCell("wsg50")};
    std::unique_ptr<opcua::Client> client_ = connectTo(cell_.url("gripper"));
    client::SkillHandle grasp_ = openSkill(*client_, "GraspGripperSkill");
    client::SkillHandle release_ = openSkill(*client_, "ReleaseGripperSkill");
};

TEST_F(GripperOnItsWire, HoldsAPartAndLetsItGo) {
    cell_.inject("controller", "part", "30");
    const auto held = grasp_.run({{"Force", 40.0}}, inAMinute());
    ASSERT_TRUE(held) << held.error().message;
    EXPECT_EQ(held->at("PartHeld"), skill::Value(true));
    EXPECT_NEAR(std::get<double>(held->at("WidthReached")), 0.03, 2e-3);
    const auto released = release_.run({}, inAMinute());
    ASSERT_TRUE(released) << released.error().message;
    EXPECT_EQ(released->at("PartHeld"), skill::Value(false));
}

TEST_F(GripperOnItsWire, SaysThatThereIsNoPart) {
    const auto missed = grasp_.run({}, inAMinute());
    ASSERT_FALSE(missed);
    EXPECT_THAT(missed.error().message, HasSubstr("no part"));
    EXPECT_EQ(*grasp_.state(), State::halted);
    resetAll();
    EXPECT_TRUE(release_.run({}, inAMinute()));
}

TEST_F(GripperOnItsWire, IsHaltedByACutCableAndComesBack) {
    cell_.inject("controller", "cut-link");
    ASSERT_TRUE(grasp_.awaitState(State::halted, std::chrono::steady_clock::now() + kNoticed));
    cell_.inject("controller", "restore-link");
    resetAll();
    EXPECT_TRUE(release_.run({}, inAMinute()));
}

TEST_F(GripperOnItsWire, IsHomedByOneResetOfTheCommandLine) {
    cell_.inject("controller", "restart");
    ASSERT_TRUE(grasp_.awaitState(State::halted, inAMinute()));
    Queue<bool> heard{10};
    const auto watch = watchPartHeld(heard);
    ASSERT_EQ(heard.popUntil(inAMinute()), false) << "connected again";
    const auto reset = runMetier({"reset", cell_.url("gripper"), "GraspGripperSkill"});
    EXPECT_EQ(reset.status, 0) << reset.output;
    EXPECT_EQ(*grasp_.state(), State::ready);
}

// ---- parts --------------------------------------------------------------------------------------

TEST_F(GripperOnItsWire, SaysThatAPartIsTooWideOrTooNarrow) {
    cell_.inject("controller", "part", "60");
    const auto wide = grasp_.run({{"Width", 0.03}}, inAMinute());
    ASSERT_FALSE(wide);
    EXPECT_THAT(wide.error().message, HasSubstr("gripper: grasp blocked at 60.0 mm"));
    expectReleases();
    cell_.inject("controller", "part", "10");
    const auto narrow = grasp_.run({{"Width", 0.03}}, inAMinute());
    ASSERT_FALSE(narrow);
    EXPECT_THAT(narrow.error().message, HasSubstr("no part found: the jaws closed to 27.0 mm"));
    expectReleases();
}

TEST_F(GripperOnItsWire, ThatLostItsPartWhileReadySaysSoAtTheNextGrasp) {
    cell_.inject("controller", "part", "30");
    ASSERT_TRUE(grasp_.run({}, inAMinute()));
    cell_.inject("controller", "lost-part");
    EXPECT_EQ(*grasp_.state(), State::ready) << "its execution is over";
    const auto again = grasp_.run({}, inAMinute());
    ASSERT_FALSE(again);
    EXPECT_THAT(again.error().message, HasSubstr("no part found"));
    expectReleases();
    cell_.inject("controller", "part", "30");
    EXPECT_TRUE(grasp_.run({}, inAMinute()));
}

TEST_F(GripperOnItsWire, TellsAtOnceThatItLostItsPartWhileNoSkillRuns) {
    cell_.inject("controller", "part", "30");
    ASSERT_TRUE(grasp_.run({}, inAMinute()));
    Queue<bool> heard{10};
    const auto watch = watchPartHeld(heard);
    EXPECT_EQ(heard.popUntil(inAMinute()), true);
    cell_.inject("controller", "lost-part");
    EXPECT_EQ(heard.popUntil(inAMinute()), false);
    EXPECT_EQ(*grasp_.state(), State::ready);
}

TEST_F(GripperOnItsWire, FindsNoPartThatIsLostOnTheWayToIt) {
    cell_.inject("controller", "part", "20");
    startGrasp();
    cell_.inject("controller", "lost-part");
    const auto end = grasp_.awaitEnd(inAMinute()).value();
    EXPECT_EQ(end.to, State::halted);
    EXPECT_EQ(end.reason, Reason::error);
    EXPECT_THAT(end.reason_text, HasSubstr("gripper: no part found"));
    expectReleases();
}

TEST_F(GripperOnItsWire, SaysWhereItsJawsAreBlocked) {
    cell_.inject("controller", "block", "50");
    auto move = openSkill(*client_, "MoveGripperSkill");
    ASSERT_TRUE(move.reset());
    const auto blocked = move.run({{"Width", 0.02}}, inAMinute());
    ASSERT_FALSE(blocked);
    EXPECT_THAT(blocked.error().message, HasSubstr("gripper: move blocked at 50.0 mm"));
    cell_.inject("controller", "block", "0");
    ASSERT_TRUE(move.reset());
    EXPECT_TRUE(move.run({{"Width", 0.02}}, inAMinute()));
}

TEST_F(GripperOnItsWire, IsAtRestOnceHaltedAndMovesAgainAfterReset) {
    // Halted was published when the jaws began to brake; the next Start was refused.
    for (int i = 0; i < 5; ++i) {
        startGrasp();
        ASSERT_TRUE(grasp_.halt());
        ASSERT_TRUE(grasp_.awaitState(State::halted, inAMinute()));
        EXPECT_EQ(cell_.state("controller").at("velocity"), 0.0);
        ASSERT_TRUE(grasp_.reset()) << grasp_.reasonText();
        ASSERT_TRUE(grasp_.start()) << grasp_.reasonText();
        ASSERT_TRUE(grasp_.halt());
        ASSERT_TRUE(grasp_.awaitState(State::halted, inAMinute()));
        ASSERT_TRUE(grasp_.reset()) << grasp_.reasonText();
        ASSERT_TRUE(release_.run({}, inAMinute()));
    }
}

// ---- faults and the cable -----------------------------------------------------------------------

struct GripperFault {
    const char* name;
    const char* fault;
    const char* value;
    Reason reason;
    const char* text;
    const char* undo = "";  ///< Reset is refused before it; empty: Reset alone leads back
    const char* undo_value = "";
};

void PrintTo(const GripperFault& fault, std::ostream* out) {
    *out << fault.name;
}

class FaultOfTheGripper : public GripperOnItsWire,
                          public ::testing::WithParamInterface<GripperFault> {
protected:
    void expectAWayBack() {
        if (*GetParam().undo != 0) {
            EXPECT_FALSE(grasp_.reset()) << "it is still there";
            cell_.inject("controller", GetParam().undo, GetParam().undo_value);
        }
        expectReleases();
    }
};

TEST_P(FaultOfTheGripper, HaltsAGraspAndHasAWayBack) {
    startGrasp();
    inject(GetParam().fault, GetParam().value);
    const auto halted = endOfGrasp();
    EXPECT_EQ(halted.reason, GetParam().reason) << halted.reason_text;
    EXPECT_THAT(halted.reason_text, HasSubstr("gripper: "));
    EXPECT_THAT(halted.reason_text, HasSubstr(GetParam().text));
    expectAWayBack();
}

TEST_P(FaultOfTheGripper, HaltsWhatIsReadyAndHasAWayBack) {
    inject(GetParam().fault, GetParam().value);
    ASSERT_TRUE(grasp_.awaitState(State::halted, inAMinute()));
    ASSERT_TRUE(release_.awaitState(State::halted, inAMinute())) << "and every other skill";
    EXPECT_THAT(grasp_.reasonText(), HasSubstr(GetParam().text));
    expectAWayBack();
}

INSTANTIATE_TEST_SUITE_P(
    Wsg50, FaultOfTheGripper,
    ::testing::Values(GripperFault{"fast_stop", "fast-stop", "", Reason::error, "fast stop"},
                      GripperFault{"too_hot", "temperature-fault", "", Reason::error, "temperature",
                                   "temperature-fault", "off"},
                      GripperFault{"cut_link", "cut-link", "", Reason::device_lost, "for 1000 ms",
                                   "restore-link"},
                      GripperFault{"late_link", "delay", "3000", Reason::device_lost, "for 1000 ms",
                                   "restore-link"},
                      GripperFault{"garbled_link", "garble", "1000", Reason::device_lost,
                                   "for 1000 ms", "restore-link"},
                      GripperFault{"restart", "restart", "", Reason::device_lost, ""}),
    [](const auto& fault) { return std::string(fault.param.name); });

TEST_F(GripperOnItsWire, HoldsAPartOverALinkThatIsLateWithinWhatTheDriverAllows) {
    cell_.inject("controller", "part", "30");
    startGrasp();
    cell_.inject("controller", "delay", "150");
    const auto end = grasp_.awaitEnd(inAMinute()).value();
    EXPECT_EQ(end.to, State::ready) << end.reason_text;
    EXPECT_EQ(grasp_.result().value().at("PartHeld"), skill::Value(true));
    EXPECT_TRUE(release_.run({}, inAMinute()));
}

// ---- a gripper of the arm's own controller
// --------------------------------------------------------

TEST(BuiltInGripper, ShowsAtTheArmsControllerThatItHoldsNoPart) {
    RunningCell cell(deviceCell("edo"));
    const auto client = connectTo(cell.url("arm"));
    const auto grasp = openSkill(*client, "GraspGripperSkill");
    const auto metier = client->namespaceIndex("urn:metier:skills").value();
    const auto node =
        client->translate(grasp.address().controller()->node, {{metier, "PartHeld"}}).value();
    EXPECT_EQ(client->read(node).value(), opcua::Value::of(false));
}

}  // namespace
}  // namespace metier::system_tests
