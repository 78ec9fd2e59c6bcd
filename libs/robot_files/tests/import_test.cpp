#include "metier/robot_files/import.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <iterator>
#include <set>

#include "comparison.hpp"
#include "random_urdf.hpp"

namespace metier::robot_files {
namespace {

using motion::IkKind;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::SizeIs;

SourceFile sourceFile(const std::string& name) {
    std::ifstream file(std::string(METIER_URDF_DIR) + "/" + name);
    EXPECT_TRUE(file) << name;
    return {name, {std::istreambuf_iterator<char>(file), {}}};
}

ImportedRobot imported(const std::string& name, const ImportOptions& options = {}) {
    auto robot = importUrdf(sourceFile(name), std::nullopt, options);
    if (!robot) {
        throw std::runtime_error(robot.error().message);
    }
    return std::move(*robot);
}

/// The error of a file after a replacement.
std::string errorAfter(const std::string& name, const std::string& from, const std::string& to,
                       const ImportOptions& options = {}) {
    auto source = sourceFile(name);
    const auto at = source.text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    source.text.replace(at, from.size(), to);
    const auto robot = importUrdf(source, std::nullopt, options);
    EXPECT_TRUE(robot || robot.error().code == Errc::invalid_argument);
    return robot ? "was accepted" : robot.error().message;
}

std::string errorOf(const std::string& name, const ImportOptions& options = {}) {
    return errorAfter(name, "<robot", "<robot", options);
}

struct Chain {
    const char* file;
    const char* base;
    const char* tip;
};

void PrintTo(const Chain& chain, std::ostream* out) {
    *out << chain.file << " " << chain.base << " " << chain.tip;
}

class ImportedChain : public testing::TestWithParam<Chain> {};
INSTANTIATE_TEST_SUITE_P(
    Files, ImportedChain,
    testing::Values(Chain{"odd_axes.urdf", "", ""}, Chain{"odd_axes.urdf", "l1", "l4"},
                    Chain{"fixed_between.urdf", "", ""}, Chain{"fixed_between.urdf", "", "flange"},
                    Chain{"fixed_between.urdf", "foot", "drill_tip"},
                    Chain{"fixed_between.urdf", "adapter", "hand"},
                    Chain{"two_arms.urdf", "torso", "left_hand"},
                    Chain{"two_arms.urdf", "torso", "right_hand"},
                    Chain{"two_arms.urdf", "right_1", "finger_1"}, Chain{"shapes.urdf", "", ""}));

TEST_P(ImportedChain, HasTheForwardKinematicsOfKdl) {
    ImportOptions options;
    options.base = GetParam().base;
    options.tip = GetParam().tip;
    const auto robot = imported(GetParam().file, options);
    KdlUrdf kdl(sourceFile(GetParam().file).text, robot.base, robot.tip);
    ASSERT_EQ(kdl.axisCount(), robot.model.axisCount());
    const auto difference = differenceToKdl(robot.model, kdl, 1000);
    EXPECT_LT(difference.position, 1e-12);
    EXPECT_LT(difference.rotation, 1e-12);
}

TEST(ImportedChains, OfRandomRobotsHaveTheForwardKinematicsOfKdl) {
    std::mt19937_64 random(5);
    for (int i = 0; i < 300; ++i) {
        const auto urdf = randomUrdf(random);
        const auto robot = importUrdf({"random.urdf", urdf}, std::nullopt, {});
        ASSERT_TRUE(robot) << robot.error().message << "\n" << urdf;
        KdlUrdf kdl(urdf, robot->base, robot->tip);
        ASSERT_EQ(kdl.axisCount(), robot->model.axisCount());
        const auto difference = differenceToKdl(robot->model, kdl, 20);
        EXPECT_LT(difference.position, 1e-11) << urdf;
        EXPECT_LT(difference.rotation, 1e-11) << urdf;
    }
}

TEST(ImportedModel, IsTheOneInItsText) {
    for (const char* file : {"odd_axes.urdf", "shapes.urdf"}) {
        const auto robot = imported(file);
        const auto read = motion::RobotModel::parse(robot.text, "model.toml");
        ASSERT_TRUE(read) << read.error().message << robot.text;
        EXPECT_EQ(read->home(), robot.model.home());
        EXPECT_EQ(read->name(), robot.model.name());
    }
}

TEST(ImportedModel, HasTheLimitsOfTheFile) {
    const auto robot = imported("odd_axes.urdf");
    const auto& first = robot.model.limits(0);
    EXPECT_EQ(first.lower, -3);
    EXPECT_EQ(first.upper, 3);
    EXPECT_EQ(first.velocity, 2);
    EXPECT_EQ(first.acceleration, 7);
    EXPECT_EQ(first.jerk, 70);
    EXPECT_EQ(robot.model.chain().joints[0].name, "negative");
}

TEST(ImportedModel, ListsWhatItAssumes) {
    const auto robot = imported("odd_axes.urdf");
    EXPECT_EQ(robot.model.limits(1).acceleration, 5);
    EXPECT_EQ(robot.model.limits(1).jerk, 50);
    EXPECT_NEAR(robot.model.limits(5).upper, 6.283185307179586, 1e-15);
    EXPECT_THAT(robot.assumed,
                AllOf(Contains(HasSubstr("range of -2 pi to 2 pi of many_turns")),
                      Contains(HasSubstr("acceleration of 5 rad/s2 of oblique, default_axis")),
                      Contains(HasSubstr("jerk of 50 rad/s3 of oblique")),
                      Contains(HasSubstr("cycle time of 0.008 s")),
                      Contains(HasSubstr("Cartesian limits of 0.25 m/s")),
                      Contains(HasSubstr("home: a position far from singularities")),
                      Contains("maker \"unknown\"")));
    for (const auto& assumed : robot.assumed) {
        EXPECT_THAT(robot.text, HasSubstr("#   - " + assumed + "\n"));
    }
}

TEST(ImportedModel, TakesFromOptionsWhatTheFileDoesNotGive) {
    ImportOptions options;
    options.name = "odd";
    options.maker = "Nobody \"& sons\"";
    options.product = "Odd\\One";
    options.cycle_time = 0.004;
    options.velocity = {9};
    options.acceleration = {1, 2, 3, 4, 5, 6};
    options.jerk = {33};
    options.position = {-1, 1.5};
    options.home = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6};
    const auto robot = imported("odd_axes.urdf", options);
    EXPECT_EQ(robot.model.name(), "odd");
    EXPECT_EQ(robot.model.maker(), options.maker);
    EXPECT_EQ(robot.model.product(), options.product);
    EXPECT_EQ(robot.model.cycleTime(), 0.004);
    EXPECT_EQ(robot.model.limits(0).velocity, 2) << "given in the file";
    EXPECT_EQ(robot.model.limits(0).acceleration, 7) << "given in the file";
    EXPECT_EQ(robot.model.limits(1).acceleration, 2);
    EXPECT_EQ(robot.model.limits(1).jerk, 33);
    EXPECT_EQ(robot.model.limits(1).upper, 2.5) << "given in the file";
    EXPECT_EQ(robot.model.limits(5).upper, 1.5);
    EXPECT_EQ(robot.model.home()[5], 0.6);
    EXPECT_THAT(robot.assumed, SizeIs(1)) << "the Cartesian limits";
}

TEST(ImportedModel, RefusesOptionsThatDoNotFit) {
    const auto errorWith = [](auto change) {
        ImportOptions options;
        change(options);
        return errorOf("odd_axes.urdf", options);
    };
    EXPECT_EQ(errorWith([](auto& o) { o.velocity = {1, 2}; }), "velocity: 2 values for 6 axes");
    EXPECT_EQ(errorWith([](auto& o) { o.jerk = {-1}; }), "jerk: -1 is not over 0");
    EXPECT_EQ(errorWith([](auto& o) { o.home = {0, 0}; }), "home: 2 values for 6 axes");
    EXPECT_THAT(errorWith([](auto& o) { o.home = {4, 0, 0, 0, 0, 0}; }),
                HasSubstr("axis 1 (negative): home 4 rad is outside -3 to 3 rad"));
    EXPECT_THAT(errorWith([](auto& o) { o.position = {1, -1}; }), HasSubstr("position: not a"));
    EXPECT_THAT(errorWith([](auto& o) { o.group = "arm"; }), HasSubstr("no group \"arm\""));
    EXPECT_THAT(errorWith([](auto& o) { o.cycle_time = 0; }), HasSubstr("cycle time: 0 s"));
}

TEST(ImportedModel, HasSoftLimitsWhereTheyAreNarrower) {
    const auto robot = imported("fixed_between.urdf");
    EXPECT_EQ(robot.model.limits(1).lower, -1.5);
    EXPECT_EQ(robot.model.limits(1).upper, 2);
}

TEST(ImportedModel, EndsAtTool0AndHasToolsForTheLinksBehind) {
    const auto robot = imported("fixed_between.urdf");
    EXPECT_EQ(robot.base, "world");
    EXPECT_EQ(robot.tip, "tool0");
    ASSERT_THAT(robot.model.chain().tools, SizeIs(2));
    const auto tip = robot.model.tool("drill_tip");
    ASSERT_TRUE(tip);
    ImportOptions to_tip;
    to_tip.tip = "drill_tip";
    const auto direct = imported("fixed_between.urdf", to_tip);
    const motion::JointVector q{0.1, 0.2, 0.3};
    EXPECT_LT(motion::distanceBetween(robot.model.kinematics().forward(q) * tip->flange_from_tool,
                                      direct.model.kinematics().forward(q)),
              1e-14);
    to_tip.tip = "hand";
    EXPECT_THAT(imported("fixed_between.urdf", to_tip).left_out,
                Contains(HasSubstr("link \"flange\" (line 16) as a tool")));
}

TEST(ImportedModel, HasAHomeAboveTheBaseAndFarFromSingularities) {
    const auto robot = imported("shapes.urdf");
    const auto& kinematics = robot.model.kinematics();
    EXPECT_TRUE(kinematics.withinLimits(robot.model.home()));
    EXPECT_GT(kinematics.smallestSingularValue(robot.model.home()), 0.1);
    EXPECT_GT(kinematics.forward(robot.model.home()).translation.z(), 0.0);
    EXPECT_EQ(imported("shapes.urdf").model.home(), robot.model.home());
}

TEST(ImportedModel, SaysWhatCanBePlanned) {
    EXPECT_THAT(imported("fixed_between.urdf").planning,
                HasSubstr("with 3 axes hardly any pose can be reached"));
    EXPECT_THAT(imported("odd_axes.urdf").planning, HasSubstr("by iteration"));
    ImportOptions rounded;
    rounded.round_angles = true;
    EXPECT_THAT(imported("shapes.urdf", rounded).planning,
                HasSubstr("closed form: axes 2 and 3 are parallel; 4, 5 and 6 meet in a point"));
}

TEST(ImportedModel, RoundsAnglesOnRequestAndSaysWhatThatChanges) {
    const auto written = imported("shapes.urdf");
    EXPECT_EQ(written.model.kinematics().ikKind(), IkKind::numeric);
    EXPECT_THAT(written.remarks, Contains(AllOf(HasSubstr("with --round-angles all moves"),
                                                HasSubstr("closed form"), HasSubstr(" mm)"))));
    ImportOptions options;
    options.round_angles = true;
    const auto rounded = imported("shapes.urdf", options);
    EXPECT_EQ(rounded.model.kinematics().ikKind(), IkKind::spherical_wrist);
    EXPECT_THAT(rounded.remarks,
                Contains(HasSubstr("rounded angles move the flange by up to 0.00")));
    const auto& home = written.model.home();
    const auto moved = motion::distanceBetween(written.model.kinematics().forward(home),
                                               rounded.model.kinematics().forward(home));
    EXPECT_GT(moved, 0.0);
    EXPECT_LT(moved, 1e-5);
}

TEST(ImportedShapes, AreCapsulesAroundTheCollisionElements) {
    const auto robot = imported("shapes.urdf");
    const auto& capsules = robot.model.capsules();
    ASSERT_THAT(capsules, SizeIs(6));
    EXPECT_EQ(capsules[0].link, 0U);
    EXPECT_EQ(capsules[0].radius, 0.1);
    EXPECT_LT((capsules[0].to - Eigen::Vector3d(0, 0, 0.1)).norm(), 1e-15);
    EXPECT_EQ(capsules[1].link, 2U) << "the box";
    EXPECT_NEAR(capsules[1].radius, 0.05, 1e-15);
    EXPECT_LT((capsules[1].from - Eigen::Vector3d(0, 0, 0)).norm(), 1e-15);
    EXPECT_LT((capsules[1].to - Eigen::Vector3d(0, 0, 0.4)).norm(), 1e-15);
    EXPECT_EQ(capsules[2].from, capsules[2].to) << "the ball";
    EXPECT_LT((capsules[3].to - Eigen::Vector3d(0.05, 0, -0.1)).norm(), 1e-6) << "turned";
    EXPECT_EQ(capsules[5].link, 6U) << "the camera moves with axis 6";
    EXPECT_LT((capsules[5].from - Eigen::Vector3d(0.05, 0, 0.02)).norm(), 1e-15);
}

TEST(ImportedShapes, AreDrawnWithTheirColors) {
    const auto robot = imported("shapes.urdf");
    const auto& visual = robot.model.visual();
    ASSERT_THAT(visual, SizeIs(3));
    EXPECT_EQ(visual[0].color, (std::array<double, 3>{0.1, 0.2, 0.9})) << "by name";
    EXPECT_EQ(visual[0].from_radius, 0.1);
    EXPECT_EQ(visual[1].link, 0U) << "the plate stands with the base";
    EXPECT_NEAR((visual[1].to - visual[1].from).norm(), 0.02, 1e-15) << "a disc for the box";
    EXPECT_EQ(visual[2].color, (std::array<double, 3>{1, 0, 0}));
    EXPECT_EQ(visual[2].edge, 0.05);
    EXPECT_NEAR((visual[2].to - visual[2].from).norm(), 0.1, 1e-15);
}

TEST(ImportedShapes, SayWhatIsLeftOutByLine) {
    EXPECT_THAT(imported("shapes.urdf").left_out,
                AllOf(Contains(HasSubstr("1 <visual> with mesh (line 24)")),
                      Contains(HasSubstr("1 <collision> with mesh (line 27)")),
                      Contains(HasSubstr("1 <visual> with box (line 19): drawn as cylinders"))));
    EXPECT_THAT(imported("odd_axes.urdf").remarks,
                Contains(HasSubstr("without capsules self-collision is not checked")));
}

TEST(ImportedShapes, OfNoSizeAreLeftOut) {
    auto source = sourceFile("shapes.urdf");
    for (const char* size : {"radius=\"0.1\"", "0.06 0.08 0.4"}) {
        const std::string none = *size == 'r' ? "radius=\"0\"" : "0 0 0";
        source.text.replace(source.text.find(size), std::string(size).size(), none);
    }
    const auto robot = importUrdf(source, std::nullopt, {});
    ASSERT_TRUE(robot) << robot.error().message;
    EXPECT_THAT(robot->left_out,
                AllOf(Contains(HasSubstr("1 <visual> with a size of 0 (line 8)")),
                      Contains(HasSubstr("1 <collision> with a size of 0 (line 32)"))));
    EXPECT_THAT(robot->model.visual(), SizeIs(2));
}

TEST(ImportedSemantics, GiveChainHomeAndPairs) {
    const auto robot = importUrdf(sourceFile("shapes.urdf"), sourceFile("shapes.srdf"), {});
    ASSERT_TRUE(robot) << robot.error().message;
    EXPECT_EQ(robot->model.home()[1], -0.5);
    EXPECT_EQ(robot->model.home()[5], 0.25);
    EXPECT_THAT(robot->remarks, Contains(HasSubstr("SRDF group \"arm\"")));
    const auto& pairs = robot->model.notCompared();
    ASSERT_THAT(pairs, SizeIs(2)) << "links that are near in the chain need none";
    EXPECT_EQ(pairs[0].first, 0U);
    EXPECT_EQ(pairs[0].second, 3U);
    EXPECT_EQ(pairs[1].first, 2U);
    EXPECT_EQ(pairs[1].second, 6U);
    EXPECT_THAT(robot->remarks, Contains(HasSubstr("links 3 and 6 are compared although")));
}

TEST(ImportedSemantics, DisableALinkByDefaultButForEnabledPairs) {
    auto semantics = sourceFile("shapes.srdf");
    const std::string end = "</robot>";
    semantics.text.replace(semantics.text.find(end), end.size(),
                           "<disable_default_collisions link=\"base_link\"/>\n"
                           "<enable_collisions link1=\"link_4\" link2=\"base_link\"/>\n</robot>");
    const auto robot = importUrdf(sourceFile("shapes.urdf"), semantics, {});
    ASSERT_TRUE(robot) << robot.error().message;
    std::set<std::pair<std::size_t, std::size_t>> pairs;
    for (const auto& pair : robot->model.notCompared()) {
        pairs.insert({pair.first, pair.second});
    }
    EXPECT_EQ(pairs, (std::set<std::pair<std::size_t, std::size_t>>{{0, 3}, {0, 6}, {2, 6}}));
}

TEST(ImportedSemantics, AreRefusedByLine) {
    const auto errorWith = [](const std::string& text) {
        const auto robot = importUrdf(sourceFile("shapes.urdf"), SourceFile{"a.srdf", text}, {});
        return robot ? "was accepted" : robot.error().message;
    };
    EXPECT_THAT(errorWith("<robot>\n<disable_collisions link1=\"a\"/></robot>"),
                HasSubstr("a.srdf:2: <disable_collisions>: no link2"));
    EXPECT_THAT(errorWith("<group/>"), HasSubstr("no SRDF file"));
    EXPECT_THAT(errorWith("<robot>\n\n<"), HasSubstr("a.srdf:3: no XML"));
}

TEST(Refusal, OfAHomeOfTheSemanticsIsARemark) {
    auto semantics = sourceFile("shapes.srdf");
    const std::string value = "name=\"j2\" value=\"-0.5\"";
    semantics.text.replace(semantics.text.find(value), value.size(), "name=\"j2\" value=\"-2.5\"");
    const auto robot = importUrdf(sourceFile("shapes.urdf"), semantics, {});
    ASSERT_TRUE(robot);
    EXPECT_THAT(robot->remarks, Contains(HasSubstr("-2.5 rad is outside -2 to 2 rad of axis 2")));
}

TEST(Refusal, NamesTheJointThatDoesNotTurnAndTheChoices) {
    ImportOptions to_hand;
    to_hand.tip = "left_hand";
    EXPECT_THAT(errorOf("two_arms.urdf", to_hand),
                AllOf(HasSubstr("two_arms.urdf:15: <joint name=\"lift\">: its type is prismatic"),
                      HasSubstr("--tip \"floor\""), HasSubstr("--base \"torso\"")));
    for (const char* type : {"planar", "floating", "helical"}) {
        EXPECT_THAT(errorAfter("odd_axes.urdf", "\"continuous\"", '"' + std::string(type) + '"'),
                    AllOf(HasSubstr("odd_axes.urdf:44: <joint name=\"many_turns\">: its type is " +
                                    std::string(type)),
                          HasSubstr("--tip \"l5\"")));
    }
}

TEST(Refusal, NamesTheJointThatFollowsAnother) {
    ImportOptions to_finger;
    to_finger.base = "torso";
    to_finger.tip = "finger_2";
    EXPECT_THAT(
        errorOf("two_arms.urdf", to_finger),
        HasSubstr("two_arms.urdf:70: <joint name=\"finger_q2\">: it follows another joint"));
    to_finger.tip = "right_hand";
    EXPECT_THAT(imported("two_arms.urdf", to_finger).left_out,
                AllOf(Contains(HasSubstr("joint \"finger_q1\" (revolute, line 63)")),
                      Contains(HasSubstr("joint \"finger_q2\" (revolute, mimic, line 70)"))));
}

TEST(Refusal, ListsTheChainsOfATree) {
    ImportOptions from_torso;
    from_torso.base = "torso";
    EXPECT_THAT(
        errorOf("two_arms.urdf", from_torso),
        AllOf(HasSubstr("two_arms.urdf:7: <link name=\"left_2\">: end of one of 2 chains (2 axes)"),
              HasSubstr("two_arms.urdf:13: <link name=\"finger_1\">: end of one of 2 chains")));
    EXPECT_THAT(errorOf("two_arms.urdf"),
                HasSubstr("two_arms.urdf:15: <joint name=\"lift\">: its type is prismatic"));
}

TEST(Refusal, NamesLinksThatAreNotThere) {
    ImportOptions options;
    options.tip = "hand";
    EXPECT_THAT(errorOf("odd_axes.urdf", options),
                HasSubstr("odd_axes.urdf:3: <robot name=\"odd_axes\">: --tip: no link \"hand\"; "
                          "there are: base, l1, l2, l3, l4, l5, l6"));
    options.tip = "l1";
    options.base = "l4";
    EXPECT_THAT(errorOf("odd_axes.urdf", options),
                HasSubstr("odd_axes.urdf:5: <link name=\"l1\">: it is not behind the base link"));
    options.base = "l1";
    EXPECT_THAT(errorOf("odd_axes.urdf", options), HasSubstr("no joint turns"));
}

TEST(Refusal, NamesMissingLimitsByLine) {
    const std::string limit = "<limit lower=\"-2\" upper=\"2.5\" velocity=\"2\" effort=\"10\"/>";
    EXPECT_THAT(errorAfter("odd_axes.urdf", limit, "\n"),
                HasSubstr("odd_axes.urdf:18: <joint name=\"oblique\">: joint \"oblique\" has no "
                          "range (lower 0, upper 0)"));
    EXPECT_THAT(errorAfter("odd_axes.urdf", limit, "<limit lower=\"-1\" upper=\"1\"/>"),
                HasSubstr("odd_axes.urdf:23: <limit>: joint \"oblique\" has no velocity limit"));
    EXPECT_THAT(
        errorAfter("odd_axes.urdf", limit, "<limit lower=\"2\" upper=\"1\" velocity=\"1\"/>"),
        HasSubstr("odd_axes.urdf:23: <limit>: joint \"oblique\" has no range"));
    ImportOptions options;
    options.velocity = {1};
    options.position = {-1, 1};
    EXPECT_EQ(errorAfter("odd_axes.urdf", limit, "", options), "was accepted");
}

TEST(Refusal, NamesWrongNumbersByLine) {
    EXPECT_THAT(errorAfter("odd_axes.urdf", "0 0 0.25", "0 0 0.25 1"),
                HasSubstr("odd_axes.urdf:19: <origin>: xyz=\"0 0 0.25 1\" is not three numbers"));
    EXPECT_THAT(errorAfter("odd_axes.urdf", "1 1 0", "1 1 nan"),
                HasSubstr("odd_axes.urdf:22: <axis>"));
    EXPECT_THAT(
        errorAfter("odd_axes.urdf", "1 1 0", "0 0 0"),
        HasSubstr("odd_axes.urdf:22: <axis>: the axis of joint \"oblique\" has no direction"));
    EXPECT_THAT(errorAfter("odd_axes.urdf", "upper=\"2.5\"", "upper=\"${pi}\""),
                HasSubstr("odd_axes.urdf:23: <limit>: upper=\"${pi}\" is no finite number"));
    EXPECT_THAT(errorAfter("shapes.urdf", "radius=\"0.1\"", "radius=\"thick\""),
                HasSubstr("shapes.urdf:10: <cylinder>: radius=\"thick\" is no finite number"));
    EXPECT_THAT(errorAfter("shapes.urdf", "radius=\"0.1\"", ""),
                HasSubstr("shapes.urdf:10: <cylinder>: no radius"));
    EXPECT_THAT(errorAfter("shapes.urdf", "radius=\"0.1\"", "radius=\"1e5\""),
                HasSubstr("shapes.urdf:10: <cylinder>: radius of 100000 m, at most 10000 m"));
    EXPECT_THAT(errorAfter("shapes.urdf", "0.06 0.08 0.4", "0.06 0.08"),
                HasSubstr("shapes.urdf:34: <box>: size=\"0.06 0.08\" is not three numbers"));
}

TEST(Refusal, ReportsAllErrorsInTheOrderOfTheFile) {
    auto source = sourceFile("odd_axes.urdf");
    for (const char* axis : {"0 -3 4", "1 1 0"}) {
        source.text.replace(source.text.find(axis), std::string(axis).size(), "0 0 0");
    }
    const auto robot = importUrdf(source, std::nullopt, {});
    ASSERT_FALSE(robot);
    EXPECT_EQ(robot.error().message,
              "odd_axes.urdf:22: <axis>: the axis of joint \"oblique\" has no direction\n"
              "odd_axes.urdf:34: <axis>: the axis of joint \"without_origin\" has no direction");
}

TEST(Refusal, OfXacroNamesTheCommandThatExpandsIt) {
    EXPECT_THAT(errorAfter("odd_axes.urdf", "<link name=\"base\"/>",
                           "<xacro:include filename=\"a.xacro\"/>"),
                HasSubstr("odd_axes.urdf:4: it is an xacro file; this expands it: "
                          "xacro odd_axes.urdf > odd_axes_expanded.urdf"));
    auto source = sourceFile("odd_axes.urdf");
    source.name = "robots/arm.urdf.xacro";
    EXPECT_THAT(importUrdf(source, std::nullopt, {}).error().message,
                HasSubstr("xacro robots/arm.urdf.xacro > arm.urdf"));
}

TEST(Refusal, OfFilesThatAreNoTreeOfLinks) {
    const auto errorWith = [](const std::string& text) {
        const auto robot = importUrdf({"a.urdf", text}, std::nullopt, {});
        return robot ? "was accepted" : robot.error().message;
    };
    const std::string links = "<robot name=\"a\"><link name=\"a\"/>\n<link name=\"b\"/>\n";
    const std::string joint =
        "<joint name=\"j\" type=\"revolute\"><parent link=\"a\"/><child link=\"b\"/>"
        "<limit lower=\"-1\" upper=\"1\" velocity=\"1\"/></joint>\n";
    EXPECT_EQ(errorWith(links + joint + "</robot>"), "was accepted");
    EXPECT_THAT(errorWith(""), HasSubstr("a.urdf:1: no XML"));
    EXPECT_THAT(errorWith("<robot>\n<link></robot>"), HasSubstr("a.urdf:2: no XML"));
    EXPECT_THAT(errorWith("<sdf/>"), HasSubstr("a.urdf:1: <sdf>: no URDF file"));
    EXPECT_THAT(errorWith("<robot/>"), HasSubstr("it has no link"));
    EXPECT_THAT(errorWith(links + "</robot>"),
                HasSubstr("a.urdf:2: <link name=\"b\">: one of 2 links without a parent"));
    EXPECT_THAT(errorWith("<robot><link name=\"a\"/></robot>"), HasSubstr("no joint behind"));
    EXPECT_THAT(errorWith(links + "<link name=\"b\"/>" + joint + "</robot>"),
                HasSubstr("a.urdf:3: <link name=\"b\">: a second link of this name"));
    EXPECT_THAT(errorWith(links + joint + joint + "</robot>"),
                AllOf(HasSubstr("a.urdf:4: <joint name=\"j\">: a second joint of this name"),
                      HasSubstr("closed kinematic chains")));
    EXPECT_THAT(errorWith(links + "<joint name=\"j\"><parent link=\"a\"/></joint></robot>"),
                AllOf(HasSubstr("no type"), HasSubstr("no <child>")));
    EXPECT_THAT(errorWith(links + "<joint name=\"j\" type=\"fixed\"><parent link=\"a\"/>"
                                  "<child link=\"c\"/></joint></robot>"),
                HasSubstr("its child link \"c\" is not in the file"));
    EXPECT_THAT(errorWith(links + joint +
                          "<joint name=\"k\" type=\"fixed\"><parent link=\"b\"/>"
                          "<child link=\"a\"/></joint></robot>"),
                HasSubstr("a.urdf:1: <link name=\"a\">: it is in a ring of joints"));
    EXPECT_THAT(errorWith("<robot name=\"\xff\"/>"), HasSubstr("not UTF-8"));
    EXPECT_THAT(errorWith(std::string((16U << 20U) + 1, ' ')),
                HasSubstr("16777217 bytes, at most"));
}

TEST(Refusal, OfMoreAxesThanAModelCanHave) {
    std::mt19937_64 random(6);
    const auto urdf = randomUrdf(random, {.axes = 8, .fixed = 0});
    const auto robot = importUrdf({"long.urdf", urdf}, std::nullopt, {});
    ASSERT_FALSE(robot);
    EXPECT_THAT(robot.error().message, HasSubstr("axis 8 of 8, at most 7: choose a part"));
}

TEST(ImportedModel, TakesAnyNames) {
    auto source = sourceFile("odd_axes.urdf");
    const std::string name = "name=\"odd_axes\"";
    source.text.replace(source.text.find(name), name.size(),
                        "name=\"a&quot;b\\&#10;name = 3 &#228; &#127;\"");
    source.name = "odd\naxes = 1.urdf";
    const auto robot = importUrdf(source, std::nullopt, {});
    ASSERT_TRUE(robot) << robot.error().message;
    EXPECT_EQ(robot->model.name(), "a\"b\\\nname = 3 \xc3\xa4 \x7f");
}

}  // namespace
}  // namespace metier::robot_files
