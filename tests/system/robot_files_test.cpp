// metier robot import and export as their users see them.
#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>
#include <iterator>

#include "metier_program.hpp"

namespace metier::system_tests {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kSuccess = 0;
constexpr int kUsage = 2;

/// The folder of the test, removed at its end.
class RobotCommand : public ::testing::Test {
protected:
    RobotCommand() { std::filesystem::create_directories(folder_); }
    ~RobotCommand() override { std::filesystem::remove_all(folder_); }

    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    static std::string source(const std::string& name) {
        return std::string(METIER_URDF_DIR) + "/" + name;
    }
    std::string textOf(const std::string& name) const {
        std::ifstream file(path(name));
        return {std::istreambuf_iterator<char>(file), {}};
    }

private:
    std::filesystem::path folder_ =
        std::filesystem::path(::testing::TempDir()) /
        ("robot_" + std::to_string(getpid()) + "_" +
         ::testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(RobotCommand, ImportsAModelThatOtherCommandsUse) {
    const auto model = path("arm.toml");
    const auto made =
        runMetier({"robot", "import", source("shapes.urdf"), "--srdf", source("shapes.srdf"), "-o",
                   model, "--maker", "Nobody", "--round-angles", "--acceleration", "3"});
    EXPECT_EQ(made.status, kSuccess) << made.output;
    EXPECT_THAT(made.output, AllOf(HasSubstr("6 axes from \"base_link\" to \"tool0\""),
                                   HasSubstr("planning: all moves can be planned"),
                                   HasSubstr("jerk of 50 rad/s3 of every axis"),
                                   Not(HasSubstr("acceleration of 5 rad/s2")),
                                   HasSubstr("<visual> with mesh (line 24)")));
    const auto line = runMetier(
        {"check", model, "--to-pose", "0,0,-0.05,0,0,0", "--relative", "base", "--linear"});
    EXPECT_EQ(line.status, kSuccess) << line.output;
    EXPECT_THAT(line.output, HasSubstr("possible"));
    const auto solved = runMetier({"ik", model, "0.5", "0", "0.5", "0", "3", "0"});
    EXPECT_THAT(solved.output, HasSubstr("8 solutions"));
}

TEST_F(RobotCommand, ExportsWhatItImportsAgain) {
    const auto exported =
        runMetier({"robot", "export", "ur5", "-o", path("ur5.urdf"), "--srdf", path("ur5.srdf")});
    EXPECT_EQ(exported.status, kSuccess) << exported.output;
    EXPECT_THAT(exported.output, HasSubstr("maker, product, cycle time"));
    const auto imported = runMetier(
        {"robot", "import", path("ur5.urdf"), "--srdf", path("ur5.srdf"), "-o", path("ur5.toml")});
    EXPECT_EQ(imported.status, kSuccess) << imported.output;
    const std::vector<std::string> joints{"0.3", "-1.2", "1.5", "0.1", "0.7", "-0.4"};
    std::vector<std::string> fk{"fk", "ur5"};
    fk.insert(fk.end(), joints.begin(), joints.end());
    const auto ours = runMetier(fk);
    fk[1] = path("ur5.toml");
    EXPECT_EQ(runMetier(fk).output, ours.output);
}

TEST_F(RobotCommand, WritesToStandardOutputAndRemarksToStandardError) {
    const auto model = runMetier({"robot", "import", source("odd_axes.urdf")}, Errors::left_out);
    EXPECT_EQ(model.status, kSuccess);
    EXPECT_THAT(model.output, AllOf(HasSubstr("[[joint]]"), Not(HasSubstr("planning:"))));
    const auto urdf = runMetier({"robot", "export", "edo"}, Errors::left_out);
    EXPECT_EQ(urdf.status, kSuccess);
    EXPECT_THAT(urdf.output, HasSubstr("</robot>"));
}

TEST_F(RobotCommand, OverwritesNothingUnasked) {
    std::ofstream(path("arm.toml")) << "mine";
    const auto refused =
        runMetier({"robot", "import", source("odd_axes.urdf"), "-o", path("arm.toml")});
    EXPECT_EQ(refused.status, kUsage);
    EXPECT_THAT(refused.output, HasSubstr("exists; --force writes over it"));
    EXPECT_EQ(textOf("arm.toml"), "mine");
    EXPECT_EQ(
        runMetier({"robot", "import", source("odd_axes.urdf"), "-o", path("arm.toml"), "--force"})
            .status,
        kSuccess);
    EXPECT_THAT(textOf("arm.toml"), HasSubstr("name = \"odd_axes\""));
}

TEST_F(RobotCommand, RefusesWithFileLineAndElement) {
    const auto arms = runMetier({"robot", "import", source("two_arms.urdf")});
    EXPECT_EQ(arms.status, kUsage);
    EXPECT_THAT(arms.output,
                HasSubstr("two_arms.urdf:15: <joint name=\"lift\">: its type is prismatic"));
    EXPECT_THAT(runMetier({"robot", "import", source("two_arms.urdf"), "--base", "torso", "--tip",
                           "left_hand"})
                    .output,
                HasSubstr("2 axes from \"torso\" to \"left_hand\""));
    std::ofstream(path("arm.xacro")) << "<robot><xacro:property name='a'/></robot>";
    const auto xacro = runMetier({"robot", "import", path("arm.xacro")});
    EXPECT_EQ(xacro.status, kUsage);
    EXPECT_THAT(xacro.output, HasSubstr("xacro " + path("arm.xacro") + " > arm.urdf"));
    EXPECT_EQ(runMetier({"robot", "import", "/nowhere.urdf"}).status, kUsage);
    EXPECT_EQ(runMetier({"robot", "import", source("odd_axes.urdf"), "--home", "1,2"}).status,
              kUsage);
}

}  // namespace
}  // namespace metier::system_tests
