#include "metier/motion/robot_model.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include "test_robots.hpp"

namespace metier::motion {
namespace {

using testing::HasSubstr;

std::string fileText(const std::string& robot) {
    std::ifstream file(std::string(METIER_MODELS_DIR) + "/" + robot + ".toml");
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

/// The error of the UR5's file after one replacement.
Error errorAfter(const std::string& from, const std::string& to) {
    std::string text = fileText("ur5");
    text.replace(text.find(from), from.size(), to);
    const auto path = std::filesystem::path(testing::TempDir()) /
                      (std::string("metier_") +
                       testing::UnitTest::GetInstance()->current_test_info()->name() + ".toml");
    std::ofstream(path) << text;
    const auto model = RobotModel::load(path);
    std::filesystem::remove(path);
    return model ? Error{Errc::internal, "was accepted"} : model.error();
}

using ModelOf = EachRobot;
INSTANTIATE_TEST_SUITE_P(Robots, ModelOf, testing::ValuesIn(kRobots), robotName);

TEST_P(ModelOf, HasNamesLimitsAndAUsableHome) {
    EXPECT_EQ(model_.name(), GetParam());
    EXPECT_FALSE(model_.maker().empty());
    EXPECT_FALSE(model_.product().empty());
    EXPECT_TRUE(model_.kinematics().withinLimits(model_.home()));
}

TEST_P(ModelOf, IsTheSameWhenBuiltFromItsPublishedChain) {
    const auto copy = RobotModel::fromChain(model_.chain());
    ASSERT_TRUE(copy);
    EXPECT_EQ(copy->kinematics().ikKind(), model_.kinematics().ikKind());
    EXPECT_EQ(poseError(copy->kinematics().forward(model_.home()),
                        model_.kinematics().forward(model_.home())),
              0.0);
}

TEST_P(ModelOf, KeepsItsNamesAndShapeWithAnotherChain) {
    const RobotModel model = loadRobot(GetParam());
    auto chain = model.chain();
    chain.last_from_flange.translation.z() += 0.001;
    const auto changed = model.withChain(chain);
    ASSERT_TRUE(changed) << changed.error().message;
    EXPECT_EQ(changed->name(), model.name());
    EXPECT_EQ(changed->product(), model.product());
    EXPECT_EQ(changed->capsules().size(), model.capsules().size());
    EXPECT_NEAR(motion::distanceBetween(changed->kinematics().forward(model.home()),
                                        model.kinematics().forward(model.home())),
                0.001, 1e-12);
    chain.joints.pop_back();
    chain.home = motion::JointVector(chain.joints.size());
    EXPECT_FALSE(model.withChain(chain));
}

TEST(RobotModel, NamesTheFlangeByItsNameAndByNone) {
    const RobotModel model = loadRobot("ur5");
    EXPECT_EQ(model.tool("")->name, "flange");
    EXPECT_EQ(model.tool("flange")->name, "flange");
    const auto unknown = model.tool("drill");
    ASSERT_FALSE(unknown);
    EXPECT_EQ(unknown.error().code, Errc::not_found);
    EXPECT_THAT(unknown.error().message, HasSubstr("drill"));
}

TEST(RobotModel, TellsThatAFileIsMissing) {
    EXPECT_EQ(RobotModel::load("/nowhere/ur5.toml").error().code, Errc::not_found);
}

TEST(RobotModel, TellsFileLineAndKeyOfAWrongValue) {
    const Error error = errorAfter("velocity_deg = 180", "velocity_deg = \"fast\"");
    EXPECT_THAT(error.message,
                HasSubstr(".toml:21: joint[0].velocity_deg: is not a finite number"));
}

TEST(RobotModel, TellsWhichKeyIsMissing) {
    EXPECT_THAT(errorAfter("jerk = 50.0\n\n[[joint]]", "\n[[joint]]").message,
                HasSubstr("joint[0].jerk: missing"));
}

TEST(RobotModel, RefusesAMisspeltKey) {
    EXPECT_THAT(errorAfter("maker =", "color = 1\nmaker =").message,
                HasSubstr("color: unknown key"));
}

TEST(RobotModel, RefusesAPointWithoutThreeCoordinates) {
    for (const char* point : {"from = [0, 0]", "from = [0, 0, 0, 0]"}) {
        EXPECT_THAT(errorAfter("from = [0, 0, 0]", point).message,
                    HasSubstr("capsule[0].from: not 3 finite numbers"));
    }
}

TEST(RobotModel, TellsTheRoundingOfAShapeAndWhetherItIsGiven) {
    std::string text = fileText("ur5");
    const auto model = RobotModel::parse(text, "ur5");
    ASSERT_TRUE(model) << model.error().message;
    EXPECT_EQ(model->visual().front().edge, 0.004);
    const std::string given = "edge = 0.004\n";
    text.erase(text.find(given), given.size());
    EXPECT_LT(RobotModel::parse(text, "ur5")->visual().front().edge, 0.0);
    EXPECT_THAT(errorAfter(given, "edge = -1\n").message, HasSubstr("visual[0].edge"));
}

TEST(RobotModel, RefusesMoreCapsulesThanAreCompared) {
    const std::string capsule =
        "\n[[capsule]]\nlink = 6\nfrom = [0, 0, 0]\nto = [0, 0, 0.1]\nradius = 0.05\n";
    std::string text = fileText("ur5");
    std::size_t count = RobotModel::parse(text, "ur5")->capsules().size();
    for (; count < kMostCapsules; ++count) {
        text += capsule;
    }
    EXPECT_TRUE(RobotModel::parse(text, "ur5"));
    const auto refused = RobotModel::parse(text + capsule, "ur5");
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("capsule: 33 capsules; self-collision compares "
                                                   "32 at most"));
}

TEST(RobotModel, RefusesLimitsThatAreTheWrongWayRound) {
    EXPECT_THAT(errorAfter("position_deg = [-360, 360]", "position_deg = [10, -10]").message,
                HasSubstr("axis 1 (base): position limits"));
}

TEST(RobotModel, RefusesAHomeOutsideTheLimits) {
    EXPECT_THAT(errorAfter("home = [0.0", "home = [7.0").message, HasSubstr("home 7 rad"));
}

TEST(RobotModel, TellsTheLineOfAFaultInTheSyntax) {
    EXPECT_THAT(errorAfter("name = \"ur5\"", "name = ").message, HasSubstr(".toml:3:8: "));
}

TEST(RobotModel, RefusesAChainWhoseAxisIsNoUnitVector) {
    ChainDescription chain = loadRobot("ur5").chain();
    chain.joints[2].axis = {0, 0, 2};
    EXPECT_THAT(RobotModel::fromChain(chain).error().message, HasSubstr("axis 3"));
}

TEST(RobotModel, RefusesMoreAxesThanItCanHold) {
    ChainDescription chain = loadRobot("iiwa7").chain();
    chain.joints.push_back(chain.joints.back());
    EXPECT_THAT(RobotModel::fromChain(chain).error().message, HasSubstr("8 axes"));
}

/// The error of a UR5's chain after a change; empty if it is still accepted.
template <typename Change>
std::string errorOfChain(Change change) {
    ChainDescription chain = loadRobot("ur5").chain();
    change(chain);
    const auto model = RobotModel::fromChain(std::move(chain));
    EXPECT_TRUE(model || model.error().code == Errc::invalid_argument);
    return model ? std::string() : model.error().message;
}

TEST(RobotModel, RefusesAChainWithANumberThatIsNoLimit) {
    using Chain = ChainDescription;
    EXPECT_EQ(errorOfChain([](Chain&) {}), "");
    for (const double wrong : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
        for (const auto limit :
             {&JointLimits::velocity, &JointLimits::acceleration, &JointLimits::jerk}) {
            EXPECT_THAT(errorOfChain([&](Chain& c) { c.joints[1].limits.*limit = wrong; }),
                        HasSubstr("axis 2 (shoulder): a velocity, acceleration or jerk limit is"));
        }
        for (const auto limit :
             {&CartesianLimits::velocity, &CartesianLimits::acceleration, &CartesianLimits::jerk,
              &CartesianLimits::angular_velocity, &CartesianLimits::angular_acceleration,
              &CartesianLimits::angular_jerk}) {
            EXPECT_THAT(errorOfChain([&](Chain& c) { c.cartesian_limits.*limit = wrong; }),
                        HasSubstr("a Cartesian limit or the cycle time is"));
        }
        EXPECT_NE(errorOfChain([&](Chain& c) { c.cycle_time = wrong; }), "") << wrong;
    }
    EXPECT_NE(errorOfChain([](Chain& c) { c.joints[0].limits.lower = std::nan(""); }), "");
    EXPECT_THAT(errorOfChain([](Chain& c) { c.joints[0].limits.upper = c.joints[0].limits.lower; }),
                HasSubstr("axis 1 (base): position limits"));
}

TEST(RobotModel, RefusesAChainWithAFrameThatIsNotRigid) {
    using Chain = ChainDescription;
    const auto bent = [](Pose& pose) { pose.rotation.coeffs() *= 1.001; };
    const auto lost = [](Pose& pose) { pose.translation.y() = std::nan(""); };
    EXPECT_THAT(errorOfChain([&](Chain& c) { bent(c.joints[5].parent_from_joint); }),
                HasSubstr("axis 6"));
    EXPECT_THAT(errorOfChain([&](Chain& c) { lost(c.joints[0].parent_from_joint); }),
                HasSubstr("axis 1"));
    EXPECT_THAT(errorOfChain([&](Chain& c) { lost(c.last_from_flange); }),
                HasSubstr("the flange frame"));
    EXPECT_THAT(errorOfChain([&](Chain& c) { c.joints[3].axis.x() = std::nan(""); }),
                HasSubstr("axis 4"));
    EXPECT_THAT(errorOfChain([&](Chain& c) {
                    c.tools.push_back({"drill", {}});
                    bent(c.tools.back().flange_from_tool);
                }),
                HasSubstr("tool frame \"drill\""));
}

TEST(RobotModel, RefusesToolsWithoutAUsableNameOrMass) {
    const auto errorOf = [](const ToolFrame& tool) {
        return errorOfChain([&](ChainDescription& c) { c.tools = {tool}; });
    };
    EXPECT_EQ(errorOf({"drill", {}, 1.5}), "");
    EXPECT_THAT(errorOf({"flange", {}}), HasSubstr("reserved name"));
    EXPECT_THAT(errorOf({"", {}}), HasSubstr("reserved name"));
    for (const double wrong : {-0.1, std::nan(""), std::numeric_limits<double>::infinity()}) {
        EXPECT_THAT(errorOf({"drill", {}, wrong}), HasSubstr("tool frame \"drill\": mass"));
    }
    EXPECT_THAT(errorOf({"drill", {}, 1.5, {0, 0, std::nan("")}}), HasSubstr("centre of mass"));
}

TEST(RobotModel, RefusesAHomeOfAnotherNumberOfAxes) {
    EXPECT_THAT(errorOfChain([](ChainDescription& c) { c.home = JointVector(5); }),
                HasSubstr("home has 5 values for 6 axes"));
    EXPECT_NE(errorOfChain([](ChainDescription& c) { c.home[2] = std::nan(""); }), "");
    EXPECT_THAT(errorOfChain([](ChainDescription& c) { c.joints.clear(); }), HasSubstr("0 axes"));
}

}  // namespace
}  // namespace metier::motion
