// Two arms behind servers of their own, moved together by a third process.
#include <gmock/gmock.h>

#include <algorithm>
#include <optional>

#include "metier_program.hpp"
#include "watched_skill.hpp"

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;
using skill::Reason;
using skill::State;
using skill::ValueMap;
using ::testing::HasSubstr;
using ::testing::StartsWith;

// Largest time difference of the arms on a machine with other load [s]; without other load they are
// within a cycle of the slower one, 8 ms (docs/guide/synchronised.md).
constexpr double kApart = 0.5;

ServerProcess serve(const std::string& name, std::vector<std::string> more = {}) {
    more.insert(more.end(), {"--port", "0"});
    return ServerProcess(
        name, more,
        std::filesystem::path(METIER_SOURCE_DIR) / "tests" / "system" / "synchronized.toml");
}

class BothArms : public ::testing::Test {
protected:
    static ValueMap poses(double duration) {
        return {{"TargetPoses", std::vector<skill::Frame>{{0.5, 0, 0.4, 3.14159, 0, 3.14159},
                                                          {0.4, -0.3, 0.5, 3.14, 0, 1}}},
                {"Duration", duration}};
    }
    /// A move of half a minute; both arms move.
    void startSlowly() {
        const auto from = positions();
        const auto started = (*both_)->startWith({"slow", poses(30.0)});
        ASSERT_TRUE(started) << started.error().message;
        left_->awaitEvent(State::running);
        right_->awaitEvent(State::running);
        awaitMotion(left_->client(), **left_, from[0]);
        awaitMotion(right_->client(), **right_, from[1]);
    }
    std::vector<std::vector<double>> positions() {
        return {jointPosition(left_->client(), **left_), jointPosition(right_->client(), **right_)};
    }

    ServerProcess left_server_ = serve("left");
    ServerProcess right_server_ = serve("right");
    ServerProcess both_server_ = serve(
        "both", {"--use", "left=" + left_server_.url(), "--use", "right=" + right_server_.url()});
    std::optional<Watched> left_{std::in_place, left_server_.url(), "JointPtpMoveSkill"};
    std::optional<Watched> right_{std::in_place, right_server_.url(), "JointPtpMoveSkill"};
    std::optional<Watched> both_{std::in_place, both_server_.url(), "SynchronizedMoveSkill"};
};

double number(const ValueMap& result, const std::string& name) {
    return std::get<double>(result.at(name));
}

TEST_F(BothArms, StartAndArriveTogether) {
    const auto result = (*both_)->runWith({"together", poses(3.0)}, inAMinute());
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_LT(number(*result, "SkewAtStart"), kApart);
    EXPECT_LT(number(*result, "SkewAtEnd"), kApart);
    EXPECT_LT(number(*result, "LargestSkew"), 2 * kApart);
    EXPECT_GE(number(*result, "LargestSkew"), number(*result, "SkewAtEnd"));
    EXPECT_GT(number(*result, "ClockUncertainty"), 0.0);
    EXPECT_NEAR(number(*result, "Duration"), 3.0, 2 * kApart);
    const auto left = left_->awaitEvent(State::ready);
    const auto right = right_->awaitEvent(State::ready);
    EXPECT_EQ(left.reason, Reason::finished);
    EXPECT_EQ(right.reason, Reason::finished);
    EXPECT_THAT(left.execution_id, StartsWith("both.SynchronizedMoveSkill~"));
    const auto record = (*both_)->execution("together");
    ASSERT_TRUE(record) << record.error().message;
    EXPECT_EQ(record->result, *result) << "also for those who ask later";
}

TEST_F(BothArms, TakeTheTimeOfTheSlowestWithoutADuration) {
    const auto result = (*both_)->runWith({"quick", poses(0.0)}, inAMinute());
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_GT(number(*result, "Duration"), 0.3);
    EXPECT_LT(number(*result, "SkewAtEnd"), kApart);
    const auto again = (*both_)->runWith({"again", poses(0.0)}, inAMinute());
    ASSERT_TRUE(again) << "both are there already: " << again.error().message;
}

TEST_F(BothArms, AreHaltedIfSomebodyHaltsOne) {
    startSlowly();
    ASSERT_TRUE((*left_)->halt());
    const auto left = left_->awaitEvent(State::halted);
    const auto right = right_->awaitEvent(State::halted);
    const auto both = both_->awaitEvent(State::halted);
    EXPECT_EQ(right.reason, Reason::by_client);
    EXPECT_LT(right.time - left.time, 5s) << "expected: some 10 ms, and the time to brake";
    EXPECT_LE(right.time, both.time) << "Halted means that both stand still";
    EXPECT_EQ(both.reason, Reason::error);
    EXPECT_THAT(both.reason_text, StartsWith("left was Halted (ByClient)"));
    ASSERT_TRUE((*both_)->reset());
    const auto refused = (*both_)->runWith({"next", poses(3.0)}, inAMinute());
    ASSERT_FALSE(refused) << "a person has halted the arm, and nobody has reset it";
    EXPECT_THAT(refused.error().message, HasSubstr("left cannot get to its target: "));
    EXPECT_THAT(refused.error().message, HasSubstr("while Halted"));
    ASSERT_TRUE((*both_)->reset());
    ASSERT_TRUE((*left_)->reset());
    const auto again = (*both_)->runWith({"again", poses(0.0)}, inAMinute());
    EXPECT_TRUE(again) << "the other is reset by who halted it: " << again.error().message;
}

TEST_F(BothArms, AreHaltedIfTheServerOfOneDies) {
    startSlowly();
    right_server_.kill();
    const auto left = left_->awaitEvent(State::halted);
    const auto both = both_->awaitEvent(State::halted);
    EXPECT_EQ(left.reason, Reason::by_client);
    EXPECT_EQ(both.reason, Reason::device_lost);
    EXPECT_THAT(both.reason_text, StartsWith("right is lost"));
}

TEST_F(BothArms, AreHaltedIfTheComponentDies) {
    startSlowly();
    both_server_.kill();
    EXPECT_EQ(left_->awaitEvent(State::halted).reason, Reason::owner_lost);
    EXPECT_EQ(right_->awaitEvent(State::halted).reason, Reason::owner_lost);
}

TEST_F(BothArms, AreSuspendedAndResumedTogether) {
    const auto from = positions();
    const auto started = (*both_)->startWith({"paused", poses(4.0)});
    ASSERT_TRUE(started) << started.error().message;
    left_->awaitEvent(State::running);
    right_->awaitEvent(State::running);
    awaitMotion(right_->client(), **right_, from[1]);
    ASSERT_TRUE((*both_)->suspend());
    const auto left = left_->awaitEvent(State::suspended);
    const auto right = right_->awaitEvent(State::suspended);
    const auto both = both_->awaitEvent(State::suspended);
    EXPECT_LE(std::max(left.time, right.time), both.time) << "Suspended: both stand still";
    ASSERT_TRUE((*both_)->resume());
    const auto done = both_->awaitEvent(State::ready);
    EXPECT_EQ(done.reason, Reason::finished) << done.reason_text;
    const auto record = (*both_)->execution("paused");
    ASSERT_TRUE(record) << record.error().message;
    EXPECT_LT(number(record->result, "SkewAtStart"), kApart);
    EXPECT_LT(number(record->result, "SkewAtEnd"), kApart);
}

TEST_F(BothArms, AreSuspendedIfSomebodySuspendsOne) {
    startSlowly();
    ASSERT_TRUE((*right_)->suspend());
    right_->awaitEvent(State::suspended);
    left_->awaitEvent(State::suspended);
    EXPECT_THAT(both_->awaitEvent(State::suspended).reason_text,
                StartsWith("right was suspended by "));
    ASSERT_TRUE((*right_)->resume());
    const auto both = both_->awaitEvent(State::halted);
    EXPECT_EQ(both.reason_text, "right was resumed alone");
    EXPECT_EQ(left_->awaitEvent(State::halted).reason, Reason::by_client);
}

TEST_F(BothArms, StayWhereTheyAreIfOneCannotGetToItsTarget) {
    const auto before = positions();
    auto parameters = poses(0.0);
    std::get<std::vector<skill::Frame>>(parameters["TargetPoses"])[1].z = 3.0;
    const auto result = (*both_)->runWith({"too-far", parameters}, inAMinute());
    ASSERT_FALSE(result);
    EXPECT_THAT(result.error().message, HasSubstr("right cannot get to its target: target: "));
    EXPECT_THAT(result.error().message, HasSubstr("reach"));
    EXPECT_EQ(positions(), before);
    EXPECT_EQ((*left_)->state(), State::ready);
}

TEST(PathMove, RunsFromTheCommandLineOverAnArmOfItsOwn) {
    const auto arm = serve("right");
    const std::vector<std::string> along{"run",
                                         arm.url(),
                                         "CartesianPathMoveSkill",
                                         "--set",
                                         "Poses=0,0.1,0,0,0,0;0,0,0.1,0,0,0.1;0,-0.1,0,0,0,0",
                                         "--set",
                                         "Relative=1"};
    auto rounded = along;
    rounded.insert(rounded.end(), {"--set", "BlendRadii=0.03,0.03,0", "--set", "Speeds=0,0.05,0"});
    const auto run = runMetier(rounded);
    EXPECT_EQ(run.status, 0) << run.output;
    EXPECT_THAT(run.output, HasSubstr("LargestPathDeviation"));
    auto too_round = along;
    too_round.insert(too_round.end(), {"--set", "BlendRadii=0.03,0.08,0"});
    const auto refused = runMetier(too_round);
    EXPECT_NE(refused.status, 0);
    EXPECT_THAT(refused.output, HasSubstr("waypoint 2: blend radius 0.08 m over 0.0500 m"));
    auto timed = rounded;
    timed.insert(timed.end(), {"--set", "Duration=0.1"});
    const auto hurried = runMetier(timed);
    EXPECT_NE(hurried.status, 0);
    EXPECT_THAT(hurried.output, HasSubstr("Duration 0.1 s is shorter than possible: "));
}

TEST(PathMove, RunsOverThePositionStreamOfAnotherServer) {
    const ServerProcess arm("ur5");
    const ServerProcess move("ur5-move", {"--port", "0", "--robot", arm.url()});
    const auto run = runMetier({"run", move.url(), "CartesianPathMoveSkill", "--set",
                                "Poses=0,0.1,0,0,0,0;0,0,0.1,0,0,0", "--set", "BlendRadii=0.04,0",
                                "--set", "Relative=1"});
    EXPECT_EQ(run.status, 0) << run.output;
    EXPECT_THAT(run.output, HasSubstr("LargestPathDeviation"));
}

TEST(GuideToSynchronisedArms, ShowsTheCellThatRunsHere) {
    const auto guide = sourceText("docs/guide/synchronised.md");
    EXPECT_THAT(guide, HasSubstr("```toml\n" + sourceText("cells/synchronized.toml") + "```"));
    const auto cell = std::filesystem::path(METIER_SOURCE_DIR) / "cells" / "synchronized.toml";
    const std::string poses = "TargetPoses=0.5,0,0.4,3.14159,0,3.14159;0.4,-0.3,0.5,3.14,0,1";
    EXPECT_THAT(guide, HasSubstr("SynchronizedMoveSkill --set \"" + poses + "\""));
    // The file has the limits of a machine that does little else: one run of some keeps them.
    Finished run;
    for (int attempt = 0; attempt < 3 && run.status != 0; ++attempt) {
        const ServerProcess left("left", {"--port", "0"}, cell);
        const ServerProcess right("right", {"--port", "0"}, cell);
        const ServerProcess both(
            "both", {"--port", "0", "--use", "left=" + left.url(), "--use", "right=" + right.url()},
            cell);
        run = runMetier({"run", both.url(), "SynchronizedMoveSkill", "--set", poses});
    }
    EXPECT_EQ(run.status, 0) << run.output;
    EXPECT_THAT(run.output, HasSubstr("SkewAtEnd"));
}

}  // namespace
}  // namespace metier::system_tests
