#include "metier/configuration/cell.hpp"

#include <gmock/gmock.h>

#include <fstream>

namespace metier::configuration {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A folder of its own with a cell file and a model file, gone with the test.
class CellFile : public ::testing::Test {
protected:
    void SetUp() override {
        std::filesystem::create_directories(folder_);
        std::ofstream(folder_ / "ur5.toml") << "\n";
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    Result<CellConfig> load(std::string_view text) {
        std::ofstream(folder_ / "cell.toml") << text;
        return loadCell(folder_ / "cell.toml");
    }

    const std::filesystem::path folder_ =
        std::filesystem::path(::testing::TempDir()) /
        ::testing::UnitTest::GetInstance()->current_test_info()->name();
};

TEST_F(CellFile, DescribesEachServer) {
    const auto cell = load(R"(
name = "demo"
[[server]]
name = "ur5"
kind = "arm"
port = 4841
model = "ur5.toml"
nodeset = "universal_robots"
skills = ["PositionStreamSkill"]
[[server]]
name = "ur5-move"
kind = "move"
robot = "ur5"
)");
    ASSERT_TRUE(cell) << cell.error().message;
    ASSERT_EQ(cell->servers.size(), 2U);
    const auto* arm = cell->find("ur5");
    ASSERT_NE(arm, nullptr);
    EXPECT_EQ(arm->port, 4841);
    EXPECT_EQ(arm->address, "127.0.0.1");
    EXPECT_EQ(arm->arm.model, folder_ / "ur5.toml");
    EXPECT_THAT(arm->arm.skills, ElementsAre("PositionStreamSkill"));
    EXPECT_EQ(cell->find("ur5-move")->move.robot, "ur5");
    EXPECT_EQ(cell->find("other"), nullptr);
}

TEST_F(CellFile, NamesLineAndKeyOfAnUnknownKind) {
    const auto cell = load("name = \"a\"\n[[server]]\nname = \"x\"\nkind = \"lathe\"\n");
    ASSERT_FALSE(cell);
    EXPECT_THAT(cell.error().message,
                HasSubstr("cell.toml:4: server[0].kind: \"lathe\" is not one of: arm, move"));
}

TEST_F(CellFile, RefusesAComponentWithoutItsRobotAndNamesTakenTwice) {
    const auto cell = load(R"(name = "a"
[[server]]
name = "m"
kind = "move"
robot = "nobody"
[[server]]
name = "m"
kind = "arm"
model = "none.toml"
nodeset = "iiwa"
skills = []
)");
    ASSERT_FALSE(cell);
    EXPECT_THAT(cell.error().message, HasSubstr("cell.toml:5: server[0].robot: \"nobody\""));
    EXPECT_THAT(cell.error().message, HasSubstr("cell.toml:7: server[1].name: \"m\" is taken"));
    EXPECT_THAT(cell.error().message, HasSubstr("cell.toml:9: server[1].model: no such file"));
}

TEST_F(CellFile, RefusesAPortTakenTwiceAndOutOfRange) {
    const auto cell = load(R"(name = "a"
[[server]]
name = "m"
kind = "move"
robot = "opc.tcp://robot:4840"
port = 70000
)");
    ASSERT_FALSE(cell);
    EXPECT_THAT(cell.error().message, HasSubstr("server[0].port: 70000 is not within 0 to 65535"));
}

TEST_F(CellFile, RefusesASilenceOutOfRangeWithItsUnit) {
    const auto cell = load(R"(name = "a"
[[server]]
name = "m"
kind = "arm"
model = "none.toml"
nodeset = "iiwa"
skills = []
stream_silence = 5.0
)");
    ASSERT_FALSE(cell);
    EXPECT_THAT(cell.error().message,
                HasSubstr("cell.toml:8: server[0].stream_silence: 5 is not within 0.02 to 2 s"));
}

TEST_F(CellFile, NeedsAServer) {
    const auto cell = load("name = \"empty\"\n");
    ASSERT_FALSE(cell);
    EXPECT_THAT(cell.error().message, HasSubstr("at least one [[server]]"));
}

}  // namespace
}  // namespace metier::configuration
