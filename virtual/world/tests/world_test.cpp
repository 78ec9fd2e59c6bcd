#include "world.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace metier::virtual_world {
namespace {

motion::Pose at(double x, double y, double z) {
    return {{x, y, z}, Eigen::Quaterniond::Identity()};
}

/// Jaws that point down, 0.1 m below the flange; the flange looks down.
motion::Pose flangeOver(double x, double y, double z) {
    return {{x, y, z}, Eigen::Quaterniond(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()))};
}

/// An arm with a gripper over a table with a cube of 3 cm.
struct Cell : ::testing::Test {
    static WorldOptions options() {
        WorldOptions options;
        options.table_height = 0.0;
        Part cube;
        cube.size = {0.03, 0.03, 0.03};
        cube.world_from_part = at(0.5, 0.0, 0.015);
        cube.mass = 0.1;
        options.parts["cube"] = cube;
        options.mounts["gripper"].on = "arm";
        options.mounts["gripper"].flange_from_jaws = at(0.0, 0.0, 0.1);
        options.walls.push_back({{0.6, 0.0, 0.0}, {-1.0, 0.0, 0.0}, 5'000.0, 50.0});
        return options;
    }

    WorldEffect moveArm(const motion::Pose& flange, double time = 0.0) {
        return world.report("arm", {.time = time, .base_from_flange = flange});
    }
    WorldEffect jaws(double width, bool gripping) {
        return world.report("gripper", {.jaw_width = width, .gripping = gripping});
    }
    const Part& cube() const { return world.parts().at("cube"); }

    World world{options()};
};

TEST_F(Cell, ShowsTheJawsThePartBetweenThem) {
    moveArm(flangeOver(0.5, 0.0, 0.115));
    EXPECT_NEAR(jaws(0.08, false).part_width.value_or(0), 0.03, 1e-12);
    moveArm(flangeOver(0.5, 0.0, 0.3));
    EXPECT_FALSE(jaws(0.08, false).part_width) << "the part is far below";
    moveArm(flangeOver(0.58, 0.0, 0.115));
    EXPECT_FALSE(jaws(0.08, false).part_width) << "the part is beside the jaws";
}

TEST_F(Cell, MovesAHeldPartWithTheFlange) {
    moveArm(flangeOver(0.5, 0.0, 0.115));
    jaws(0.03, true);
    EXPECT_EQ(cube().held_by, "gripper");
    moveArm(flangeOver(0.3, 0.2, 0.515));
    EXPECT_NEAR(cube().world_from_part.translation.x(), 0.3, 1e-12);
    EXPECT_NEAR(cube().world_from_part.translation.y(), 0.2, 1e-12);
    EXPECT_NEAR(cube().world_from_part.translation.z(), 0.415, 1e-12);
}

TEST_F(Cell, LetsAReleasedPartComeToLieOnTheTable) {
    moveArm(flangeOver(0.5, 0.0, 0.115));
    jaws(0.03, true);
    moveArm(flangeOver(0.3, 0.2, 0.515));
    jaws(0.08, false);
    EXPECT_EQ(cube().held_by, "");
    EXPECT_NEAR(cube().world_from_part.translation.z(), 0.015, 1e-12);
}

TEST_F(Cell, KeepsAPartBetweenJawsThatStandStillAroundIt) {
    moveArm(flangeOver(0.5, 0.0, 0.115));
    jaws(0.03, true);
    moveArm(flangeOver(0.5, 0.0, 0.515));
    EXPECT_TRUE(jaws(0.0302, false).part_width);
    EXPECT_EQ(cube().held_by, "gripper");
}

TEST_F(Cell, DropsAPartThatIsThenGoneFromTheJaws) {
    moveArm(flangeOver(0.5, 0.0, 0.115));
    ASSERT_TRUE(jaws(0.03, true).part_width);
    world.drop("gripper");
    EXPECT_FALSE(jaws(0.03, true).part_width);
}

TEST_F(Cell, WeighsAHeldPart) {
    moveArm(flangeOver(0.5, 0.0, 0.115));
    jaws(0.03, true);
    const auto wrench = moveArm(flangeOver(0.5, 0.0, 0.3)).wrench;
    EXPECT_NEAR(wrench.force.z(), 0.981, 1e-9) << "down is along z of a flange that looks down";
}

TEST_F(Cell, PushesBackWithSpringAndDamper) {
    moveArm(at(0.599, 0.0, 0.5));
    EXPECT_EQ(moveArm(at(0.5995, 0.0, 0.5), 0.01).wrench.force.norm(), 0.0);
    moveArm(at(0.602, 0.0, 0.5), 0.02);
    const auto moving = moveArm(at(0.603, 0.0, 0.5), 0.03).wrench.force;
    EXPECT_NEAR(moving.x(), -(5'000.0 * 0.003 + 50.0 * 0.1), 1e-6);
    const auto standing = moveArm(at(0.603, 0.0, 0.5), 0.04).wrench.force;
    EXPECT_NEAR(standing.x(), -15.0, 1e-9);
}

TEST_F(Cell, GivesAnArmThatWasStartedAgainNoSpeedFromBefore) {
    moveArm(at(0.599, 0.0, 0.5), 100.0);
    moveArm(at(0.602, 0.0, 0.5), 100.01);
    const auto again = moveArm(at(0.603, 0.0, 0.5), 0.01).wrench.force;
    EXPECT_NEAR(again.x(), -15.0, 1e-9);
}

TEST_F(Cell, GivesASensorTheWrenchOnItsArm) {
    auto with_sensor = options();
    with_sensor.mounts["sensor"].on = "arm";
    World other(with_sensor);
    other.report("arm", {.base_from_flange = at(0.602, 0.0, 0.5)});
    EXPECT_NEAR(other.report("sensor", {}).wrench.force.x(), -10.0, 1e-9);
}

TEST_F(Cell, PutsPartsElsewhereOrAway) {
    ASSERT_TRUE(world.place("cube", {0.1, 0.2, 0.3}));
    EXPECT_EQ(cube().world_from_part.translation, Eigen::Vector3d(0.1, 0.2, 0.3));
    EXPECT_FALSE(world.place("ball", {0, 0, 0}));
    ASSERT_TRUE(world.remove("cube"));
    EXPECT_FALSE(world.remove("cube"));
}

TEST_F(Cell, APartThatIsHeldOffTheFlangePullsWithItsLever) {
    moveArm(flangeOver(0.5, 0.0, 0.115));
    jaws(0.03, true);
    // The arm on its side: the part hangs 0.1 m beside the flange.
    const motion::Pose aside{
        {0.5, 0.0, 0.5},
        Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitY()))};
    const auto wrench = moveArm(aside).wrench;
    EXPECT_NEAR(wrench.force.norm(), 0.981, 1e-9);
    EXPECT_NEAR(wrench.torque.norm(), 0.981 * 0.1, 1e-9);
    EXPECT_NEAR(wrench.torque.dot(wrench.force), 0.0, 1e-12);
}

TEST_F(Cell, APartThatIsTurnedIsWiderBetweenTheJaws) {
    auto turned = options();
    turned.parts["cube"].world_from_part.rotation =
        Eigen::AngleAxisd(M_PI / 4.0, Eigen::Vector3d::UnitZ());
    World other(turned);
    other.report("arm", {.base_from_flange = flangeOver(0.5, 0.0, 0.115)});
    EXPECT_NEAR(other.report("gripper", {.jaw_width = 0.08}).part_width.value_or(0),
                0.03 * std::sqrt(2.0), 1e-12);
}

TEST_F(Cell, HasItsBasesWhereTheyAreMounted) {
    auto mounted = options();
    mounted.mounts["arm"].world_from_base = at(0.0, 0.0, 0.2);
    World other(mounted);
    EXPECT_FALSE(other.flangeOf("arm"));
    other.report("arm", {.base_from_flange = at(0.1, 0.0, 0.3)});
    EXPECT_EQ(other.flangeOf("arm")->translation, Eigen::Vector3d(0.1, 0.0, 0.5));
}

TEST_F(Cell, OneGripperLosesItsPartAndTheOtherKeepsIts) {
    auto two = options();
    two.parts["rod"] = two.parts["cube"];
    two.parts["rod"].world_from_part = at(-0.5, 0.0, 0.015);
    two.mounts["other gripper"] = two.mounts["gripper"];
    two.mounts["other gripper"].on = "other arm";
    World other(two);
    other.report("arm", {.base_from_flange = flangeOver(0.5, 0.0, 0.115)});
    other.report("other arm", {.base_from_flange = flangeOver(-0.5, 0.0, 0.115)});
    other.report("gripper", {.jaw_width = 0.03, .gripping = true});
    other.report("other gripper", {.jaw_width = 0.03, .gripping = true});
    EXPECT_EQ(other.parts().at("rod").held_by, "other gripper");
    other.drop("gripper");
    EXPECT_EQ(other.parts().at("cube").held_by, "");
    EXPECT_EQ(other.parts().at("rod").held_by, "other gripper");
    other.drop("");
    EXPECT_EQ(other.parts().at("rod").held_by, "");
}

TEST_F(Cell, AnArmOrSensorThatNeverReportedFeelsNothing) {
    EXPECT_EQ(world.report("sensor", {}).wrench.force.norm(), 0.0);
    EXPECT_FALSE(jaws(0.05, true).part_width);
    EXPECT_EQ(cube().held_by, "");
}

}  // namespace
}  // namespace metier::virtual_world
