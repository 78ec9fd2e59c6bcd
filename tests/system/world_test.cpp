// Virtual controllers that share a world: a held part moves with the flange, a missed grasp is
// seen, a wall pushes back.
#include <gmock/gmock.h>

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "metier_program.hpp"
#include "running_cell.hpp"

namespace metier::system_tests {
namespace {

using skill::Frame;
using skill::Value;
using ::testing::HasSubstr;

/// A move by some metres along the axes of the base.
skill::ValueMap by(double x, double y, double z) {
    return {{"TargetPosition", Frame{x, y, z, 0, 0, 0}}, {"Relative", 1}};
}

class CellWithAWorld : public ::testing::Test {
protected:
    nlohmann::json cube() const { return cell_.state("world").at("parts").at("cube"); }
    double height() const { return cube().at("pose").at(2).get<double>(); }
    opcua::Answer<skill::ValueMap> grasp() {
        return openSkill(*gripper_, "GraspGripperSkill").run({{"Force", 40.0}}, inAMinute());
    }
    /// Jaws that lost their part close, and meanwhile refuse a grasp.
    opcua::Answer<skill::ValueMap> graspAfterALoss() {
        const auto deadline = inAMinute();
        auto answer = grasp();
        while (!answer && answer.error().message.find("jaws still move") != std::string::npos &&
               std::chrono::steady_clock::now() < deadline) {
            answer = grasp();
        }
        return answer;
    }

    RunningCell cell_{deviceCell("world")};
    std::unique_ptr<opcua::Client> arm_ = connectTo(cell_.url("arm"));
    std::unique_ptr<opcua::Client> gripper_ = connectTo(cell_.url("gripper"));
    client::SkillHandle move_ = openSkill(*arm_, "CartesianLinearMoveSkill");
};

// The flange stands at x 0.5464, z 0.3604 and looks down; the jaws are 0.15 m below it.
constexpr const char* kBetweenTheJaws = "cube,0.5464,0,0.2104";

TEST_F(CellWithAWorld, MovesAHeldPartWithTheFlange) {
    cell_.inject("world", "place", kBetweenTheJaws);
    const auto held = grasp();
    ASSERT_TRUE(held) << held.error().message;
    EXPECT_EQ(held->at("PartHeld"), Value(true));
    EXPECT_NEAR(std::get<double>(held->at("WidthReached")), 0.03, 2e-3);
    EXPECT_EQ(cube().at("held_by"), "wsg");
    const auto before = height();
    const auto moved = move_.run(by(0, 0, 0.05), inAMinute());
    ASSERT_TRUE(moved) << moved.error().message;
    EXPECT_NEAR(height() - before, 0.05, 1e-3);
    const auto released = openSkill(*gripper_, "ReleaseGripperSkill").run({}, inAMinute());
    ASSERT_TRUE(released) << released.error().message;
    EXPECT_EQ(cube().at("held_by"), "");
    EXPECT_NEAR(height(), 0.015, 1e-6) << "it lies on the table";
}

TEST_F(CellWithAWorld, SeesAMissedGrasp) {
    const auto missed = grasp();
    ASSERT_FALSE(missed);
    EXPECT_THAT(missed.error().message, HasSubstr("no part"));
}

TEST_F(CellWithAWorld, SeesAPartThatIsLost) {
    cell_.inject("world", "place", kBetweenTheJaws);
    ASSERT_TRUE(grasp());
    cell_.inject("world", "drop", "wsg");
    const auto again = graspAfterALoss();
    ASSERT_FALSE(again) << "the jaws hold nothing any more";
    EXPECT_THAT(again.error().message, HasSubstr("no part"));
}

TEST_F(CellWithAWorld, GoesOnWithAMoveThatLosesItsPartAndTheGripperSaysSoAtTheNextGrasp) {
    cell_.inject("world", "place", kBetweenTheJaws);
    ASSERT_TRUE(grasp());
    const auto held_at = height();
    auto parameters = by(0, 0, 0.05);
    parameters["SpeedOverride"] = 0.05;
    for (const auto& [name, value] : parameters) {
        ASSERT_TRUE(move_.set(name, value));
    }
    ASSERT_TRUE(move_.start());
    const auto deadline = inAMinute();
    while (height() < held_at + 0.005) {
        ASSERT_LT(std::chrono::steady_clock::now(), deadline) << "the part does not move";
    }
    cell_.inject("world", "drop", "wsg");
    const auto end = move_.awaitEnd(inAMinute()).value();
    EXPECT_EQ(end.to, skill::State::ready) << "an arm does not feel what the jaws hold";
    EXPECT_NEAR(height(), 0.015, 1e-6) << "it lies on the table";
    const auto again = graspAfterALoss();
    ASSERT_FALSE(again);
    EXPECT_THAT(again.error().message, HasSubstr("no part"));
}

/// Moves 0.1 m away from the base into a wall that stands some centimetres away; 20 N are reached
/// 4 mm behind its face.
void expectToEndAtTheWall(opcua::Client& client, double wall) {
    const double outward = wall > 0.0 ? 1.0 : -1.0;
    auto parameters = by(0.1 * outward, 0, 0);
    parameters["MaxForce"] = skill::Vector3{20, 0, 0};
    // A process that is late by 0.3 s lets it press by 15 N more.
    parameters["SpeedOverride"] = 0.01;
    auto skill = openSkill(client, "CartesianLinearForceMoveSkill");
    const auto ended = skill.run(parameters, inAMinute());
    ASSERT_TRUE(ended) << ended.error().message;
    const auto exceeded = std::get<skill::Vector3>(ended->at("ForcesExceeded"));
    EXPECT_GE(std::abs(exceeded.x), 18.0);
    EXPECT_LE(std::abs(exceeded.x), 60.0);
    const auto pose = std::get<Frame>(ended->at("ReachedPose"));
    EXPECT_NEAR(pose.x, wall + 0.005 * outward, 0.01);
}

TEST_F(CellWithAWorld, EndsAForceMoveAtTheWallByTheCabinetsOwnCondition) {
    expectToEndAtTheWall(*arm_, 0.6);
    EXPECT_TRUE(move_.run(by(-0.05, 0, 0), inAMinute())) << "and the way back is free";
}

TEST(CellWithASensor, EndsAForceMoveAtTheWallByTheSensor) {
    const RunningCell cell(deviceCell("sensor"));
    const auto client = connectTo(cell.url("arm"));
    expectToEndAtTheWall(*client, -0.6);
}

}  // namespace
}  // namespace metier::system_tests
