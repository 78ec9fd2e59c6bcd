#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <utility>

#include "rig.hpp"

namespace metier::virtual_edo {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;

using Said = std::pair<int, int>;  // type and data

const Said kReceived{0, 0};
const Said kEnded{2, 1};

/// \param values x, y, z [mm], a, e, r [deg]
Json pose(const std::array<double, 6>& values) {
    Json pose = Json::object({{"config_flags", ""}});
    constexpr std::array kNames{"x", "y", "z", "a", "e", "r"};
    for (std::size_t i = 0; i < values.size(); ++i) {
        pose[kNames.at(i)] = values.at(i);
    }
    return pose;
}

void moveCartesian(Rig& rig, const Json& target, const char* type = "L") {
    rig.client.publish("/bridge_move",
                       {{"move_command", 77},
                        {"move_type", static_cast<int>(*type)},
                        {"ovr", 100},
                        {"delay", 0},
                        {"target", {{"data_type", 80}, {"cartesian_data", target}}}});
}

/// Largest speed of an axis over what was measured [deg/s].
double largestSpeed(const Rig& rig, std::size_t axis) {
    double largest = 0.0;
    for (const auto& state : rig.client.messages("/usb_jnt_state")) {
        largest = std::max(largest, std::abs(state["joints"][axis]["velocity"].get<double>()));
    }
    return largest;
}

TEST(Move, IsReceivedMovesAndIsExecuted) {
    Rig rig;
    rig.run(2);
    rig.moveJoints({10, 0, 80, 0, 90, 5});
    rig.run(1);
    EXPECT_EQ(rig.state(), 3);
    EXPECT_TRUE(rig.runUntilState(2));
    EXPECT_LE(largestSpeed(rig, 1), 22.79 * 1.001);
    EXPECT_THAT(rig.feedback(), ElementsAre(kReceived, kEnded));
    rig.run(3);
    EXPECT_NEAR(rig.joint(0), 10.0, 1e-9);
    EXPECT_NEAR(rig.joint(2), 80.0, 1e-9);
    EXPECT_NEAR(rig.joint(5), 5.0, 1e-9);
}

TEST(Move, TakesAsLongAsTheSlowestAxisNeeds) {
    Rig rig;
    rig.moveJoints({60});
    const double ramp = 22.79 / 45.6;
    EXPECT_NEAR(rig.runUntilState(2).value(), 60 / 22.79 + ramp, 0.05);
    rig.moveJoints({0}, 0, 50);
    EXPECT_NEAR(rig.runUntilState(2).value(), 2 * 60 / 22.79 + ramp, 0.05);
}

TEST(Move, LeavesAxesOutsideTheMaskAlone) {
    Rig rig;
    rig.run(1);
    rig.client.publish(
        "/bridge_move",
        {{"move_command", 77},
         {"move_type", 74},
         {"target",
          {{"data_type", 74}, {"joints_mask", 64}, {"joints_data", {0, 0, 0, 0, 0, 0, 55}}}}});
    EXPECT_TRUE(rig.runUntilState(2));
    rig.run(2);
    EXPECT_NEAR(rig.joint(2), 90.0, 1e-9);
    EXPECT_NEAR(rig.joint(6), 55.0, 1e-9);
    EXPECT_NEAR(rig.report.jaw_width.value(), 0.055, 1e-9);
}

TEST(Move, ClampsWithinTwoTenthsOfTheStrokeAndFailsBeyond) {
    Rig rig;
    rig.moveJoints({-10, 99.15});
    EXPECT_TRUE(rig.runUntilState(2));
    rig.run(2);
    EXPECT_NEAR(rig.joint(1), 99.0, 1e-6);
    rig.feedback();
    rig.moveJoints({-10, 99.25});
    rig.run(3);
    EXPECT_EQ(rig.state(), 2);
    EXPECT_THAT(rig.feedback(), ElementsAre(kReceived, Said(-1, -76), Said(-1, -103)));
}

TEST(Move, RunsALineOfTheFlange) {
    Rig rig;
    rig.runSeconds(0.2);
    auto start = rig.client.last("/cartesian_pose");
    auto target = start;
    target["z"] = start["z"].get<double>() - 60.0;
    target["y"] = start["y"].get<double>() + 80.0;
    moveCartesian(rig, target);
    double off = 0.0;
    while (rig.state() == 3) {
        rig.run(1);
        const Eigen::Vector3d now = rig.report.base_from_flange->translation * 1000.0;
        const Eigen::Vector3d from(start["x"], start["y"], start["z"]);
        const Eigen::Vector3d way = Eigen::Vector3d(0, 80, -60).normalized();
        off = std::max(off, (now - from).cross(way).norm());
    }
    EXPECT_LT(off, 0.01);  // [mm]
    rig.runSeconds(0.2);
    const auto end = rig.client.last("/cartesian_pose");
    for (const char* name : {"x", "y", "z", "e"}) {
        EXPECT_NEAR(end[name].get<double>(), target[name].get<double>(), 1e-3) << name;
    }
    EXPECT_THAT(rig.feedback(), ElementsAre(kReceived, kEnded));
}

TEST(Move, TellsThePoseOfTheUprightArm) {
    Rig rig;
    rig.moveJoints({0, 0, 0, 0, 0, 0});
    EXPECT_TRUE(rig.runUntilState(2));
    rig.runSeconds(0.2);
    const auto upright = rig.client.last("/cartesian_pose");
    EXPECT_NEAR(upright["z"].get<double>(), 990.0, 1e-6);
    EXPECT_NEAR(upright["e"].get<double>(), 0.0, 1e-6);
}

TEST(Move, TurnsZyzAngles) {
    const auto there = toPose({100, 200, 300, 30, 60, -45});
    const auto back = toCartesian(there);
    EXPECT_NEAR(back.a, 30, 1e-9);
    EXPECT_NEAR(back.e, 60, 1e-9);
    EXPECT_NEAR(back.r, -45, 1e-9);
    EXPECT_NEAR(there.rotation.toRotationMatrix()(2, 2), 0.5, 1e-12);  // cos e
}

TEST(Move, UsesToolAndFrame) {
    Rig rig;
    rig.runSeconds(0.2);
    const auto start = rig.client.last("/cartesian_pose");
    rig.client.publish(
        "/bridge_move",
        {{"move_command", 77},
         {"move_type", 76},
         {"ovr", 100},
         {"target",
          {{"data_type", 80},
           {"cartesian_data", pose({start["x"].get<double>() - 400, start["y"].get<double>(),
                                    start["z"].get<double>() - 100 - 200, start["a"].get<double>(),
                                    start["e"].get<double>(), start["r"].get<double>()})}}},
         {"tool", {{"z", 100}}},
         {"frame", {{"x", 400}, {"z", 200}}}});
    EXPECT_TRUE(rig.runUntilState(2));
    // The tool hangs 100 mm below the flange, which therefore stays.
    EXPECT_NEAR(rig.report.base_from_flange->translation.z() * 1000, start["z"].get<double>(), 1.0);
    rig.runSeconds(0.2);
    EXPECT_NEAR(rig.client.last("/cartesian_pose")["x"].get<double>(),
                start["x"].get<double>() - 400, 1.0);
}

TEST(Move, RefusesAPoseOutOfReach) {
    Rig rig;
    moveCartesian(rig, pose({2000, 0, 300, 0, 180, 0}));
    rig.run(3);
    EXPECT_THAT(rig.feedback(), ElementsAre(kReceived, Said(-1, -76), Said(-1, -103)));
    EXPECT_EQ(rig.state(), 2);
}

TEST(Move, RunsAnArcThroughItsVia) {
    Rig rig;
    rig.runSeconds(0.2);
    const auto start = rig.client.last("/cartesian_pose");
    const auto at = [&](double dy, double dz) {
        auto point = start;
        point["y"] = start["y"].get<double>() + dy;
        point["z"] = start["z"].get<double>() + dz;
        return point;
    };
    rig.client.publish("/bridge_move",
                       {{"move_command", 77},
                        {"move_type", 67},
                        {"ovr", 100},
                        {"target", {{"data_type", 80}, {"cartesian_data", at(80, 0)}}},
                        {"via", {{"data_type", 80}, {"cartesian_data", at(40, -40)}}}});
    double lowest = 0.0;
    while (rig.state() == 3) {
        rig.run(1);
        lowest = std::min(lowest, rig.report.base_from_flange->translation.z() * 1000.0 -
                                      start["z"].get<double>());
    }
    EXPECT_NEAR(lowest, -40.0, 0.05);
    EXPECT_THAT(rig.feedback(), ElementsAre(kReceived, kEnded));
}

TEST(Move, RejectsWhatItDoesNotKnow) {
    Rig rig;
    rig.client.publish("/bridge_move", {{"move_command", 88}});
    rig.client.publish("/bridge_move", {{"move_command", 77}, {"move_type", 1}});
    rig.client.publish("/bridge_move",
                       {{"move_command", 77}, {"move_type", 74}, {"target", {{"data_type", 3}}}});
    EXPECT_THAT(rig.feedback(), ElementsAre(Said(-2, 0), Said(-2, 0), Said(-2, 0)));
    EXPECT_EQ(rig.state(), 2);
}

TEST(Move, PausesAndResumes) {
    Rig rig;
    rig.moveJoints({60});
    rig.runSeconds(1.0);
    rig.command('P');
    EXPECT_TRUE(rig.runUntil([&] { return rig.client.last("/algorithm_state")["data"] == 6; }));
    const double at = rig.joint(0);
    EXPECT_THAT(rig.feedback(), ElementsAre(kReceived, kReceived, Said(2, 40)));
    rig.runSeconds(1.0);
    EXPECT_EQ(rig.state(), 3);
    EXPECT_NEAR(rig.joint(0), at, 0.1);
    EXPECT_GT(at, 5.0);
    rig.command('R');
    EXPECT_TRUE(rig.runUntilState(2));
    EXPECT_THAT(rig.feedback(), ElementsAre(kReceived, Said(2, 50), kEnded));
    rig.run(2);
    EXPECT_NEAR(rig.joint(0), 60.0, 1e-9);
}

TEST(Move, CancelsWhatMovesAndWhatWaits) {
    Rig rig;
    rig.moveJoints({60});
    rig.runSeconds(0.5);
    rig.command('P');
    rig.runSeconds(1.0);
    rig.moveJoints({10});
    rig.moveJoints({20});
    rig.run(1);
    rig.feedback();
    rig.command('C');
    EXPECT_TRUE(rig.runUntilState(2));
    rig.run(5);
    EXPECT_THAT(rig.feedback(),
                ElementsAre(kReceived, Said(2, 20), Said(2, 20), Said(2, 20), Said(2, 60)));
    const double at = rig.joint(0);
    rig.runSeconds(1.0);
    EXPECT_NEAR(rig.joint(0), at, 1e-9);
    EXPECT_EQ(rig.state(), 2);
}

TEST(Move, CancelsAMoveThatRuns) {
    Rig rig;
    rig.moveJoints({60});
    rig.runSeconds(1.0);
    rig.feedback();
    rig.command('C');
    EXPECT_TRUE(rig.runUntilState(2));
    rig.run(5);
    EXPECT_THAT(rig.feedback(), ElementsAre(kReceived, Said(2, 20), Said(2, 60)));
}

TEST(Move, QueuesFiveWhilePausedAndSaysThatItIsFull) {
    Rig rig;
    rig.moveJoints({5});
    rig.command('P');
    rig.runSeconds(1.0);
    rig.feedback();
    for (int i = 1; i <= 6; ++i) {
        rig.moveJoints({static_cast<double>(i)});
    }
    const auto said = rig.feedback();
    EXPECT_EQ(said.size(), 8U);
    EXPECT_EQ(said[5], kReceived);
    EXPECT_EQ(said[6], Said(2, 100));
    EXPECT_EQ(said[7], Said(-3, 0));
    rig.command('R');
    EXPECT_TRUE(rig.runUntilState(2));
    rig.run(3);
    EXPECT_NEAR(rig.joint(0), 5.0, 1e-9);  // the sixth was dropped
}

TEST(Move, TakesAResumeOfNothingWithoutPassingItOn) {
    Rig rig;
    rig.command('R');
    rig.runSeconds(1.0);
    EXPECT_EQ(rig.state(), 3);
    EXPECT_THAT(rig.feedback(), ElementsAre(kReceived));
    rig.moveJoints({2});
    rig.run(5);
    rig.command('R');
    EXPECT_TRUE(rig.runUntilState(2));
    EXPECT_THAT(rig.feedback(), ElementsAre(kReceived, kReceived, kEnded));
}

/// The state machine alone: keeps what it says and what it passes on.
class Peers final : public MachinePeers {
public:
    std::size_t loadConfiguration(std::size_t axes) override { return axes; }
    JointBus& bus() override { return bus_; }
    void passMove(const Movement& movement) override { passed.push_back(movement.command); }
    void passJog(const Movement&) override {}
    bool algorithmBusy() const override { return true; }
    void publishFeedback(Feedback feedback) override { said.push_back(feedback.type); }
    void publishBrakesCheck(std::int8_t, std::uint8_t) override {}
    void onBraked() override {}

    std::vector<int> passed;
    std::vector<FeedbackType> said;

private:
    JointBus bus_{limitsOf(edoModel()), kMostAxes, AxisValues{}};
};

TEST(Move, IsNotAskedForTheNextPointWhilePausedOrCancelled) {
    constexpr Feedback kNeedData{.type = FeedbackType::need_data,
                                 .data = FeedbackData::next_wanted};
    Movement move{.command = 'M', .type = 'J', .delay = kFly};
    move.target.data_type = 'J';
    for (const char command : {'P', 'C'}) {
        Peers peers;
        Machine machine(peers);
        machine.makeReady(kMostAxes);
        machine.onMove(move);
        machine.onFeedback(kNeedData);
        EXPECT_THAT(peers.said, ElementsAre(FeedbackType::received, FeedbackType::need_data));
        machine.onMove(Movement{.command = static_cast<std::uint8_t>(command)});
        machine.onMove(move);
        peers.said.clear();
        peers.passed.clear();
        machine.onFeedback(kNeedData);
        EXPECT_THAT(peers.said, IsEmpty()) << command;
        EXPECT_THAT(peers.passed, IsEmpty()) << command;
    }
}

TEST(Move, RunsOneAfterTheOther) {
    Rig rig;
    rig.moveJoints({5});
    rig.moveJoints({10});
    rig.moveJoints({5});
    EXPECT_TRUE(rig.runUntilState(2));
    EXPECT_THAT(rig.feedback(),
                ElementsAre(kReceived, kReceived, kReceived, kEnded, kEnded, kEnded));
}

TEST(Move, WaitsTheDelayBeforeItIsExecuted) {
    Rig rig;
    rig.moveJoints({1}, 2);
    const double seconds = rig.runUntilState(2).value();
    EXPECT_GT(seconds, 2.2);
    EXPECT_LT(seconds, 2.6);
    EXPECT_THAT(rig.feedback(), ElementsAre(kReceived, Said(2, 13)));
}

TEST(Move, FliesThroughTheCornersWithoutAStop) {
    Rig rig;
    rig.moveJoints({20}, 255);
    rig.moveJoints({20, 20}, 255);
    rig.moveJoints({0, 20}, 0);
    rig.run(1);
    bool stopped = false;
    while (rig.state() == 3) {
        rig.run(1);
        const Json joints = rig.client.last("/usb_jnt_state")["joints"];
        const double speed = std::abs(joints[0]["velocity"].get<double>()) +
                             std::abs(joints[1]["velocity"].get<double>());
        const bool between = rig.client.messages("/usb_jnt_state").size() > 20 &&
                             rig.client.last("/algorithm_state")["data"] == 2 &&
                             joints[0]["position"].get<double>() > 10.0;
        stopped = stopped || (between && speed < 2.0);
    }
    EXPECT_FALSE(stopped);
    EXPECT_THAT(rig.feedback(),
                ElementsAre(kReceived, kReceived, kReceived, Said(2, 10), Said(2, 10), kEnded));
    rig.run(3);
    EXPECT_NEAR(rig.joint(0), 0.0, 1e-9);
    EXPECT_NEAR(rig.joint(1), 20.0, 1e-9);
}

TEST(Move, AsksForTheNextPointOfAFly) {
    Rig rig;
    rig.moveJoints({20}, 255);
    EXPECT_TRUE(rig.runUntilState(2));
    EXPECT_THAT(rig.feedback(), ElementsAre(kReceived, Said(1, 12), Said(2, 11)));
}

TEST(Move, EndsWithoutAWordWhenTheBrakesCome) {
    Rig rig;
    rig.moveJoints({60});
    rig.runSeconds(1.0);
    rig.feedback();
    rig.inject("limit", "2");
    rig.runSeconds(0.5);
    EXPECT_EQ(rig.state(), 6);
    EXPECT_THAT(rig.feedback(), IsEmpty());
    const double at = rig.joint(0);
    rig.client.publish("/bridge_jnt_reset", {{"joints_mask", 127}});
    EXPECT_TRUE(rig.runUntilState(2));
    rig.runSeconds(1.0);
    EXPECT_NEAR(rig.joint(0), at, 1e-9);
}

void jog(Rig& rig, std::vector<double> joints) {
    rig.client.publish(
        "/bridge_jog",
        {{"move_command", 74},
         {"move_type", 74},
         {"target",
          {{"data_type", 74}, {"joints_mask", 127}, {"joints_data", std::move(joints)}}}});
}

TEST(Jog, GoesOnAsLongAsItIsRepeatedAndStopsWhenItIsNot) {
    Rig rig;
    for (int i = 0; i < 20; ++i) {
        jog(rig, {1.0});
        rig.run(10);
        EXPECT_EQ(rig.state(), 4);
    }
    EXPECT_NEAR(largestSpeed(rig, 0), 22.79 / 2, 0.1);
    rig.run(17);
    EXPECT_EQ(rig.state(), 2);
    rig.runSeconds(1.0);
    const double at = rig.joint(0);
    rig.runSeconds(0.5);
    EXPECT_NEAR(rig.joint(0), at, 1e-9);
    EXPECT_THAT(rig.feedback(), ElementsAre(kEnded));
}

TEST(Jog, StopsWhenItIsRepeatedWithOtherValues) {
    Rig rig;
    jog(rig, {1.0});
    rig.run(10);
    jog(rig, {0.9});
    EXPECT_EQ(rig.state(), 2);
}

TEST(Jog, StopsWhenTold) {
    Rig rig;
    jog(rig, {0, -0.5});
    rig.run(5);
    rig.client.publish("/bridge_jog", {{"move_command", 83}});
    EXPECT_EQ(rig.state(), 2);
}

TEST(Jog, EndsBeforeTheEndOfTheStroke) {
    Rig rig;
    rig.moveJoints({170});
    rig.runUntilState(2);
    for (int i = 0; i < 400; ++i) {
        jog(rig, {1.0});
        rig.run(10);
    }
    EXPECT_NEAR(rig.joint(0), 178.9, 1e-6);
}

TEST(Jog, MovesALine) {
    Rig rig;
    rig.runSeconds(0.2);
    const auto start = rig.client.last("/cartesian_pose");
    for (int i = 0; i < 20; ++i) {
        rig.client.publish(
            "/bridge_jog",
            {{"move_command", 74},
             {"move_type", 76},
             {"target", {{"data_type", 80}, {"cartesian_data", pose({0, 0, -1, 0, 0, 0})}}}});
        rig.run(10);
    }
    EXPECT_EQ(rig.state(), 4);
    rig.runSeconds(1.5);
    const auto end = rig.client.last("/cartesian_pose");
    EXPECT_LT(end["z"].get<double>(), start["z"].get<double>() - 30.0);
    EXPECT_NEAR(end["x"].get<double>(), start["x"].get<double>(), 0.01);
}

TEST(Jog, IsOnlyOfJointsWhileUncalibrated) {
    Rig rig;
    rig.inject("uncalibrate");
    rig.run(2);
    rig.client.publish("/bridge_jog",
                       {{"move_command", 74}, {"move_type", 76}, {"target", {{"data_type", 80}}}});
    EXPECT_EQ(rig.state(), 1);
    jog(rig, {0, 0, -1.0});
    rig.run(5);
    EXPECT_EQ(rig.state(), 4);
    rig.runSeconds(0.2);
    EXPECT_EQ(rig.state(), 1);
}

TEST(Gripper, StopsAtThePartAndHoldsIt) {
    Rig rig;
    rig.moveJoints({0, 10, 90, 0, 80, 0, 60});
    rig.runUntilState(2);
    EXPECT_FALSE(rig.report.gripping);
    rig.effect.part_width = 0.030;
    rig.moveJoints({0, 10, 90, 0, 80, 0, 10});
    rig.runUntilState(2);
    rig.run(5);
    EXPECT_NEAR(rig.report.jaw_width.value(), 0.030, 1e-9);
    EXPECT_TRUE(rig.report.gripping);
    EXPECT_NEAR(rig.joint(6), 30.0, 1e-9);
    rig.moveJoints({0, 10, 90, 0, 80, 0, 50});
    rig.runUntilState(2);
    rig.run(5);
    EXPECT_FALSE(rig.report.gripping);
    EXPECT_NEAR(rig.report.jaw_width.value(), 0.050, 1e-9);
}

TEST(Gripper, ClosesWhenThePartIsLost) {
    Rig rig;
    rig.moveJoints({0, 10, 90, 0, 80, 0, 60});
    rig.runUntilState(2);
    rig.effect.part_width = 0.030;
    rig.moveJoints({0, 10, 90, 0, 80, 0, 10});
    rig.runUntilState(2);
    rig.inject("lost-part");
    rig.runSeconds(1.0);
    EXPECT_FALSE(rig.report.gripping);
    EXPECT_NEAR(rig.report.jaw_width.value(), 0.010, 1e-9);
}

TEST(Gripper, IsNotThereOnARobotOfSixAxes) {
    Rig rig({.axes = 6});
    rig.run(2);
    EXPECT_FALSE(rig.report.jaw_width);
    EXPECT_EQ(rig.client.last("/usb_jnt_state")["joints"].size(), 6U);
    EXPECT_EQ(rig.client.call("/algo_jnt_number_srv")["joints_mask"], 63);
    EXPECT_EQ(rig.client.call("/algo_tool_configuration_srv")["tool_id"], 0);
}

}  // namespace
}  // namespace metier::virtual_edo
