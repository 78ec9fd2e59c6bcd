// The stream of set-points cycle by cycle, with the controller's state moved by hand.

#include "streamer.hpp"

#include <gmock/gmock.h>

#include <optional>

#include "moving_source.hpp"

namespace metier::ur_driver {
namespace {

using namespace std::chrono_literals;
using device::EndCause;
using device::SafetyState;
using testing::HasSubstr;
using Kind = StreamFault::Kind;

UrSettings settings() {
    UrSettings settings;
    settings.frequency = 125.0;
    settings.receive_timeout = 80ms;
    settings.start_timeout = 400ms;
    return settings;
}

/// A streamer and a controller of three lines: runs the script two cycles after its upload.
class StreamerTest : public testing::Test {
protected:
    explicit StreamerTest(const UrSettings& with = settings(), std::int32_t first_token = 41)
        : streamer_(core_, with, {1.0, 1.0, 1.0, 1.0, 1.0, 1.0}, first_token) {
        now_.robot_mode = RobotMode::running;
        now_.safety_mode = SafetyMode::normal;
        now_.target_q = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6};
        now_.actual_q = now_.target_q;
        core_.setSafety({SafetyState::normal, ""});
        core_.dispatch();
    }

    Streamer::Output cycle(std::chrono::nanoseconds since_the_last = 8ms) {
        now_.timestamp += 0.008;
        stamp_ += since_the_last;
        out_ = streamer_.cycle(now_, stamp_);
        if (out_.fault.kind != Kind::none) {
            core_.setSafety({SafetyState::protective_stop, toText(out_.fault)});
        }
        if (core_.toTell()) {
            core_.dispatch();
        }
        uploads_ += out_.upload != 0 ? 1 : 0;
        obey();
        return out_;
    }
    void obey() {
        if (out_.upload != 0 && starts_) {
            now_.runtime_state = RuntimeState::playing;
            now_.script_token = out_.upload;
        }
        const bool running = now_.runtime_state == RuntimeState::playing && takes_;
        if (running && out_.write && out_.setpoint.token == now_.script_token) {
            now_.script_counter = out_.setpoint.counter;
            now_.target_q = follows_ ? out_.setpoint.position : now_.target_q;
        } else if (running && out_.write && out_.setpoint.token == 0 && obeys_) {
            now_.runtime_state = RuntimeState::stopped;
            now_.script_token = 0;
        }
        now_.actual_q = now_.target_q;
    }
    void cycles(int count) {
        for (int i = 0; i < count; ++i) {
            cycle();
        }
    }
    std::shared_ptr<MovingSource> attach(double distance, int count) {
        auto source = std::make_shared<MovingSource>(distance, count);
        EXPECT_TRUE(core_.attach(source));
        return source;
    }
    std::shared_ptr<MovingSource> moving() {
        auto source = attach(0.5, 1000);
        cycles(20);
        EXPECT_GT(source->asked(), 5);
        return source;
    }

    device::ArmCore core_{{"arm", {"1", "2", "3", "4", "5", "6"}, 8ms}};
    Streamer streamer_;
    ControllerState now_;
    SteadyTime stamp_{1s};
    Streamer::Output out_;
    bool starts_ = true;
    bool takes_ = true;
    bool follows_ = true;
    bool obeys_ = true;
    int uploads_ = 0;
};

TEST_F(StreamerTest, WritesNothingWhileNobodyMovesTheArm) {
    for (int i = 0; i < 10; ++i) {
        EXPECT_FALSE(cycle().write);
    }
    EXPECT_EQ(core_.state().commanded_position[5], 0.6);
    EXPECT_EQ(core_.state().cycle, 10U);
}

TEST_F(StreamerTest, AsksForAFewSetPointsOnlyWhenLatePackagesComeTogether) {
    auto source = moving();
    const auto before = source->asked();
    cycle(100ms);
    for (int i = 0; i < 11; ++i) {
        cycle(100us);
    }
    EXPECT_LE(source->asked(), before + 5) << "the arm would jump";
    EXPECT_GE(source->asked(), before + 3) << "a link may be three cycles late";
    const auto after = source->asked();
    cycles(100);
    EXPECT_EQ(source->asked(), after + 100) << "and one in each cycle from then on";
}

TEST(SetPointPace, LetsAControllerWithAQuickClockNeverWait) {
    SetPointPace pace(8ms);
    SteadyTime now{1s};
    for (int i = 0; i < 100'000; ++i) {
        now += 7999us;
        ASSERT_TRUE(pace.due(now)) << "cycle " << i;
    }
}

TEST_F(StreamerTest, WritesWhereTheArmIsBeforeTheScriptStarts) {
    auto source = attach(0.1, 10);
    starts_ = false;
    std::int32_t counter = cycle().setpoint.counter;
    for (int i = 0; i < 10; ++i) {
        const auto out = cycle();
        EXPECT_TRUE(out.write);
        EXPECT_EQ(out.setpoint.token, 42);
        EXPECT_EQ(out.setpoint.position, now_.target_q);
        EXPECT_EQ(out.setpoint.counter, ++counter);
    }
    EXPECT_EQ(uploads_, 1);
    EXPECT_EQ(source->asked(), 0);
}

TEST_F(StreamerTest, AsksTheSourceOncePerCycleUntilItIsDone) {
    auto source = attach(0.02, 50);
    cycles(70);
    EXPECT_EQ(source->asked(), 51);
    EXPECT_EQ(source->outcome(), EndCause::done);
    EXPECT_NEAR(out_.setpoint.position[0], 0.12, 1e-12);
    EXPECT_TRUE(out_.write) << "the script is kept alive";
}

TEST_F(StreamerTest, NeitherAllocatesWhenItFollowsNorWhenItStops) {
    auto source = attach(0.02, 500);
    cycles(10);
    auto before = allocationCount();
    for (int i = 0; i < 100; ++i) {
        now_.timestamp += 0.008;
        out_ = streamer_.cycle(now_, SteadyTime{});
        obey();
    }
    EXPECT_EQ(allocationCount() - before, 0U);
    before = allocationCount();
    core_.stop();
    for (int i = 0; i < 20; ++i) {
        now_.timestamp += 0.008;
        out_ = streamer_.cycle(now_, SteadyTime{});
        obey();
    }
    EXPECT_EQ(allocationCount() - before, 0U);
    core_.dispatch();
    EXPECT_EQ(source->outcome(), EndCause::stopped);
}

TEST_F(StreamerTest, AStopTakesTheTokenAwayAndEndsAtStandstill) {
    auto source = moving();
    core_.stop();
    now_.actual_qd[3] = 0.3;
    cycles(20);
    EXPECT_EQ(out_.setpoint.token, 0);
    EXPECT_EQ(source->ends(), 0);
    now_.actual_qd[3] = 0.0;
    cycles(5);
    EXPECT_EQ(source->outcome(), EndCause::stopped);
    EXPECT_FALSE(cycle().write);
}

TEST_F(StreamerTest, AScriptThatDoesNotObeyIsStoppedAtTheDashboardOnce) {
    auto source = moving();
    obeys_ = false;
    core_.stop();
    now_.actual_qd[0] = 0.3;
    int stops = 0;
    for (int i = 0; i < 300; ++i) {
        stops += cycle().stop_program ? 1 : 0;
    }
    EXPECT_EQ(stops, 1);
    EXPECT_EQ(source->ends(), 0) << "the arm still moves";
    now_.actual_qd[0] = 0.0;
    cycles(5);
    EXPECT_EQ(source->outcome(), EndCause::stopped);
}

TEST_F(StreamerTest, ASafetyStopEndsAtStandstill) {
    auto source = moving();
    core_.setSafety({SafetyState::emergency_stop, "pressed"});
    now_.actual_qd[0] = 0.5;
    now_.runtime_state = RuntimeState::paused;
    cycles(10);
    EXPECT_EQ(source->ends(), 0);
    now_.actual_qd[0] = 0.0;
    cycles(5);
    EXPECT_EQ(source->outcome(), EndCause::safety);
    EXPECT_EQ(source->safety().text, "pressed");
    EXPECT_EQ(core_.state().safety, SafetyState::emergency_stop);
}

TEST_F(StreamerTest, TheEndOfTheLinkEndsAtOnce) {
    auto source = moving();
    core_.setSafety({SafetyState::disconnected, "gone"});
    streamer_.disconnected();
    core_.dispatch();
    EXPECT_EQ(source->outcome(), EndCause::disconnected);
    EXPECT_FALSE(streamer_.busy());
    core_.setSafety({SafetyState::normal, ""});
    cycles(10);
    EXPECT_FALSE(out_.write);
    EXPECT_EQ(uploads_, 1);
}

TEST_F(StreamerTest, EveryScriptHasAnotherToken) {
    for (const int token : {42, 43, 44}) {
        auto source = moving();
        EXPECT_EQ(out_.setpoint.token, token);
        core_.stop();
        cycles(10);
        EXPECT_EQ(source->outcome(), EndCause::stopped);
    }
    EXPECT_EQ(uploads_, 3);
}

TEST_F(StreamerTest, TakesNoScriptOfAnotherUploadForItsOwn) {
    now_.runtime_state = RuntimeState::playing;
    now_.script_token = 17;
    starts_ = false;
    auto source = attach(0.1, 10);
    cycles(60);
    EXPECT_EQ(source->asked(), 0);
    EXPECT_EQ(source->outcome(), EndCause::safety);
    EXPECT_THAT(source->safety().text, HasSubstr("did not start within 0.4 s"));
}

TEST_F(StreamerTest, TakesNoOlderOrNewerScriptForItsOwn) {
    starts_ = false;
    auto source = attach(0.1, 10);
    const auto first = cycle().setpoint.counter;
    cycles(3);
    now_.script_token = out_.setpoint.token;
    now_.runtime_state = RuntimeState::playing;
    takes_ = false;
    for (const auto counter : {first - 2, out_.setpoint.counter + 100}) {
        now_.script_counter = counter;
        cycles(2);
        EXPECT_EQ(source->asked(), 0) << counter;
    }
    now_.script_counter = first;
    now_.runtime_state = RuntimeState::paused;
    cycles(2);
    EXPECT_EQ(source->asked(), 0) << "it does not run";
    now_.runtime_state = RuntimeState::playing;
    cycle();
    EXPECT_EQ(source->asked(), 1);
}

TEST_F(StreamerTest, ARefusedUploadTakesItsTokenAway) {
    starts_ = false;
    auto source = attach(0.1, 10);
    cycles(5);
    streamer_.refuseStart(streamer_.token() - 1);
    cycles(2);
    EXPECT_NE(out_.setpoint.token, 0) << "it was another one";
    streamer_.refuseStart(streamer_.token());
    cycles(2);
    EXPECT_EQ(out_.setpoint.token, 0);
    EXPECT_EQ(source->asked(), 0);
}

TEST_F(StreamerTest, ARefusedUploadEnds) {
    starts_ = false;
    auto source = attach(0.1, 10);
    cycles(5);
    core_.setSafety({SafetyState::protective_stop, "refused"});
    streamer_.refuseStart(streamer_.token());
    cycles(10);
    EXPECT_EQ(source->outcome(), EndCause::safety);
}

TEST_F(StreamerTest, NoticesASpeedThatIsReducedForLongerThanADip) {
    auto source = moving();
    now_.speed_scaling = 0.7;
    cycles(4);
    now_.speed_scaling = 1.0;
    cycles(10);
    EXPECT_EQ(source->ends(), 0);
    now_.target_speed_fraction = 0.5;
    cycles(10);
    EXPECT_EQ(source->outcome(), EndCause::safety);
    EXPECT_THAT(source->safety().text, HasSubstr("at 50 % of the speed"));
}

TEST_F(StreamerTest, MayBeSlowedWhileItOnlyHolds) {
    auto source = attach(0.01, 10);
    cycles(30);
    EXPECT_EQ(source->outcome(), EndCause::done);
    now_.speed_scaling = 0.5;
    cycles(20);
    EXPECT_EQ(core_.safetyState(), SafetyState::normal);
    EXPECT_TRUE(out_.write) << "the script is kept alive";
    auto next = attach(0.01, 10);
    cycles(10);
    EXPECT_EQ(next->outcome(), EndCause::safety);
}

TEST_F(StreamerTest, NoticesACounterThatItNeverWrote) {
    auto source = moving();
    takes_ = false;
    now_.script_counter = out_.setpoint.counter + 10;
    cycle();
    EXPECT_THAT(core_.safety().text, HasSubstr("took no set-point for 0.000 s"));
}

TEST_F(StreamerTest, NoticesASetPointOfTooFewAxes) {
    class FiveAxes final : public device::SetPointSource {
    public:
        Next next(const device::ArmState&, device::JointArray& set_point) noexcept override {
            set_point = device::JointArray(5);
            return Next::set_point;
        }
        void ended(EndCause, const device::Safety&) override {}
    };
    ASSERT_TRUE(core_.attach(std::make_shared<FiveAxes>()));
    cycles(10);
    EXPECT_THAT(core_.safety().text, HasSubstr("axis 1: the set-point is not a number"));
}

TEST_F(StreamerTest, StopsNoProgramThatIsNotItsOwn) {
    auto source = moving();
    obeys_ = false;
    core_.stop();
    cycle();
    now_.script_token = 17;
    int stops = 0;
    for (int i = 0; i < 120; ++i) {
        EXPECT_EQ(source->ends(), 0) << "cycle " << i;
        stops += cycle().stop_program ? 1 : 0;
    }
    cycles(10);
    EXPECT_EQ(stops, 0);
    EXPECT_EQ(source->outcome(), EndCause::stopped) << "1 s after the stop";
}

TEST_F(StreamerTest, WaitsForAProgramThatIsStopping) {
    auto source = moving();
    obeys_ = false;
    core_.stop();
    cycle();
    now_.runtime_state = RuntimeState::stopping;
    cycles(50);
    EXPECT_EQ(source->ends(), 0);
    now_.runtime_state = RuntimeState::stopped;
    cycles(2);
    EXPECT_EQ(source->outcome(), EndCause::stopped);
}

class PatientStreamer : public StreamerTest {
protected:
    PatientStreamer()
        : StreamerTest([] {
              auto patient = settings();
              patient.start_timeout = 2s;
              return patient;
          }()) {}
};

TEST_F(PatientStreamer, MayBeSlowedForHalfASecondAtTheStart) {
    now_.speed_scaling = 0.7;
    auto source = attach(0.5, 1000);
    cycles(55);
    now_.speed_scaling = 1.0;
    cycles(5);
    EXPECT_GT(source->asked(), 0);
}

TEST_F(PatientStreamer, NoticesASpeedThatStaysReducedAtTheStart) {
    now_.speed_scaling = 0.7;
    auto source = attach(0.5, 1000);
    cycles(80);
    EXPECT_EQ(source->asked(), 0);
    EXPECT_EQ(source->outcome(), EndCause::safety);
    EXPECT_THAT(source->safety().text, HasSubstr("at 70 % of the speed"));
}

class OverflowingStreamer : public StreamerTest {
protected:
    OverflowingStreamer() : StreamerTest(settings(), -1) {}
};

TEST_F(OverflowingStreamer, HasNoTokenZero) {
    auto source = moving();
    EXPECT_EQ(out_.setpoint.token, 1) << "0 ends a script";
}

TEST_F(StreamerTest, NoticesASilentScriptAfterItsPatience) {
    auto source = moving();
    takes_ = false;
    cycles(11);
    EXPECT_EQ(core_.safetyState(), SafetyState::normal);
    cycles(10);
    EXPECT_EQ(core_.safetyState(), SafetyState::protective_stop);
    EXPECT_EQ(source->ends(), 0) << "the program still runs";
    cycles(130);
    EXPECT_EQ(source->outcome(), EndCause::safety);
    EXPECT_THAT(source->safety().text, HasSubstr("took no set-point for 0.1"));
}

TEST_F(StreamerTest, NoticesThatTheArmGoesElsewhere) {
    auto source = moving();
    follows_ = false;
    now_.target_q[4] += 0.06;
    cycles(4);
    EXPECT_EQ(source->ends(), 0);
    cycles(5);
    EXPECT_EQ(source->outcome(), EndCause::safety);
    EXPECT_THAT(source->safety().text, HasSubstr("axis 5: the controller goes to 0.56"));
}

TEST_F(StreamerTest, ALagOfTheServoIsNoDeviation) {
    auto source = attach(0.5, 100);
    follows_ = false;
    for (int i = 0; i < 130; ++i) {
        cycle();
        const double wanted = out_.write ? out_.setpoint.position[0] : now_.target_q[0];
        now_.target_q[0] += 0.1 * (wanted - now_.target_q[0]);
    }
    EXPECT_EQ(source->outcome(), EndCause::done);
}

TEST_F(StreamerTest, NoticesAProgramThatEndsOrAnotherThatRuns) {
    auto source = moving();
    now_.script_token = 17;
    cycles(5);
    EXPECT_EQ(source->outcome(), EndCause::safety);
    EXPECT_THAT(source->safety().text, HasSubstr("program is playing: someone stopped it"));
}

TEST_F(StreamerTest, AProgramThatIsStoppedWhileTheArmOnlyHoldsIsNoFault) {
    EXPECT_EQ(
        [&] {
            auto source = attach(0.01, 10);
            cycles(30);
            return source->outcome();
        }(),
        EndCause::done);
    now_.runtime_state = RuntimeState::stopped;
    cycles(10);
    EXPECT_EQ(core_.safetyState(), SafetyState::normal);
    EXPECT_FALSE(out_.write);
    auto source = attach(0.01, 10);
    cycles(30);
    EXPECT_EQ(source->outcome(), EndCause::done);
    EXPECT_EQ(uploads_, 2);
}

TEST_F(StreamerTest, RemembersASetPointThatWasTooFast) {
    auto source = attach(0.5, 10);  // at most 9.8 rad/s, the limit is 1
    cycles(10);
    EXPECT_TRUE(streamer_.limitBroken());
    cycles(300);
    EXPECT_FALSE(streamer_.limitBroken());
    EXPECT_EQ(source->outcome(), EndCause::done);
}

TEST_F(StreamerTest, CountsMissedCyclesByTheControllersTime) {
    cycles(5);
    now_.timestamp += 0.016;
    cycle();
    EXPECT_EQ(core_.state().missed_cycles, 2U);
    EXPECT_EQ(core_.state().cycle, 8U);
    now_.timestamp += 0.0035;
    cycle();
    EXPECT_EQ(core_.state().missed_cycles, 2U) << "late, but none is missing";
    now_.timestamp += 0.0045;
    cycle();
    EXPECT_EQ(core_.state().missed_cycles, 3U);
    now_.timestamp += 8100.0;
    cycle();
    EXPECT_EQ(core_.state().missed_cycles, 3U) << "another clock";
    now_.timestamp = 0.0;  // the controller was started again
    cycle();
    EXPECT_EQ(core_.state().missed_cycles, 3U);
}

TEST(StreamFaultText, IsEmptyWithoutAFault) {
    EXPECT_EQ(toText(StreamFault{}), "");
}

}  // namespace
}  // namespace metier::ur_driver
