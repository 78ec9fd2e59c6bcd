// Settings, script, model and safety texts.

#include <gmock/gmock.h>

#include "described_model.hpp"
#include "safety_reporter.hpp"
#include "servoj_script.hpp"
#include "ur_settings.hpp"

namespace metier::ur_driver {
namespace {

using namespace std::chrono_literals;
using cell::Settings;
using device::SafetyState;
using testing::HasSubstr;

// ---- settings ----------------------------------------------------------------------------------

TEST(UrSettings, HaveDefaults) {
    const auto read = UrSettings::read(Settings("cell", {}));
    ASSERT_TRUE(read);
    EXPECT_EQ(read->rtde_port, 30004);
    EXPECT_EQ(read->primary_port, 30001);
    EXPECT_EQ(read->secondary_port, 30002);
    EXPECT_EQ(read->dashboard_port, 29999);
    EXPECT_EQ(read->register_base, 24);
    EXPECT_EQ(read->frequency, 0.0);
    EXPECT_EQ(read->link_timeout, 0ns);
    EXPECT_EQ(read->power_on, UrSettings::PowerOn::by_a_person);
}

TEST(UrSettings, AreRead) {
    const auto read = UrSettings::read(Settings("cell", {{"frequency", 250.0},
                                                         {"link_timeout", 0.05},
                                                         {"power_on", true},
                                                         {"register_base", 0.0}}));
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->frequency, 250.0);
    EXPECT_EQ(read->link_timeout, 50ms);
    EXPECT_EQ(read->power_on, UrSettings::PowerOn::by_reset);
    EXPECT_EQ(read->register_base, 0);
}

class BadUrSetting : public testing::TestWithParam<std::pair<const char*, Settings::Value>> {};

TEST_P(BadUrSetting, IsNamed) {
    const auto& [name, value] = GetParam();
    const auto read = UrSettings::read(Settings("cell", {{name, value}}));
    ASSERT_FALSE(read);
    EXPECT_EQ(read.error().code, Errc::invalid_argument);
    EXPECT_THAT(read.error().message, HasSubstr(name));
}

INSTANTIATE_TEST_SUITE_P(Values, BadUrSetting,
                         testing::Values(std::pair{"frequency", Settings::Value(501.0)},
                                         std::pair{"servoj_gain", Settings::Value(50.0)},
                                         std::pair{"servoj_lookahead", Settings::Value(0.5)},
                                         std::pair{"register_base", Settings::Value(43.0)},
                                         std::pair{"register_base", Settings::Value(1.5)},
                                         std::pair{"receive_timeout", Settings::Value(0.5)},
                                         std::pair{"rtde_port", Settings::Value(70000.0)},
                                         std::pair{"power_on", Settings::Value(std::string("yes"))},
                                         std::pair{"colour", Settings::Value(1.0)}));

// ---- script ------------------------------------------------------------------------------------

TEST(ServojScript, IsThisText) {
    UrSettings settings;
    settings.frequency = 125.0;
    EXPECT_EQ(servojScript(settings, 17), R"(def metier_follow():
  write_output_integer_register(24, 17)
  waited = 0
  while (read_input_integer_register(24) != 17) and (waited < 62):
    waited = waited + 1
    sync()
  end
  counter = read_input_integer_register(25)
  silent = 0
  while (read_input_integer_register(24) == 17) and (silent < 12):
    newest = read_input_integer_register(25)
    if newest == counter:
      silent = silent + 1
    else:
      silent = 0
      counter = newest
    end
    write_output_integer_register(25, counter)
    servoj([read_input_float_register(24), read_input_float_register(25), read_input_float_register(26), read_input_float_register(27), read_input_float_register(28), read_input_float_register(29)], 0, 0, 0.008, 0.1, 300)
  end
  stopj(4)
  write_output_integer_register(24, 0)
end
)");
}

TEST(ServojScript, FollowsTheOptions) {
    UrSettings settings;
    settings.register_base = 30;
    settings.frequency = 500.0;
    settings.servoj_gain = 500.0;
    settings.servoj_lookahead = 0.05;
    settings.stop_deceleration = 8.0;
    settings.receive_timeout = 200ms;
    const auto text = servojScript(settings, 5);
    EXPECT_THAT(text, HasSubstr("read_input_float_register(35)], 0, 0, 0.002, 0.05, 500)"));
    EXPECT_THAT(text, HasSubstr("silent < 100"));
    EXPECT_THAT(text, HasSubstr("stopj(8)"));
}

// ---- model -------------------------------------------------------------------------------------

motion::RobotModel ur5() {
    return motion::RobotModel::load(METIER_MODELS_DIR "/ur5.toml").value();
}

primary::Kinematics nominal() {
    constexpr double kHalfPi = 1.5707963267948966;
    primary::Kinematics dh;
    dh.a = {0, -0.425, -0.39225, 0, 0, 0};
    dh.d = {0.089159, 0, 0, 0.10915, 0.09465, 0.0823};
    dh.alpha = {kHalfPi, 0, 0, kHalfPi, -kHalfPi, 0};
    return dh;
}

primary::Configuration preset() {
    primary::Configuration configuration;
    configuration.lower.fill(-6.3355);
    configuration.upper.fill(6.3355);
    configuration.max_velocity.fill(3.3416);
    configuration.max_acceleration.fill(40.0);
    return configuration;
}

TEST(DescribedModel, OfANominalArmIsTheFile) {
    const auto file = ur5();
    const auto model = describedModel(file, {{}, nominal(), preset()});
    ASSERT_TRUE(model) << model.error().message;
    for (const double angle : {-1.0, 0.3, 1.2}) {
        const auto q = motion::JointVector::constant(6, angle);
        EXPECT_LT(
            motion::distanceBetween(model->kinematics().forward(q), file.kinematics().forward(q)),
            1e-9);
    }
    for (std::size_t axis = 0; axis < 6; ++axis) {
        EXPECT_DOUBLE_EQ(model->limits(axis).velocity, file.limits(axis).velocity);
        EXPECT_DOUBLE_EQ(model->limits(axis).acceleration, file.limits(axis).acceleration);
        EXPECT_NEAR(model->limits(axis).lower, file.limits(axis).lower, 1e-3);
    }
    EXPECT_EQ(differenceText(file, {{}, nominal(), preset()}), "");
}

TEST(DescribedModel, HasTheCalibrationOfTheArm) {
    auto dh = nominal();
    dh.theta[2] = 0.002;
    dh.d[1] = 0.4;  // nearly parallel axes share such lengths
    dh.d[2] = -0.4;
    const auto model = describedModel(ur5(), {{}, dh, {}});
    ASSERT_TRUE(model) << model.error().message;
    EXPECT_THAT(differenceText(ur5(), {{}, dh, {}}), HasSubstr("moves the flange by"));
    EXPECT_EQ(differenceText(*model, {{}, dh, {}}), "");
}

TEST(DescribedModel, TakesTheStricterLimit) {
    auto configuration = preset();
    configuration.max_velocity[1] = 1.91;
    configuration.lower[0] = -1.0;
    configuration.max_acceleration[2] = 2.0;
    const auto model = describedModel(ur5(), {{}, {}, configuration});
    ASSERT_TRUE(model) << model.error().message;
    EXPECT_NEAR(model->limits(1).velocity, 1.8, 1e-9);
    EXPECT_NEAR(model->limits(0).lower, -0.9477, 1e-9);
    EXPECT_NEAR(model->limits(2).acceleration, 2.0, 1e-9);
    EXPECT_THAT(differenceText(ur5(), {{}, {}, configuration}), HasSubstr("axis 1"));
}

TEST(DescribedModel, DiffersWhereALimitOfTheControllerIsStricter) {
    const auto file = ur5();
    const auto difference = [&](auto change) {
        auto configuration = preset();
        change(configuration);
        return differenceText(file, {{}, {}, configuration});
    };
    EXPECT_EQ(difference([](auto& c) { c.max_velocity[3] = 9.0; }), "") << "less strict";
    EXPECT_THAT(difference([](auto& c) { c.max_velocity[3] = 3.0; }), HasSubstr("axis 4: the"));
    EXPECT_THAT(difference([](auto& c) { c.max_acceleration[5] = 4.0; }), HasSubstr("axis 6: the"));
    EXPECT_THAT(difference([](auto& c) { c.lower[2] = -2.0; }), HasSubstr("axis 3: the"));
    EXPECT_THAT(difference([](auto& c) { c.upper[2] = 2.0; }), HasSubstr("axis 3: the"));
    EXPECT_THAT(difference([](auto& c) { c.max_velocity[0] = 0.0; }), HasSubstr("velocity"))
        << "no limits of an arm";
}

TEST(DescribedModel, RefusesAnotherArmAndNonsense) {
    auto dh = nominal();
    dh.a[1] = -0.612;
    EXPECT_THAT(describedModel(ur5(), {{}, dh, {}}).error().message, HasSubstr("another arm"));
    EXPECT_FALSE(describedModel(ur5(), {{}, primary::Kinematics{}, {}}));
    EXPECT_FALSE(describedModel(ur5(), {{}, {}, primary::Configuration{}}));
    const auto edo = motion::RobotModel::load(METIER_MODELS_DIR "/iiwa7.toml").value();
    EXPECT_THAT(describedModel(edo, {}).error().message, HasSubstr("7 axes"));
}

// ---- safety ------------------------------------------------------------------------------------

TEST(Judge, KnowsEveryMode) {
    for (int mode = -1; mode <= 8; ++mode) {
        const auto safety = judge(static_cast<RobotMode>(mode), SafetyMode::normal);
        EXPECT_EQ(safety.state, mode == 7 ? SafetyState::normal : SafetyState::fault);
        EXPECT_EQ(safety.text.empty(), mode == 7);
    }
    const std::map<int, SafetyState> expected{{1, SafetyState::normal},
                                              {2, SafetyState::normal},
                                              {3, SafetyState::protective_stop},
                                              {4, SafetyState::fault},
                                              {5, SafetyState::protective_stop},
                                              {6, SafetyState::emergency_stop},
                                              {7, SafetyState::emergency_stop},
                                              {8, SafetyState::fault},
                                              {9, SafetyState::fault},
                                              {10, SafetyState::fault},
                                              {11, SafetyState::fault},
                                              {12, SafetyState::protective_stop},
                                              {13, SafetyState::protective_stop},
                                              {14, SafetyState::protective_stop},
                                              {15, SafetyState::emergency_stop},
                                              {16, SafetyState::protective_stop},
                                              {17, SafetyState::fault},
                                              {18, SafetyState::protective_stop},
                                              {19, SafetyState::protective_stop},
                                              {20, SafetyState::emergency_stop},
                                              {21, SafetyState::fault},
                                              {22, SafetyState::protective_stop}};
    for (const auto& [mode, state] : expected) {
        EXPECT_EQ(judge(RobotMode::running, static_cast<SafetyMode>(mode)).state, state) << mode;
    }
    EXPECT_THAT(judge(RobotMode::running, static_cast<SafetyMode>(21)).text,
                HasSubstr("safety mode 21"));
    EXPECT_EQ(toText(static_cast<RobotMode>(42)), "mode 42");
    EXPECT_EQ(toText(static_cast<RuntimeState>(9)), "state 9");
}

class ReporterTest : public testing::Test {
protected:
    void observe(SafetyMode mode, bool limit_broken = false) {
        ControllerState state;
        state.robot_mode = RobotMode::running;
        state.safety_mode = mode;
        reporter_.observe(state, limit_broken, now_);
    }
    void error(std::int32_t code, primary::Report::Level level) {
        reporter_.report({primary::Report::Kind::error, level, code, 0, "said"}, now_);
    }

    SteadyTime now_{std::chrono::hours(1)};
    int reported_ = 0;
    device::ArmCore core_{{"arm", {"1", "2", "3", "4", "5", "6"}, 8ms}};
    SafetyReporter reporter_{core_, [this] { ++reported_; }};
};

TEST_F(ReporterTest, TellsOnlyChanges) {
    observe(SafetyMode::normal);
    observe(SafetyMode::normal);
    EXPECT_EQ(reported_, 1);
    EXPECT_EQ(core_.safety().state, SafetyState::normal);
    EXPECT_EQ(core_.safety().text, "");
}

TEST_F(ReporterTest, AddsWhatTheControllerSaysShortlyBeforeOrAfter) {
    observe(SafetyMode::normal);
    error(153, primary::Report::Level::fault);
    now_ += 500ms;
    observe(SafetyMode::protective_stop);
    EXPECT_THAT(core_.safety().text, HasSubstr("(the controller says: C153A0: said)"));
    now_ += 1s;
    error(154, primary::Report::Level::fault);
    EXPECT_THAT(core_.safety().text, HasSubstr("C154A0"));
    now_ += 10s;
    error(155, primary::Report::Level::fault);
    EXPECT_THAT(core_.safety().text, HasSubstr("C154A0"));
}

TEST_F(ReporterTest, AddsWhatIsSaidASecondBeforeToThreeSecondsAfterTheStop) {
    const auto stoppedAfter = [this](std::chrono::milliseconds time) {
        observe(SafetyMode::normal);
        error(153, primary::Report::Level::warning);
        now_ += time;
        observe(SafetyMode::protective_stop);
        const bool added = core_.safety().text.find("C153A0") != std::string::npos;
        now_ += 10s;
        return added;
    };
    EXPECT_TRUE(stoppedAfter(999ms));
    EXPECT_FALSE(stoppedAfter(1000ms));
    observe(SafetyMode::normal);
    observe(SafetyMode::protective_stop);
    now_ += 2999ms;
    error(1, primary::Report::Level::fault);
    EXPECT_THAT(core_.safety().text, HasSubstr("C1A0"));
    now_ += 1ms;
    error(2, primary::Report::Level::fault);
    EXPECT_THAT(core_.safety().text, HasSubstr("C1A0"));
}

TEST_F(ReporterTest, AddsASafetyMessageWithACodeButNoText) {
    using Kind = primary::Report::Kind;
    using Level = primary::Report::Level;
    observe(SafetyMode::normal);
    reporter_.report({Kind::safety, Level::violation, 4, 7, "protective stop"}, now_);
    reporter_.report({Kind::text, Level::fault, 0, 0, "hello"}, now_);
    EXPECT_EQ(reported_, 1) << "nothing changed";
    observe(SafetyMode::protective_stop);
    EXPECT_THAT(core_.safety().text, HasSubstr("(the controller says: C4A7: protective stop)"));
    reporter_.disconnected("gone", now_);
    EXPECT_EQ(core_.safety().text, "arm: gone") << "nobody says anything any more";
}

TEST_F(ReporterTest, RemembersWhenTheStateChanged) {
    observe(SafetyMode::normal);
    now_ += 1s;
    observe(SafetyMode::protective_stop);
    const auto stopped = now_;
    now_ += 1s;
    error(154, primary::Report::Level::fault);
    reporter_.note("a note");
    reporter_.latch("a latch", now_);
    EXPECT_EQ(reporter_.since(), stopped);
    observe(SafetyMode::robot_emergency_stop);
    EXPECT_EQ(reporter_.since(), now_);
}

TEST_F(ReporterTest, TellsALatchAndANoteOnce) {
    observe(SafetyMode::normal);
    reporter_.latch("first", now_);
    const int told = reported_;
    reporter_.latch("second", now_);
    reporter_.note("calibration");
    reporter_.note("calibration");
    EXPECT_EQ(reported_, told + 1);
}

TEST_F(ReporterTest, DoesNotAddWhatWasSaidLongBeforeOrDoesNotMatter) {
    observe(SafetyMode::normal);
    error(153, primary::Report::Level::fault);
    now_ += 5s;
    error(154, primary::Report::Level::info);
    reporter_.report(
        {primary::Report::Kind::safety, primary::Report::Level::violation, 0, 0, "protective stop"},
        now_);  // no more than the mode itself
    observe(SafetyMode::protective_stop);
    EXPECT_EQ(core_.safety().text, "arm: protective stop: clear its cause, then Reset");
}

TEST_F(ReporterTest, ALatchHoldsUntilItIsTakenBack) {
    observe(SafetyMode::normal);
    reporter_.latch("first", now_);
    reporter_.latch("second", now_);
    EXPECT_EQ(core_.safety().state, SafetyState::protective_stop);
    EXPECT_EQ(core_.safety().text, "arm: first; then Reset");
    observe(SafetyMode::robot_emergency_stop);
    EXPECT_EQ(core_.safety().state, SafetyState::emergency_stop);
    observe(SafetyMode::normal);
    EXPECT_TRUE(reporter_.latched());
    EXPECT_EQ(core_.safety().state, SafetyState::protective_stop);
    reporter_.unlatch();
    EXPECT_EQ(core_.safety().state, SafetyState::normal);
}

TEST_F(ReporterTest, AfterTheLinkIsBackTheControllerIsBelieved) {
    observe(SafetyMode::normal);
    reporter_.latch("something", now_);
    reporter_.disconnected("10.0.0.5:30004: gone", now_);
    EXPECT_EQ(core_.safety().state, SafetyState::disconnected);
    EXPECT_EQ(core_.safety().text, "arm: 10.0.0.5:30004: gone");
    observe(SafetyMode::normal);
    EXPECT_EQ(core_.safety().state, SafetyState::normal);
}

TEST_F(ReporterTest, ANoteIsToldWhileTheArmMayMove) {
    reporter_.note("another calibration");
    observe(SafetyMode::normal);
    EXPECT_EQ(core_.safety().state, SafetyState::normal);
    EXPECT_EQ(core_.safety().text, "arm: another calibration");
    observe(SafetyMode::safeguard_stop);
    EXPECT_THAT(core_.safety().text, HasSubstr("close the safeguard"));
}

TEST_F(ReporterTest, TellsThatALimitWasBroken) {
    observe(SafetyMode::normal);
    observe(SafetyMode::protective_stop, true);
    EXPECT_TRUE(core_.safety().limit_violated);
    observe(SafetyMode::normal, true);
    EXPECT_FALSE(core_.safety().limit_violated);
    observe(SafetyMode::robot_emergency_stop, true);
    EXPECT_FALSE(core_.safety().limit_violated) << "somebody pressed it";
}

}  // namespace
}  // namespace metier::ur_driver
