// Links that are not there, break, fall silent or carry garbage.

#include <atomic>
#include <memory>

#include "arm_fixture.hpp"

namespace metier::ur_driver {
namespace {

TEST_F(ArmTest, SilenceDuringAMotionDisconnectsAtOnce) {
    openReady({{"link_timeout", 0.5}});
    auto source = moving();
    fake_.set([](auto& k) { k.silent = true; });
    EXPECT_EQ(source->outcome(), EndCause::disconnected);
    EXPECT_EQ(source->safety().state, SafetyState::disconnected);
    EXPECT_THAT(source->safety().text,
                AllOf(HasSubstr("ur5: 127.0.0.1:"), HasSubstr("no RTDE data for 500 ms")));
    EXPECT_THAT(attachError(), HasSubstr("disconnected"));
    EXPECT_EQ(arm().resetFault().error().code, Errc::connection_lost);
}

TEST_F(ArmTest, SilenceIsNoticedWithinThreeCycles) {
    auto values = fake_.settings();
    values.erase("link_timeout");
    auto opened =
        device::urDriver().open({"ur5", "127.0.0.1", cell::Settings("test", values), &model_});
    ASSERT_TRUE(opened);
    // Shared with a callback that may still run. On a busy machine the link may be lost before,
    // too.
    const auto lost = std::make_shared<std::atomic<bool>>(false);
    const auto registration = opened->arm->onSafetyChange([lost](const device::Safety& safety) {
        if (safety.text.find("no RTDE data for 24 ms") != std::string::npos) {
            lost->store(true);
        }
    });
    ASSERT_TRUE(fake_.await([&] { return opened->arm->state().safety == SafetyState::normal; }));
    fake_.set([](auto& k) { k.silent = true; });
    EXPECT_TRUE(fake_.await([&] { return lost->load(); })) << opened->arm->safety().text;
    opened->owner.reset();
}

TEST_F(ArmTest, ConnectsAgainByItselfAndMovesOnlyWhenItIsAttached) {
    openReady();
    auto source = moving();
    fake_.breakRtde();
    EXPECT_EQ(source->outcome(), EndCause::disconnected);
    ASSERT_TRUE(becomes(SafetyState::normal));
    EXPECT_TRUE(fake_.await([&] { return !fake_.programRuns(); }));
    EXPECT_EQ(fake_.uploads(), 1);
    const auto there = fake_.target();
    const auto cycle = arm().state().cycle;
    EXPECT_TRUE(fake_.await([&] { return arm().state().cycle > cycle + 30; }));
    EXPECT_EQ(fake_.target(), there);
    EXPECT_EQ(attach(0.1, 20)->outcome(), EndCause::done);
    EXPECT_EQ(fake_.uploads(), 2);
}

TEST_F(ArmTest, FindsAControllerThatIsSwitchedOnLater) {
    fake_.switchOff();
    open({{"open_wait", 0.1}});
    EXPECT_EQ(arm().safety().state, SafetyState::disconnected);
    EXPECT_THAT(attachError(), HasSubstr("ur5"));
    EXPECT_EQ(arm().resetFault().error().code, Errc::connection_lost);
    fake_.listen();
    EXPECT_TRUE(becomes(SafetyState::normal));
    EXPECT_EQ(attach(0.1, 20)->outcome(), EndCause::done);
}

TEST_F(ArmTest, SurvivesARestartOfTheController) {
    openReady();
    auto source = moving();
    fake_.switchOff();
    EXPECT_EQ(source->outcome(), EndCause::disconnected);
    fake_.set([](auto& k) {
        k.robot_mode = 3;
        k.runtime = 1;
    });
    fake_.listen();
    ASSERT_TRUE(becomes(SafetyState::fault));
    EXPECT_THAT(arm().safety().text, HasSubstr("POWER_OFF"));
    fake_.set([](auto& k) { k.robot_mode = 7; });
    ASSERT_TRUE(becomes(SafetyState::normal));
    EXPECT_EQ(attach(0.1, 20)->outcome(), EndCause::done);
}

TEST_F(ArmTest, TellsALaterCalibrationThatItDoesNotUse) {
    fake_.set([](auto& k) { k.a[1] = -0.4262; });
    fake_.switchOff();
    open({{"open_wait", 0.1}});
    fake_.listen();
    ASSERT_TRUE(becomes(SafetyState::normal));
    EXPECT_TRUE(fake_.await([&] {
        return arm().safety().text.find("calibration moves the flange by") != std::string::npos;
    }));
    EXPECT_EQ(arm().safety().state, SafetyState::normal);
    EXPECT_EQ(attach(0.1, 20)->outcome(), EndCause::done);
}

TEST_F(ArmTest, ForgetsACalibrationOnceTheControllerTellsThatOfTheModel) {
    fake_.set([](auto& k) { k.max_velocity = 3.0; });
    fake_.switchOff();
    open({{"open_wait", 0.1}});
    fake_.listen();
    EXPECT_TRUE(fake_.await([&] {
        return arm().safety().text.find("limits are stricter") != std::string::npos;
    })) << arm().safety().text;
    fake_.set([](auto& k) { k.max_velocity = 3.3416; });
    EXPECT_TRUE(fake_.await([&] { return arm().safety().text.empty(); })) << arm().safety().text;
}

class RefusedSession : public ArmTest {
protected:
    /// Opens and waits until the text of the safety state has it.
    void expectText(const std::string& part, const Values& changed = {}) {
        open(changed);
        EXPECT_TRUE(fake_.await([&] {
            return arm().safety().text.find(part) != std::string::npos;
        })) << arm().safety().text;
        EXPECT_EQ(arm().safety().state, SafetyState::disconnected);
    }
};

TEST_F(RefusedSession, VersionTwo) {
    fake_.set([](auto& k) { k.accepts_version = false; });
    expectText("the controller does not speak version 2 of RTDE");
}

TEST_F(RefusedSession, AVariableThatIsNeeded) {
    fake_.set([](auto& k) { k.unknown = {"target_q"}; });
    expectText("does not offer target_q");
}

TEST_F(RefusedSession, BothNamesOfTheSafetyState) {
    fake_.set([](auto& k) { k.unknown = {"safety_status", "safety_mode"}; });
    expectText("does not offer safety_mode");
}

TEST_F(RefusedSession, RegistersThatDoNotExist) {
    fake_.set([](auto& k) { k.unknown = {"input_double_register_24"}; });
    expectText("input_double_register_24 is NOT_FOUND");
}

TEST_F(RefusedSession, RegistersOfAnotherClient) {
    fake_.set([](auto& k) { k.in_use = {"input_int_register_25"}; });
    expectText("input_int_register_25 is in use by another client");
}

TEST_F(RefusedSession, TheStart) {
    fake_.set([](auto& k) { k.accepts_start = false; });
    expectText("does not start RTDE");
}

TEST_F(RefusedSession, AFrequencyThatIsTooHigh) {
    expectText("gives at most 125 Hz, asked for are 500 Hz", {{"frequency", 500.0}});
}

TEST_F(RefusedSession, AnAnswerToSomethingElse) {
    fake_.set([](auto& k) { k.answers_start_as = 'P'; });
    expectText("RTDE answered 'S' with package 80");
}

TEST_F(RefusedSession, NobodyAtThePort) {
    const ReservedPort nobody;
    expectText("Connection refused", {{"rtde_port", static_cast<double>(nobody.number())}});
}

TEST_F(RefusedSession, SilenceInTheMiddle) {
    fake_.set([](auto& k) { k.answers_recipes = false; });
    expectText("no answer in time");
}

TEST_F(RefusedSession, SilenceFromTheBeginning) {
    fake_.set([](auto& k) { k.silent = true; });
    expectText("no answer in time");
}

class GarbageOn : public ArmTest, public testing::WithParamInterface<std::vector<std::byte>> {};

TEST_P(GarbageOn, RtdeBreaksTheLinkAndIsTold) {
    openReady();
    auto source = moving();
    fake_.set([](auto& k) { k.garbage = GetParam(); });
    EXPECT_EQ(source->outcome(), EndCause::disconnected);
    EXPECT_THAT(source->safety().text, HasSubstr("RTDE"));
    ASSERT_TRUE(becomes(SafetyState::normal));
    EXPECT_EQ(attach(0.1, 20)->outcome(), EndCause::done);
}

INSTANTIATE_TEST_SUITE_P(Kinds, GarbageOn,
                         testing::Values(fromHex("00 00 55 00"),       // a size that is none
                                         fromHex("00 05 55 01 00"),    // data that is too short
                                         fromHex("00 05 55 09 00")));  // data of another recipe

class ChatterOn : public ArmTest, public testing::WithParamInterface<std::vector<std::byte>> {};

TEST_P(ChatterOn, RtdeIsNoData) {
    openReady({{"link_timeout", 0.5}});
    auto source = moving();
    fake_.set([](auto& k) { k.instead_of_data = GetParam(); });
    EXPECT_EQ(source->outcome(), EndCause::disconnected);
    EXPECT_THAT(source->safety().text, HasSubstr("no RTDE data for 500 ms"));
}

INSTANTIATE_TEST_SUITE_P(Kinds, ChatterOn,
                         testing::Values(rtdePackage('M',
                                                     fromHex("02 48 69 02 4D 65 03")),  // a text
                                         rtdePackage('Z', fromHex("01 02"))));  // unknown package

TEST_F(ArmTest, UnknownPackagesAndTextsAreSkipped) {
    openReady();
    auto source = moving();
    fake_.set([](auto& k) {
        k.garbage = WireBytes()
                        .append(rtdePackage('Z', fromHex("01 02")))
                        .append(rtdePackage('M', fromHex("02 48 69 02 4D 65 03")))
                        .append(rtdePackage('M', fromHex("F0 48")))
                        .bytes();
    });
    const int asked = source->asked();
    EXPECT_TRUE(fake_.await([&] { return source->asked() > asked + 20; }));
    EXPECT_EQ(arm().safety().state, SafetyState::normal);
}

}  // namespace
}  // namespace metier::ur_driver
