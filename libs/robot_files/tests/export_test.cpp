#include "metier/robot_files/export.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <iterator>

#include "comparison.hpp"
#include "metier/robot_files/import.hpp"
#include "random_urdf.hpp"

namespace metier::robot_files {
namespace {

using motion::RobotModel;
using testing::Contains;
using testing::HasSubstr;

RobotModel loadModel(const std::string& name) {
    auto model = RobotModel::load(std::string(METIER_MODELS_DIR) + "/" + name + ".toml");
    if (!model) {
        throw std::runtime_error(model.error().message);
    }
    return std::move(*model);
}

ImportedRobot again(const RobotModel& model) {
    const auto exported = exportUrdf(model);
    auto robot =
        importUrdf({"again.urdf", exported.urdf}, SourceFile{"again.srdf", exported.srdf}, {});
    if (!robot) {
        throw std::runtime_error(robot.error().message + exported.urdf);
    }
    return std::move(*robot);
}

void expectSameLimits(const RobotModel& one, const RobotModel& other) {
    ASSERT_EQ(one.axisCount(), other.axisCount());
    for (std::size_t i = 0; i < one.axisCount(); ++i) {
        EXPECT_EQ(one.chain().joints[i].name, other.chain().joints[i].name);
        EXPECT_EQ(one.limits(i).lower, other.limits(i).lower);
        EXPECT_EQ(one.limits(i).upper, other.limits(i).upper);
        EXPECT_EQ(one.limits(i).velocity, other.limits(i).velocity);
        EXPECT_EQ(one.limits(i).acceleration, other.limits(i).acceleration);
        EXPECT_EQ(one.limits(i).jerk, other.limits(i).jerk);
    }
    EXPECT_EQ(one.home(), other.home());
}

void expectSameKinematics(const RobotModel& one, const RobotModel& other) {
    EXPECT_EQ(one.kinematics().ikKind(), other.kinematics().ikKind());
    std::mt19937_64 random(7);
    for (int i = 0; i < 200; ++i) {
        const auto q = anyPosition(one.axisCount(), random);
        const auto ours = one.kinematics().forwardAll(q);
        const auto theirs = other.kinematics().forwardAll(q);
        for (std::size_t frame = 0; frame <= one.axisCount(); ++frame) {
            ASSERT_LT(motion::distanceBetween(ours[frame], theirs[frame]), 1e-12) << frame;
            ASSERT_LT((ours[frame].rotation.conjugate() * theirs[frame].rotation).vec().norm(),
                      1e-12)
                << frame;
        }
    }
}

void expectSameShape(const RobotModel& one, const RobotModel& other) {
    ASSERT_EQ(one.capsules().size(), other.capsules().size());
    // Capsules of one link are together in an imported model.
    for (const auto& capsule : one.capsules()) {
        EXPECT_TRUE(std::any_of(
            other.capsules().begin(), other.capsules().end(), [&](const motion::Capsule& twin) {
                return twin.link == capsule.link && twin.radius == capsule.radius &&
                       (twin.from - capsule.from).norm() < 1e-12 &&
                       (twin.to - capsule.to).norm() < 1e-12;
            }));
    }
    EXPECT_EQ(one.visual().size(), other.visual().size());
    ASSERT_EQ(one.chain().tools.size(), other.chain().tools.size());
    for (const auto& tool : one.chain().tools) {
        const auto twin = other.tool(tool.name);
        ASSERT_TRUE(twin);
        EXPECT_LT(motion::distanceBetween(tool.flange_from_tool, twin->flange_from_tool), 1e-14);
    }
}

class ExportOf : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Robots, ExportOf,
                         testing::Values("ur5", "ur5e", "iiwa7", "iiwa14", "edo"));

TEST_P(ExportOf, IsImportedAsTheSameRobot) {
    const auto model = loadModel(GetParam());
    const auto robot = again(model);
    EXPECT_EQ(robot.model.name(), model.name());
    EXPECT_EQ(robot.tip, "tool0");
    expectSameKinematics(model, robot.model);
    expectSameLimits(model, robot.model);
    expectSameShape(model, robot.model);
}

TEST_P(ExportOf, HasTheForwardKinematicsOfKdl) {
    const auto model = loadModel(GetParam());
    KdlUrdf kdl(exportUrdf(model).urdf, "base_link", "tool0");
    const auto difference = differenceToKdl(model, kdl, 300);
    EXPECT_LT(difference.position, 1e-12);
    EXPECT_LT(difference.rotation, 1e-12);
}

TEST(ImportExportImport, GivesTheSameRobot) {
    for (const char* file : {"odd_axes", "fixed_between", "shapes"}) {
        const auto path = std::string(METIER_URDF_DIR) + "/" + file;
        const auto textOf = [&](const std::string& name) {
            std::ifstream stream(name);
            return std::string{std::istreambuf_iterator<char>(stream), {}};
        };
        std::optional<SourceFile> srdf;
        if (std::ifstream(path + ".srdf")) {
            srdf = SourceFile{"a.srdf", textOf(path + ".srdf")};
        }
        const auto first = importUrdf({"a.urdf", textOf(path + ".urdf")}, srdf, {});
        ASSERT_TRUE(first) << first.error().message;
        const auto second = again(first->model);
        expectSameKinematics(first->model, second.model);
        expectSameLimits(first->model, second.model);
        expectSameShape(first->model, second.model);
        const auto& visual = first->model.visual();
        for (std::size_t i = 0; i < visual.size(); ++i) {
            const auto& twin = second.model.visual()[i];
            EXPECT_EQ(visual[i].color, twin.color);
            EXPECT_EQ(visual[i].link, twin.link);
            EXPECT_LT((visual[i].from - twin.from).norm() + (visual[i].to - twin.to).norm(), 1e-12);
            EXPECT_EQ(visual[i].edge, twin.edge);
        }
        const auto& pairs = first->model.notCompared();
        ASSERT_EQ(pairs.size(), second.model.notCompared().size());
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            EXPECT_EQ(pairs[i].first, second.model.notCompared()[i].first);
            EXPECT_EQ(pairs[i].second, second.model.notCompared()[i].second);
        }
    }
}

TEST(ImportExportImport, GivesTheSameRandomRobots) {
    std::mt19937_64 random(8);
    for (int i = 0; i < 100; ++i) {
        const auto urdf = randomUrdf(random);
        const auto first = importUrdf({"random.urdf", urdf}, std::nullopt, {});
        ASSERT_TRUE(first) << first.error().message;
        const auto second = again(first->model);
        expectSameLimits(first->model, second.model);
        std::mt19937_64 positions(9);
        for (int k = 0; k < 20; ++k) {
            const auto q = anyPosition(first->model.axisCount(), positions);
            EXPECT_LT(motion::distanceBetween(first->model.kinematics().forward(q),
                                              second.model.kinematics().forward(q)),
                      1e-10)
                << urdf;
        }
    }
}

TEST(Export, SaysWhatItLeavesOut) {
    const auto exported = exportUrdf(loadModel("ur5"));
    EXPECT_THAT(exported.left_out,
                testing::AllOf(Contains(HasSubstr("maker, product, cycle time")),
                               Contains(HasSubstr("round edges and unequal radii of"))));
}

TEST(Export, WritesNamesThatNoTwoLinksShare) {
    auto chain = loadModel("edo").chain();
    chain.joints[1].name = chain.joints[0].name;
    chain.joints[2].name = "a<b>&\"c\"";
    chain.tools = {{"link_1", {}, 2.0}, {"tool0", {}, 0.0}};
    const auto model = RobotModel::fromChain(chain);
    ASSERT_TRUE(model) << model.error().message;
    const auto robot = again(*model);
    EXPECT_EQ(robot.model.chain().joints[1].name, chain.joints[0].name + "_");
    EXPECT_EQ(robot.model.chain().joints[2].name, "a<b>&\"c\"");
    EXPECT_EQ(robot.model.chain().tools.size(), 2U);
    EXPECT_THAT(exportUrdf(*model).left_out, Contains("the masses of 1 tools"));
}

}  // namespace
}  // namespace metier::robot_files
