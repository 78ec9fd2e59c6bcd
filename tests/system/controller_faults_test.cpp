// Faults of a controller, and actions of people at it: each row ends in Halted with a reason and a
// text, within a stated time, and has a way back.
#include <gmock/gmock.h>

#include <functional>
#include <span>

#include "arm_bench.hpp"
#include "metier/edo_driver/encoder.hpp"
#include "metier/edo_driver/websocket_link.hpp"
#include "metier/link/tcp_link.hpp"

namespace metier::system_tests {
namespace {

using skill::Reason;
using skill::State;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

using Act = std::function<void(ArmBench&)>;

Act inject(const std::string& fault, const std::string& value = "") {
    return [=](ArmBench& arm) { arm.inject(fault, value); };
}

/// Somebody else sends lines to the script port of a UR, and stays connected.
Act sendScript(const std::string& text) {
    return [text, link = std::shared_ptr<link::TcpLink>()](ArmBench& arm) mutable {
        constexpr std::uint16_t kSecondary = 30002;
        link = std::make_shared<link::TcpLink>(
            link::TcpLink::connect(arm.address(), kSecondary, inAMinute()).value());
        arm.happensNow();
        EXPECT_TRUE(link->send(std::as_bytes(std::span(text)), inAMinute()));
    };
}

/// A person does it at the pendant of a UR, here at its dashboard.
void atThePendant(ArmBench& arm, const std::string& command) {
    constexpr std::uint16_t kDashboard = 29999;
    auto link = link::TcpLink::connect(arm.address(), kDashboard, inAMinute()).value();
    const auto skipLine = [&] {
        std::array<std::byte, 1> letter{};
        while (letter[0] != std::byte{'\n'}) {
            ASSERT_TRUE(link.receive(letter, inAMinute())) << "no answer to " << command;
        }
    };
    skipLine();  // the greeting
    const auto line = command + "\n";
    EXPECT_TRUE(link.send(std::as_bytes(std::span(line)), inAMinute()));
    skipLine();
}

void popup(ArmBench& arm) {
    arm.happensNow();
    atThePendant(arm, "popup Mind the gap");
}

void pause(ArmBench& arm) {
    arm.happensNow();
    atThePendant(arm, "pause");
}

void powerOn(ArmBench& arm) {
    arm.awaitState("robot_mode", "POWER_OFF");
    atThePendant(arm, "brake release");
    arm.awaitState("robot_mode", "RUNNING");
}

void restartSafety(ArmBench& arm) {
    atThePendant(arm, "restart safety");
    powerOn(arm);
}

/// Another client of an e.DO gives back the control that the driver has taken.
Act takeControlAway(int mode) {
    return [=](ArmBench& arm) {
        constexpr std::uint16_t kRosbridge = 9090;
        auto link =
            edo_driver::WebSocketLink::connect(arm.address(), kRosbridge, inAMinute()).value();
        arm.happensNow();
        EXPECT_TRUE(link.send(edo_driver::controlSwitchCallText("other", mode), inAMinute()));
        EXPECT_TRUE(link.receive(inAMinute())) << "no answer";
    };
}

struct ControllerFault {
    const char* name;
    ArmCase arm;
    When when;
    Act happens;
    Reason reason;
    const char* text;        ///< part of what the skill says; the device's name is before it
    Act undo{};              ///< Reset is refused before it; empty: Reset alone leads back
    bool elsewhere = false;  ///< the arm is elsewhere after that
};

void PrintTo(const ControllerFault& fault, std::ostream* out) {
    *out << fault.name;
}

class FaultOfTheController : public ::testing::TestWithParam<ControllerFault> {
protected:
    ArmBench arm_{GetParam().arm};
};

TEST_P(FaultOfTheController, HaltsTheSkillAndHasAWayBack) {
    const auto& fault = GetParam();
    ASSERT_NO_FATAL_FAILURE(arm_.bring(fault.when));
    fault.happens(arm_);
    const auto halted = arm_.haltedAfterInjection();
    EXPECT_EQ(halted.reason, fault.reason) << halted.reason_text;
    EXPECT_THAT(halted.reason_text, StartsWith("arm: "));
    EXPECT_THAT(halted.reason_text, HasSubstr(fault.text));
    arm_.expectAtRestOnTheWay();
    if (fault.undo) {
        EXPECT_FALSE(arm_.skill().reset()) << "it is still there";
        fault.undo(arm_);
    }
    if (fault.elsewhere) {
        arm_.beginAnew();
    }
    arm_.expectResetAndMove();
}

std::string nameOf(const ::testing::TestParamInfo<ControllerFault>& info) {
    return std::string(info.param.arm.name) + "_" + info.param.name + "_" +
           toString(info.param.when);
}

const ArmCase kUr5{.name = "ur5", .axis_1 = 1.0, .speed = 0.1};
const ArmCase kIiwa{"iiwa", 1.0};
const ArmCase kEdo{"edo", 0.6};
const ArmCase kClassicEdo{"edo_classic", 0.6};

// An arm that leaves a safety stop of a UR has waited for the 5 s of docs/protocols/ur.md.
INSTANTIATE_TEST_SUITE_P(
    Ur, FaultOfTheController,
    ::testing::Values(
        ControllerFault{"limit", kUr5, When::moving, inject("limit", "2"), Reason::error,
                        "the controller says: C150"},
        ControllerFault{"protective_stop", kUr5, When::suspended, inject("protective-stop"),
                        Reason::error, "protective stop"},
        ControllerFault{"protective_stop", kUr5, When::ready, inject("protective-stop"),
                        Reason::error, "protective stop"},
        ControllerFault{"safeguard_stop", kUr5, When::moving, inject("safeguard-stop"),
                        Reason::error, "safeguard stop: close the safeguard",
                        inject("close-safeguard")},
        ControllerFault{"safeguard_stop", kUr5, When::suspended, inject("safeguard-stop"),
                        Reason::error, "safeguard stop", inject("close-safeguard")},
        ControllerFault{"violation", kUr5, When::moving, inject("violation"), Reason::error,
                        "violation: restart the safety system", restartSafety},
        ControllerFault{"recovery_mode", kUr5, When::moving, inject("recovery-mode"), Reason::error,
                        "recovery: an axis is outside of its limits; move it back at the pendant",
                        inject("end-recovery")},
        ControllerFault{"recovery_mode", kUr5, When::ready, inject("recovery-mode"), Reason::error,
                        "recovery: an axis is outside of its limits", inject("end-recovery")},
        ControllerFault{"emergency_stop", kUr5, When::ready, inject("emergency-stop"),
                        Reason::error, "emergency stop",
                        [](ArmBench& arm) {
                            arm.inject("release-emergency-stop");
                            EXPECT_FALSE(arm.skill().reset()) << "the arm has no power";
                            powerOn(arm);
                        }},
        ControllerFault{"program_stop", kUr5, When::moving, inject("program-stop"), Reason::error,
                        "someone stopped it"},
        ControllerFault{"pause_at_the_dashboard", kUr5, When::moving, pause, Reason::error,
                        "the controller's program is paus"},
        ControllerFault{"program_of_another_client", kUr5, When::moving,
                        sendScript("def other():\n  sleep(0.1)\nend\n"), Reason::error,
                        "someone stopped it"},
        ControllerFault{"speed_slider", kUr5, When::moving, sendScript("set speed 0.5\n"),
                        Reason::error, "runs at 50 % of the speed: put its speed slider to 100 %",
                        sendScript("set speed 1.0\n")}),
    nameOf);

INSTANTIATE_TEST_SUITE_P(
    Iiwa, FaultOfTheController,
    ::testing::Values(
        ControllerFault{"not_ready", kIiwa, When::moving, inject("not-ready"), Reason::error,
                        "not ready to move", inject("ready")},
        ControllerFault{"not_ready", kIiwa, When::suspended, inject("not-ready"), Reason::error,
                        "not ready to move", inject("ready")},
        ControllerFault{"not_ready", kIiwa, When::ready, inject("not-ready"), Reason::error,
                        "not ready to move", inject("ready")},
        ControllerFault{"T1", kIiwa, When::moving, inject("operating-mode", "T1"), Reason::error,
                        "not ready to move", inject("operating-mode", "AUT")},
        ControllerFault{"T2", kIiwa, When::suspended, inject("operating-mode", "T2"), Reason::error,
                        "not ready to move", inject("operating-mode", "AUT")},
        ControllerFault{"T1", kIiwa, When::ready, inject("operating-mode", "T1"), Reason::error,
                        "not ready to move", inject("operating-mode", "AUT")},
        ControllerFault{"limit", kIiwa, When::moving, inject("limit"), Reason::error, "not ready",
                        inject("ready")},
        ControllerFault{"emergency_stop", kIiwa, When::moving, inject("emergency-stop"),
                        Reason::error, "not ready", inject("release-emergency-stop")},
        ControllerFault{"end_of_the_application", kIiwa, When::moving, inject("end-application"),
                        Reason::device_lost, "closed the connection"},
        ControllerFault{"end_of_the_application", kIiwa, When::ready, inject("end-application"),
                        Reason::device_lost, "closed the connection"}),
    nameOf);

/// Faults that both generations of an e.DO's software have.
std::vector<ControllerFault> faultsOfAnEdo() {
    std::vector<ControllerFault> faults;
    for (const auto& arm : {kEdo, kClassicEdo}) {
        const auto add = [&](ControllerFault fault) {
            fault.arm = arm;
            faults.push_back(std::move(fault));
        };
        add({"following_error", arm, When::moving, inject("following-error", "2"), Reason::error,
             "BRAKED"});
        add({"limit", arm, When::moving, inject("limit", "3"), Reason::error, "BRAKED"});
        add({"silent_joint", arm, When::moving, inject("joint-silent", "2"), Reason::error,
             "a joint is absent", inject("joint-silent", "0")});
        add({"silent_joints", arm, When::moving, inject("joint-silent", "all"), Reason::device_lost,
             "no joint states for 1000 ms", inject("restart"), true});
        add({"overcurrent", arm, When::moving, inject("overcurrent", "1"), Reason::error,
             "overcurrent", inject("restart"), true});
        add({"lost_calibration", arm, When::ready, inject("uncalibrate"), Reason::error,
             "calibrate", inject("restart"), true});
        add({"brake", arm, When::suspended, inject("brake"), Reason::error, "BRAKED"});
        add({"brake", arm, When::ready, inject("brake"), Reason::error, "BRAKED"});
        add({"emergency_stop", arm, When::moving, inject("emergency-stop"), Reason::error,
             "emergency stop", inject("release-emergency-stop")});
    }
    faults.push_back({"control_taken_away", kEdo, When::moving, takeControlAway(0), Reason::error,
                      "control was taken away"});
    faults.push_back({"control_taken_away", kClassicEdo, When::moving, takeControlAway(2),
                      Reason::error, "control was taken away"});
    faults.push_back(
        {"collision", kClassicEdo, When::moving, inject("collision"), Reason::error, "BRAKED"});
    return faults;
}

INSTANTIATE_TEST_SUITE_P(Edo, FaultOfTheController, ::testing::ValuesIn(faultsOfAnEdo()), nameOf);

/// An event of a controller that is no reason to halt anything.
struct Harmless {
    const char* name;
    ArmCase arm;
    When when;
    Act happens;
};

void PrintTo(const Harmless& event, std::ostream* out) {
    *out << event.name;
}

class HarmlessToASkill : public ::testing::TestWithParam<Harmless> {
protected:
    ArmBench arm_{GetParam().arm};
};

TEST_P(HarmlessToASkill, WhichGoesOnToItsTarget) {
    ASSERT_NO_FATAL_FAILURE(arm_.bring(GetParam().when));
    GetParam().happens(arm_);
    if (GetParam().when == When::suspended) {
        ASSERT_TRUE(arm_.skill().resume()) << arm_.skill().reasonText();
    }
    const auto ended = arm_.endWithin(std::chrono::seconds(60));
    EXPECT_EQ(ended.to, State::ready) << ended.reason_text;
    EXPECT_NEAR(arm_.position(), arm_.home().front() + GetParam().arm.axis_1, 2e-3);
}

INSTANTIATE_TEST_SUITE_P(Devices, HarmlessToASkill,
                         ::testing::Values(Harmless{"failed_motion", kIiwa, When::suspended,
                                                    inject("protective-stop")},
                                           Harmless{"popup", kUr5, When::moving, popup},
                                           Harmless{"popup", kUr5, When::suspended, popup}),
                         [](const auto& event) {
                             return std::string(event.param.arm.name) + "_" + event.param.name +
                                    "_" + toString(event.param.when);
                         });

TEST(PopupOfAnotherProgram, HaltsTheSkillAndIsGoneBeforeTheNextMove) {
    ArmBench arm(kUr5);
    ASSERT_NO_FATAL_FAILURE(arm.bring(When::moving));
    sendScript(
        "def other():\n  popup(\"Is the box empty?\", \"Other\", False, False, True)\nend\n")(arm);
    const auto halted = arm.haltedAfterInjection();
    EXPECT_EQ(halted.reason, Reason::error);
    EXPECT_THAT(halted.reason_text,
                AnyOf(HasSubstr("the script on the controller took no set-point"),
                      HasSubstr("someone stopped it")));
    arm.expectAtRestOnTheWay();
    arm.awaitState("runtime_state", "stopped");  // by the driver: its own script did not end
    arm.expectResetAndMove();
}

TEST(LocalControl, RefusesAMoveUntilSomebodySwitchesToRemoteControl) {
    ArmBench arm({"ur5e", 1.0});
    arm.inject("local-control");
    ASSERT_TRUE(arm.skill().set("TargetJointPosition", arm.home()));
    ASSERT_TRUE(arm.skill().start());
    const auto halted = arm.haltedAfterInjection();
    EXPECT_EQ(halted.reason, Reason::error);
    EXPECT_THAT(halted.reason_text, HasSubstr("switch it to remote control"));
    arm.inject("remote-control");
    arm.expectResetAndMove();
}

TEST(DroppedCommand, OfAnEdoIsTriedAgainByTheNextReset) {
    ArmBench arm(kEdo);
    arm.inject("brake");
    arm.haltedAfterInjection();
    arm.inject("drop-next", "1");
    const auto deadline = inAMinute();
    while (arm.skill().reasonText().find("dropped the reset without a word") == std::string::npos) {
        ASSERT_FALSE(arm.skill().reset());
        ASSERT_LT(std::chrono::steady_clock::now(), deadline) << arm.skill().reasonText();
    }
    arm.expectResetAndMove();
}

}  // namespace
}  // namespace metier::system_tests
