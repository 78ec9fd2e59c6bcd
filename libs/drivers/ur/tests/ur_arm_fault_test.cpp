// Causes of a stop of the arm, and the way back to motion.

#include <algorithm>

#include "arm_fixture.hpp"
#include "metier/device/reset_slot.hpp"

namespace metier::ur_driver {
namespace {

TEST_F(ArmTest, AProtectiveStopEndsTheMotionWithTheControllersReason) {
    openReady();
    auto source = moving();
    fake_.sayError(153, 2, "Position deviates from path");
    fake_.set([](auto& k) { k.safety_mode = 3; });
    EXPECT_EQ(source->outcome(), EndCause::safety);
    EXPECT_EQ(source->safety().state, SafetyState::protective_stop);
    EXPECT_THAT(source->safety().text, AllOf(HasSubstr("ur5: protective stop")));
    EXPECT_TRUE(fake_.await([&] {
        return arm().safety().text.find("C153A2: Position deviates from path") != std::string::npos;
    })) << arm().safety().text;
    EXPECT_THAT(attachError(), HasSubstr("protective stop"));
}

TEST_F(ArmTest, ResetUnlocksAProtectiveStopAndEndsThePausedProgram) {
    openReady();
    auto source = moving();
    fake_.set([](auto& k) { k.safety_mode = 3; });
    EXPECT_EQ(source->outcome(), EndCause::safety);
    EXPECT_EQ(resetUntilDone(), "");
    EXPECT_EQ(arm().safety().state, SafetyState::normal);
    EXPECT_FALSE(fake_.programRuns());
    EXPECT_THAT(fake_.commands(), testing::IsSupersetOf({"close safety popup", "close popup",
                                                         "unlock protective stop", "stop"}));
    EXPECT_EQ(fake_.uploads(), 1);
    EXPECT_EQ(attach(0.1, 20)->outcome(), EndCause::done);
    EXPECT_EQ(fake_.uploads(), 2);
}

TEST_F(ArmTest, ResetUnlocksNoArmThatStillMoves) {
    openReady();
    fake_.set([](auto& k) {
        k.safety_mode = 3;
        k.coasting = 0.3;
    });
    ASSERT_TRUE(becomes(SafetyState::protective_stop));
    ASSERT_TRUE(fake_.await([&] { return !arm().state().standstill; }));
    EXPECT_THAT(resetUntilDone(), HasSubstr("ur5: the arm still moves"));
    EXPECT_THAT(fake_.commands(), testing::IsEmpty());
    fake_.set([](auto& k) { k.coasting = 0.0; });
    ASSERT_TRUE(fake_.await([&] { return arm().state().standstill; }));
    EXPECT_EQ(resetUntilDone(), "");
}

TEST_F(ArmTest, ResetPowersNoArmOnThatStillMoves) {
    fake_.set([](auto& k) {
        k.robot_mode = 3;
        k.coasting = 0.3;
    });
    open({{"power_on", true}});
    ASSERT_TRUE(becomes(SafetyState::fault));
    ASSERT_TRUE(fake_.await([&] { return !arm().state().standstill; }));
    EXPECT_THAT(resetUntilDone(), HasSubstr("ur5: the arm still moves"));
    EXPECT_THAT(fake_.commands(), testing::IsEmpty());
}

TEST_F(ArmTest, ResetTellsHowLongAProtectiveStopIsLocked) {
    openReady({{"unlock_delay", 5.0}});
    fake_.set([](auto& k) { k.safety_mode = 3; });
    ASSERT_TRUE(becomes(SafetyState::protective_stop));
    EXPECT_THAT(resetUntilDone(), HasSubstr("ur5: the protective stop can be unlocked in "));
}

class ArmWithoutDashboard : public ArmTest {
protected:
    void SetUp() override {
        openReady({{"dashboard_port", static_cast<double>(nobody_.number())}, {"power_on", true}});
    }
    /// Resets until the dashboard was asked for; what it says then.
    std::string resetWithoutDashboard() {
        Result<void> reset;
        fake_.await([&] {
            reset = arm().resetFault();
            return !reset && reset.error().code == Errc::connection_lost;
        });
        return reset ? "" : reset.error().message;
    }

private:
    const ReservedPort nobody_;
};

TEST_F(ArmWithoutDashboard, ResetTellsThatAProtectiveStopCannotBeUnlocked) {
    fake_.set([](auto& k) { k.safety_mode = 3; });
    ASSERT_TRUE(becomes(SafetyState::protective_stop));
    EXPECT_THAT(resetWithoutDashboard(), HasSubstr("ur5: 127.0.0.1:"));
    EXPECT_EQ(arm().safety().state, SafetyState::protective_stop);
}

TEST_F(ArmWithoutDashboard, ResetTellsThatTheArmCannotBePoweredOn) {
    fake_.set([](auto& k) { k.robot_mode = 3; });
    ASSERT_TRUE(becomes(SafetyState::fault));
    EXPECT_THAT(resetWithoutDashboard(), HasSubstr("ur5: 127.0.0.1:"));
    EXPECT_EQ(arm().safety().state, SafetyState::fault);
}

TEST_F(ArmWithoutDashboard, ResetTellsThatAPausedProgramCannotBeStopped) {
    auto source = moving();
    fake_.set([](auto& k) { k.runtime = 4; });
    EXPECT_EQ(source->outcome(), EndCause::safety);
    EXPECT_THAT(resetWithoutDashboard(), HasSubstr("ur5: 127.0.0.1:"));
    EXPECT_EQ(arm().safety().state, SafetyState::protective_stop);
}

TEST_F(ArmTest, ResetTellsThatTheControllerDoesNotUnlock) {
    fake_.set([](auto& k) {
        k.safety_mode = 3;
        k.unlock_reply = "Cannot unlock protective stop until 5s after occurrence";
    });
    open();
    ASSERT_TRUE(becomes(SafetyState::protective_stop));
    EXPECT_THAT(resetUntilDone(), HasSubstr("Cannot unlock protective stop until 5s"));
}

TEST_F(ArmTest, AnEmergencyStopHoldsUntilAPersonReleasesIt) {
    openReady();
    auto source = moving();
    fake_.set([](auto& k) { k.safety_mode = 7; });
    EXPECT_EQ(source->outcome(), EndCause::safety);
    EXPECT_EQ(source->safety().state, SafetyState::emergency_stop);
    EXPECT_THAT(resetUntilDone(), HasSubstr("robot emergency stop: release it"));
    fake_.set([](auto& k) {
        k.safety_mode = 1;
        k.robot_mode = 3;
    });
    ASSERT_TRUE(becomes(SafetyState::fault));
    EXPECT_THAT(arm().safety().text, HasSubstr("robot mode POWER_OFF: power on and release"));
    EXPECT_THAT(attachError(), HasSubstr("POWER_OFF"));
    EXPECT_THAT(resetUntilDone(), HasSubstr("at the pendant"));
    EXPECT_THAT(fake_.commands(), testing::Not(testing::Contains("power on")));
}

TEST_F(ArmTest, ASafeguardStopTellsToCloseIt) {
    openReady();
    fake_.set([](auto& k) { k.safety_mode = 5; });
    ASSERT_TRUE(becomes(SafetyState::protective_stop));
    EXPECT_THAT(arm().safety().text, HasSubstr("safeguard stop: close the safeguard"));
    fake_.set([](auto& k) { k.safety_mode = 1; });
    EXPECT_TRUE(becomes(SafetyState::normal));
}

TEST_F(ArmTest, ResetPowersOnIfThatWasAllowed) {
    fake_.set([](auto& k) { k.robot_mode = 3; });
    open({{"power_on", true}});
    ASSERT_TRUE(becomes(SafetyState::fault));
    EXPECT_EQ(resetUntilDone(), "");
    EXPECT_TRUE(becomes(SafetyState::normal));
    EXPECT_THAT(fake_.commands(), testing::ElementsAre("power on", "brake release"));
}

TEST_F(ArmTest, ResetReleasesOnlyTheBrakesOfAnArmThatHasPower) {
    fake_.set([](auto& k) { k.robot_mode = 5; });
    open({{"power_on", true}});
    ASSERT_TRUE(becomes(SafetyState::fault));
    EXPECT_EQ(resetUntilDone(), "");
    EXPECT_THAT(fake_.commands(), testing::ElementsAre("brake release"));
}

TEST_F(ArmTest, ResetTellsThatTheControllerDoesNotPowerOn) {
    fake_.set([](auto& k) {
        k.robot_mode = 3;
        k.power_reply = "Failed to execute: power on";
    });
    open({{"power_on", true}});
    ASSERT_TRUE(becomes(SafetyState::fault));
    EXPECT_THAT(resetUntilDone(), HasSubstr("ur5: \"power on\" was answered with \"Failed"));
    EXPECT_THAT(fake_.commands(), testing::Not(testing::Contains("brake release")));
}

TEST_F(ArmTest, ResetTellsThatTheControllerDoesNotReleaseTheBrakes) {
    fake_.set([](auto& k) {
        k.robot_mode = 5;
        k.brake_reply = "Failed to execute: brake release";
    });
    open({{"power_on", true}});
    ASSERT_TRUE(becomes(SafetyState::fault));
    EXPECT_THAT(resetUntilDone(), HasSubstr("\"brake release\" was answered with \"Failed"));
}

TEST_F(ArmTest, ResetPowersNoArmOnThatSomeoneMovesByHand) {
    fake_.set([](auto& k) { k.robot_mode = 6; });
    open({{"power_on", true}});
    ASSERT_TRUE(becomes(SafetyState::fault));
    EXPECT_THAT(resetUntilDone(), HasSubstr("ur5: robot mode BACKDRIVE: someone moves the arm"));
    EXPECT_THAT(fake_.commands(), testing::IsEmpty());
}

TEST_F(ArmTest, ResetTellsThatAProtectiveStopWasNotReleased) {
    openReady();
    fake_.set([](auto& k) {
        k.safety_mode = 3;
        k.unlocks = false;
    });
    ASSERT_TRUE(becomes(SafetyState::protective_stop));
    std::string told;
    EXPECT_TRUE(fake_.await([&] {
        const auto reset = arm().resetFault();
        told = reset ? "" : reset.error().message;
        return told.find("was not released") != std::string::npos;
    })) << told;
    EXPECT_EQ(told, "ur5: the protective stop was not released within 3 s");
}

TEST_F(ArmTest, ResetTellsThatThePausedProgramIsNotStopped) {
    openReady();
    auto source = moving();
    fake_.set([](auto& k) {
        k.runtime = 4;
        k.stops = false;
        k.stop_reply = "Failed to execute: stop";
    });
    EXPECT_EQ(source->outcome(), EndCause::safety);
    EXPECT_THAT(resetUntilDone(), HasSubstr("ur5: \"stop\" was answered with \"Failed"));
    fake_.set([](auto& k) { k.stop_reply = "Stopped"; });
    std::string told;
    EXPECT_TRUE(fake_.await([&] {
        const auto reset = arm().resetFault();
        told = reset ? "" : reset.error().message;
        return told.find("within") != std::string::npos;
    })) << told;
    EXPECT_EQ(told, "ur5: the paused program was not stopped within 2 s");
}

TEST_F(ArmTest, AResetThatTakesLongTellsSoAndGoesOn) {
    fake_.set([](auto& k) {
        k.robot_mode = 3;
        k.powers_on = false;
    });
    open({{"power_on", true}});
    ASSERT_TRUE(becomes(SafetyState::fault));
    const auto first = arm().resetFault();
    ASSERT_FALSE(first);
    EXPECT_EQ(first.error().code, Errc::timeout);
    EXPECT_THAT(first.error().message, HasSubstr("the reset goes on"));
    fake_.set([](auto& k) { k.robot_mode = 5; });
    EXPECT_EQ(resetUntilDone(), "");
}

TEST_F(ArmTest, AResetHoldsUpNobodyWhoAsksForIt) {
    fake_.set([](auto& k) {
        k.robot_mode = 3;
        k.powers_on = false;
    });
    open({{"power_on", true}});
    ASSERT_TRUE(becomes(SafetyState::fault));
    auto shortest = std::chrono::nanoseconds::max();
    for (int i = 0; i < 5; ++i) {  // one of them is not held up by other work of the machine
        const auto before = std::chrono::steady_clock::now();
        EXPECT_EQ(arm().resetFault().error().code, Errc::timeout);
        shortest = std::min(shortest, std::chrono::steady_clock::now() - before);
    }
    EXPECT_LT(shortest, std::chrono::milliseconds(20)) << "a server's thread asks";
}

TEST_F(ArmTest, ASuccessThatNobodyHeardIsNotTheEndOfTheNextFault) {
    const auto breakDown = [this] {
        fake_.set([](auto& k) {
            k.robot_mode = 3;
            k.powers_on = false;
        });
    };
    breakDown();
    open({{"power_on", true}});
    ASSERT_TRUE(becomes(SafetyState::fault));
    EXPECT_EQ(arm().resetFault().error().code, Errc::timeout);
    fake_.set([](auto& k) { k.robot_mode = 5; });
    ASSERT_TRUE(becomes(SafetyState::normal));
    ASSERT_TRUE(fake_.await([&] { return arm().resetFault().has_value(); })) << "it has ended";
    breakDown();
    ASSERT_TRUE(becomes(SafetyState::fault));
    EXPECT_FALSE(arm().resetFault()) << "it is not powered on yet";
}

TEST_F(ArmTest, AProgramThatSomeoneStoppedEndsTheMotion) {
    openReady();
    auto source = moving();
    fake_.set([](auto& k) { k.runtime = 1; });
    EXPECT_EQ(source->outcome(), EndCause::safety);
    EXPECT_THAT(source->safety().text, HasSubstr("the controller's program is stopped: someone"));
    EXPECT_EQ(source->safety().state, SafetyState::protective_stop);
    EXPECT_NE(attachError(), "");
    EXPECT_EQ(resetUntilDone(), "");
    EXPECT_EQ(attach(0.1, 20)->outcome(), EndCause::done);
}

TEST_F(ArmTest, APausedProgramEndsTheMotionAndIsNotResumed) {
    openReady();
    auto source = moving();
    fake_.set([](auto& k) { k.runtime = 4; });
    EXPECT_EQ(source->outcome(), EndCause::safety);
    EXPECT_THAT(source->safety().text, HasSubstr("is paused"));
    const auto there = fake_.target();
    fake_.set([](auto& k) { k.runtime = 2; });  // someone presses play
    EXPECT_TRUE(fake_.await([&] { return !fake_.programRuns(); }));
    EXPECT_EQ(fake_.target(), there);
}

TEST_F(ArmTest, TheSpeedSliderStopsAMotion) {
    openReady();
    auto source = moving();
    fake_.set([](auto& k) { k.slider = 0.5; });
    EXPECT_EQ(source->outcome(), EndCause::safety);
    EXPECT_THAT(source->safety().text, HasSubstr("50 % of the speed: put its speed slider"));
    EXPECT_THAT(resetUntilDone(), HasSubstr("the speed slider is at 50 %"));
    fake_.set([](auto& k) { k.slider = 1.0; });
    EXPECT_TRUE(fake_.await([&] { return arm().resetFault().has_value(); }));
    EXPECT_EQ(attach(0.1, 20)->outcome(), EndCause::done);
}

TEST_F(ArmTest, TheSpeedSliderIsNamedBeforeAMotion) {
    fake_.set([](auto& k) { k.slider = 0.3; });
    openReady();
    EXPECT_THAT(attachError(), HasSubstr("ur5: the speed slider is at 30 %"));
}

TEST_F(ArmTest, ASlowedControllerIsNoticedWithoutTheSlider) {
    fake_.set([](auto& k) {
        k.unknown = {"target_speed_fraction"};
        k.scaling = 0.4;
    });
    openReady();
    auto source = attach(0.1, 20);
    EXPECT_EQ(source->outcome(), EndCause::safety);
    EXPECT_THAT(source->safety().text, HasSubstr("at 40 % of the speed"));
    EXPECT_EQ(source->asked(), 0);
}

TEST_F(ArmTest, AnotherProgramIsNotReplaced) {
    openReady();
    fake_.set([](auto& k) { k.runtime = 2; });
    const auto cycle = arm().state().cycle;
    ASSERT_TRUE(fake_.await([&] { return arm().state().cycle > cycle + 5; }));
    EXPECT_THAT(attachError(), HasSubstr("another program runs on the controller"));
}

TEST_F(ArmTest, AControllerThatDoesNotFollowIsStopped) {
    openReady();
    auto source = moving();
    fake_.set([](auto& k) { k.follows = false; });
    EXPECT_EQ(source->outcome(), EndCause::safety);
    EXPECT_THAT(source->safety().text, HasSubstr("axis 1: the controller goes to"));
}

TEST_F(ArmTest, AScriptThatTakesNothingIsStopped) {
    openReady();
    auto source = moving();
    fake_.set([](auto& k) { k.takes = false; });
    EXPECT_EQ(source->outcome(), EndCause::safety);
    EXPECT_THAT(source->safety().text, HasSubstr("took no set-point for 0.2"));
    EXPECT_TRUE(fake_.await([&] { return !fake_.programRuns(); }));
    EXPECT_THAT(fake_.commands(), testing::Contains("stop"));
}

TEST_F(ArmTest, AScriptThatDoesNotStartIsTold) {
    fake_.set([](auto& k) { k.starts = false; });
    openReady({{"start_timeout", 0.3}});
    auto source = attach(0.1, 20);
    fake_.sayError(210, 0, "The interface is read-only");
    EXPECT_EQ(source->outcome(), EndCause::safety);
    EXPECT_THAT(source->safety().text, HasSubstr("the script did not start within 0.3 s"));
    EXPECT_TRUE(fake_.await([&] {
        return arm().safety().text.find("C210A0") != std::string::npos;
    })) << arm().safety().text;
}

TEST_F(ArmTest, LocalControlIsTold) {
    fake_.set([](auto& k) { k.remote_control = "false"; });
    openReady();
    auto source = attach(0.1, 20);
    EXPECT_EQ(source->outcome(), EndCause::safety);
    EXPECT_THAT(source->safety().text, HasSubstr("local control: switch it to remote control"));
    EXPECT_EQ(fake_.uploads(), 0);
}

TEST_F(ArmTest, ADashboardThatDoesNotKnowRemoteControlIsNoObstacle) {
    fake_.set([](auto& k) { k.remote_control = "could not understand: is in remote control"; });
    openReady();
    EXPECT_EQ(attach(0.1, 20)->outcome(), EndCause::done);
}

TEST_F(ArmTest, ADashboardThatDoesNotAnswerIsNoObstacle) {
    fake_.set([](auto& k) { k.mute = true; });
    openReady();
    EXPECT_EQ(attach(0.1, 20)->outcome(), EndCause::done);
}

TEST_F(ArmTest, AScriptThatCannotBeUploadedIsTold) {
    const ReservedPort nobody;
    openReady({{"secondary_port", static_cast<double>(nobody.number())}});
    auto source = attach(0.1, 20);
    EXPECT_EQ(source->outcome(), EndCause::safety);
    EXPECT_THAT(source->safety().text,
                HasSubstr("ur5: the script could not be uploaded: 127.0.0.1:"));
}

TEST_F(ArmTest, ASetPointThatIsNoNumberIsNotSent) {
    openReady();
    auto source = attach(std::nan(""), 20);
    EXPECT_EQ(source->outcome(), EndCause::safety);
    EXPECT_THAT(source->safety().text, HasSubstr("axis 1: the set-point is not a number"));
}

}  // namespace
}  // namespace metier::ur_driver
