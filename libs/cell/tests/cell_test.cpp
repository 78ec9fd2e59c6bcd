#include "metier/cell/cell.hpp"

#include <gmock/gmock.h>

#include <fstream>

namespace metier::cell {
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

TEST_F(CellFile, ListsNodesetsOfAnyKindOfServer) {
    std::ofstream(folder_ / "line.xml") << "<UANodeSet/>";
    const auto cell = load(R"(
name = "demo"
[[server]]
name = "ur5"
kind = "arm"
driver = { type = "ur", controller = "10.0.0.5" }
model = "ur5.toml"
skills = []
[[server]]
name = "ur5-move"
kind = "move"
robot = "ur5"
nodesets = ["line.xml"]
)");
    ASSERT_TRUE(cell) << cell.error().message;
    EXPECT_TRUE(cell->servers[0].nodesets.empty());
    EXPECT_THAT(cell->servers[1].nodesets, ElementsAre(folder_ / "line.xml"));
}

TEST_F(CellFile, NamesANodesetThatIsNotThere) {
    const auto cell = load(R"(
name = "demo"
[[server]]
name = "move"
kind = "move"
robot = "opc.tcp://127.0.0.1:4840"
nodesets = ["none.xml"]
)");
    ASSERT_FALSE(cell);
    EXPECT_THAT(cell.error().message, HasSubstr("cell.toml:7: server[0].nodesets: no such file"));
}

TEST_F(CellFile, DescribesEachServer) {
    const auto cell = load(R"(
name = "demo"
[[server]]
name = "ur5"
kind = "arm"
driver = { type = "ur", controller = "10.0.0.5" }
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
    EXPECT_EQ(arm->as<ArmServer>()->model, folder_ / "ur5.toml");
    EXPECT_THAT(arm->as<ArmServer>()->skills, ElementsAre("PositionStreamSkill"));
    EXPECT_EQ(cell->find("ur5-move")->as<MoveComponent>()->robot, "ur5");
    EXPECT_EQ(cell->find("other"), nullptr);
}

/// Two arms, one behind a virtual controller, with a component and two arms moved together.
constexpr const char* kVirtualCell = R"(
name = "demo"
[[server]]
name = "ur5"
kind = "arm"
driver = { type = "ur", controller = "controller" }
model = "ur5.toml"
skills = ["PositionStreamSkill"]
[[server]]
name = "other"
kind = "arm"
driver = { type = "simulator" }
model = "ur5.toml"
skills = ["PositionStreamSkill"]
[[server]]
name = "ur5-move"
kind = "move"
robot = "ur5"
[[server]]
name = "both"
kind = "synchronized"
servers = ["ur5-move", "other"]
[[virtual]]
name = "controller"
type = "ur"
address = "127.0.1.1"
model = "ur5.toml"
)";

TEST_F(CellFile, TellsThatNothingOfItIsReal) {
    const auto cell = load(kVirtualCell);
    ASSERT_TRUE(cell) << cell.error().message;
    EXPECT_TRUE(cell->isVirtual());
}

TEST_F(CellFile, TellsThatSomethingOfItMayBeReal) {
    const std::vector<std::pair<std::string, std::string>> changes{
        {R"(controller = "controller")", R"(controller = "10.0.0.5")"},
        {R"(robot = "ur5")", R"(robot = "opc.tcp://127.0.0.1:4840")"},
        {R"(robot = "ur5")", "robot = \"discover\"\nmdns = true"},
        {R"(["ur5-move", "other"])", R"(["ur5-move", "opc.tcp://127.0.0.1:4840"])"},
        {R"({ type = "simulator" })",
         "{ type = \"simulator\" }\n"
         "force_torque_sensor = { type = \"netft\", controller = \"10.0.0.6\" }"},
    };
    for (const auto& [what, by] : changes) {
        std::string text = kVirtualCell;
        text.replace(text.find(what), what.size(), by);
        const auto cell = load(text);
        ASSERT_TRUE(cell) << cell.error().message;
        EXPECT_FALSE(cell->isVirtual()) << by;
    }
}

TEST_F(CellFile, GivesAnArmToolsAndSkillsOfItsOwn) {
    std::ofstream(folder_ / "pick.toml") << "\n";
    const auto cell = load(R"(
name = "demo"
[[server]]
name = "ur5"
kind = "arm"
driver = { type = "ur", controller = "10.0.0.5" }
model = "ur5.toml"
skills = ["PositionStreamSkill"]
tool = [{ name = "jaws", frame = [0, 0, 0.2, 0, 0, 0.5], mass = 1.2 }]
compositions = ["pick.toml"]
)");
    ASSERT_TRUE(cell) << cell.error().message;
    const auto& server = cell->servers.front();
    const auto* arm = server.as<ArmServer>();
    ASSERT_NE(arm, nullptr);
    ASSERT_EQ(arm->tools.size(), 1U);
    EXPECT_EQ(arm->tools[0].name, "jaws");
    EXPECT_THAT(arm->tools[0].frame, ElementsAre(0, 0, 0.2, 0, 0, 0.5));
    EXPECT_EQ(arm->tools[0].mass, 1.2);
    EXPECT_THAT(arm->compositions, ElementsAre(folder_ / "pick.toml"));
}

TEST_F(CellFile, NamesWhatIsWrongWithAToolAndACompositionOfAnArm) {
    const auto cell = load(R"(
name = "demo"
[[server]]
name = "ur5"
kind = "arm"
driver = { type = "ur", controller = "10.0.0.5" }
model = "ur5.toml"
skills = ["PositionStreamSkill"]
tool = [{ name = "jaws", frame = [0, 0, 0.2] }]
compositions = ["none.toml"]
)");
    ASSERT_FALSE(cell);
    EXPECT_THAT(cell.error().message, HasSubstr("frame: has 3 numbers; needs 6"));
    EXPECT_THAT(cell.error().message, HasSubstr("no such file"));
}

TEST_F(CellFile, NamesLineAndKeyOfAnUnknownKind) {
    const auto cell = load("name = \"a\"\n[[server]]\nname = \"x\"\nkind = \"lathe\"\n");
    ASSERT_FALSE(cell);
    EXPECT_THAT(
        cell.error().message,
        HasSubstr("cell.toml:4: server[0].kind: \"lathe\" is not one of: arm, gripper, move"));
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
driver = { type = "ur", controller = "10.0.0.5" }
model = "none.toml"
nodeset = "iiwa"
skills = []
)");
    ASSERT_FALSE(cell);
    EXPECT_THAT(cell.error().message, HasSubstr("cell.toml:5: server[0].robot: \"nobody\""));
    EXPECT_THAT(cell.error().message, HasSubstr("cell.toml:7: server[1].name: \"m\" is taken"));
    EXPECT_THAT(cell.error().message, HasSubstr("cell.toml:10: server[1].model: no such file"));
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
driver = { type = "ur", controller = "10.0.0.5" }
model = "none.toml"
nodeset = "iiwa"
skills = []
stream_silence = 5.0
)");
    ASSERT_FALSE(cell);
    EXPECT_THAT(cell.error().message,
                HasSubstr("cell.toml:9: server[0].stream_silence: 5 is not within 0.02 to 2 s"));
}

TEST_F(CellFile, TellsHowLongAServersThreadMayHang) {
    const auto cell = [this](const std::string& line) {
        return load(
            "name = \"a\"\n[[server]]\nname = \"m\"\nkind = \"move\"\n"
            "robot = \"opc.tcp://127.0.0.1:4840\"\n" +
            line);
    };
    EXPECT_DOUBLE_EQ(cell("").value().servers[0].stall_limit, 0.25);
    EXPECT_DOUBLE_EQ(cell("stall_limit = 1.0\n").value().servers[0].stall_limit, 1.0);
    const auto refused = cell("stall_limit = 0.01\n");
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message,
                HasSubstr("server[0].stall_limit: 0.01 is not within 0.1 to 2 s"));
}

TEST_F(CellFile, DescribesDevicesAndTheirVirtualControllers) {
    const auto cell = load(R"(name = "a"
[[virtual]]
name = "robot"
type = "ur"
address = "127.0.1.1"
model = "ur5.toml"
powered = false
[[virtual]]
name = "cell"
type = "world"
address = "127.0.1.2"
[virtual.part]
cube = [0, 0, 0.1, 0.03, 0.03, 0.03, 0.1]
[[server]]
name = "gripper"
kind = "gripper"
driver = { type = "wsg50", controller = "10.0.0.7", port = 41000 }
nodeset = "wsg50"
skills = ["GraspGripperSkill"]
)");
    ASSERT_TRUE(cell) << cell.error().message;
    const auto* robot = cell->findVirtual("robot");
    ASSERT_NE(robot, nullptr);
    EXPECT_EQ(robot->type, "ur");
    EXPECT_EQ(robot->model, folder_ / "ur5.toml");
    EXPECT_FALSE(robot->settings.flagOr("powered", true));
    ASSERT_NE(cell->world(), nullptr);
    EXPECT_THAT(cell->world()->settings.namesUnder("part"), ElementsAre("cube"));
    const auto& driver = *cell->find("gripper")->driver();
    EXPECT_EQ(driver.type, "wsg50");
    EXPECT_EQ(driver.controller, "10.0.0.7");
    EXPECT_EQ(driver.settings.numberOr("port", 1000, 1, 65535), 41000);
}

TEST_F(CellFile, RefusesTwoVirtualControllersAtOneAddress) {
    const auto cell = load(R"(name = "a"
[[virtual]]
name = "one"
type = "ur"
[[virtual]]
name = "two"
type = "edo"
)");
    ASSERT_FALSE(cell);
    EXPECT_THAT(cell.error().message, HasSubstr("virtual[1].address: 127.0.0.1 is taken"));
}

TEST_F(CellFile, TellsThePlaceOfASettingThatIsWrong) {
    const auto cell = load(R"(name = "a"
[[virtual]]
name = "one"
type = "ur"
speed = "fast"
)");
    ASSERT_TRUE(cell);
    const auto& settings = cell->virtual_controllers.front().settings;
    settings.numberOr("speed", 1, 0, 2);
    EXPECT_THAT(settings.finish().error().message,
                HasSubstr("cell.toml:2: virtual[0].speed: is not a number"));
}

TEST_F(CellFile, NeedsAServer) {
    const auto cell = load("name = \"empty\"\n");
    ASSERT_FALSE(cell);
    EXPECT_THAT(cell.error().message, HasSubstr("at least one [[server]]"));
}

TEST(ComposedCellFile, DescribesServersOfComposedSkills) {
    const auto folder = std::filesystem::path(::testing::TempDir()) / "composed_cell";
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "skill.toml") << "name = 'X'\n";
    const auto load = [&](const std::string& servers) {
        std::ofstream(folder / "cell.toml") << R"(name = "cell"
[[server]]
name = "inner"
kind = "composition"
compositions = ["skill.toml"]
servers = [)" << servers << R"(]
[[server]]
name = "outer"
kind = "composition"
compositions = ["skill.toml"]
servers = ["inner", "opc.tcp://127.0.0.1:4840"]
)";
        return loadCell(folder / "cell.toml");
    };
    const auto cell = load("");
    ASSERT_TRUE(cell) << cell.error().message;
    const auto* outer = cell->servers[1].as<CompositionServer>();
    ASSERT_NE(outer, nullptr);
    EXPECT_EQ(outer->files.front(), folder / "skill.toml");
    EXPECT_EQ(outer->servers.size(), 2U);
    const auto around = load("\"outer\"");
    ASSERT_FALSE(around);
    EXPECT_NE(around.error().message.find("server[0].servers: \"outer\" is neither"),
              std::string::npos)
        << around.error().message;
}

/// A component with `force` as its [[server.force]], and one of its compositions.
Result<CellConfig> cellWithForce(const std::string& force) {
    const auto folder = std::filesystem::path(::testing::TempDir()) / "cell_with_force";
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "skill.toml") << "name = 'X'\n";
    std::ofstream(folder / "cell.toml") << R"(name = "cell"
[[server]]
name = "press"
kind = "composition"
compositions = ["skill.toml"]
servers = ["opc.tcp://127.0.0.1:4840", "opc.tcp://127.0.0.1:4841"]
[[server.force]]
name = "contact"
server = "opc.tcp://127.0.0.1:4840"
)" << force;
    return loadCell(folder / "cell.toml");
}

TEST(Cell, HasForcesAtWhichSkillsEnd) {
    const auto forces = [](const std::string& force) {
        const auto cell = cellWithForce(force);
        EXPECT_TRUE(cell) << cell.error().message;
        return cell ? cell->servers[0].as<CompositionServer>()->forces : std::vector<Force>(1);
    };
    const auto of_arm = forces("").front();
    EXPECT_EQ(of_arm.name, "contact");
    EXPECT_EQ(of_arm.server, "opc.tcp://127.0.0.1:4840");
    EXPECT_EQ(of_arm.arm, of_arm.server) << "FlangeForce has the axes of that arm's flange";
    const auto other = forces("variable = \"ns=2;s=F\"\ntorque = \"ns=2;s=T\"\n").front();
    EXPECT_EQ(other.variable, "ns=2;s=F");
    EXPECT_EQ(other.torque, "ns=2;s=T");
    EXPECT_EQ(other.arm, "") << "along the axes of the base frame";
    const auto turned =
        forces("variable = \"ns=2;s=F\"\narm = \"opc.tcp://127.0.0.1:4841\"\npose = \"i=7\"\n")
            .front();
    EXPECT_EQ(turned.arm, "opc.tcp://127.0.0.1:4841");
    EXPECT_EQ(turned.pose, "i=7");
}

TEST(Cell, RefusesForcesThatLeadNowhere) {
    for (const auto& [force, why] :
         {std::pair{"arm = \"iiwa\"\n", "server[0].force[0].arm: \"iiwa\" is none of \"servers\""},
          std::pair{"torque = \"ns=2;s=T\"\n", "torque: is for a force with a \"variable\""},
          std::pair{"variable = \"ns=2;s=F\"\npose = \"i=7\"\n", "pose: is of an \"arm\""},
          std::pair{"[[server.force]]\nname = \"contact\"\nserver = \"opc.tcp://127.0.0.1:4841\"\n",
                    "server[0].force[1].name: \"contact\" is there twice"}}) {
        const auto cell = cellWithForce(force);
        ASSERT_FALSE(cell) << force;
        EXPECT_NE(cell.error().message.find(why), std::string::npos) << cell.error().message;
    }
}

Result<CellConfig> cellOfTwo(const std::string& synchronized) {
    return parseCell(R"(name = "cell"
[[server]]
name = "left"
kind = "move"
robot = "opc.tcp://127.0.0.1:4840"
[[server]]
name = "hand"
kind = "gripper"
driver = { type = "wsg50", controller = "10.0.0.7" }
nodeset = "wsg50"
skills = ["GraspGripperSkill"]
[[server]]
name = "both"
kind = "synchronized"
)" + synchronized,
                     "cell.toml");
}

TEST(SynchronizedCellFile, DescribesTheArmsThatAreMovedTogether) {
    const auto cell = cellOfTwo("servers = [\"left\", \"opc.tcp://10.0.0.2:4840\"]\n");
    ASSERT_TRUE(cell) << cell.error().message;
    const auto& both = cell->servers[2];
    ASSERT_NE(both.as<SynchronizedServer>(), nullptr);
    EXPECT_EQ(both.usedServers()[0].name, "left");
    EXPECT_EQ(both.usedServers()[1].url, "opc.tcp://10.0.0.2:4840");
    EXPECT_EQ(both.as<SynchronizedServer>()->start_delay, 0.5);
}

TEST(SynchronizedCellFile, NeedsTwoArmsWithMovesAndATimeToTellThem) {
    const auto text = [](const std::string& keys) {
        const auto cell = cellOfTwo(keys);
        return cell ? std::string("accepted") : cell.error().message;
    };
    EXPECT_THAT(text("servers = [\"left\"]\n"),
                HasSubstr("server[2].servers: needs at least two arms"));
    EXPECT_THAT(text("servers = [\"left\", \"left\"]\n"),
                HasSubstr("server[2].servers: \"left\" is there twice"));
    EXPECT_THAT(text("servers = [\"left\", \"hand\"]\n"),
                HasSubstr("server[2].servers: \"hand\" is neither a server of kind arm or move"));
    EXPECT_THAT(text("servers = [\"left\", \"opc.tcp://10.0.0.2:4840\"]\nstart_delay = 0.01\n"),
                HasSubstr("server[2].start_delay: 0.01 is not within 0.05 to 30 s"));
}

TEST_F(CellFile, SaysWhereItsServersRegister) {
    const auto cell = load(R"(
name = "demo"
discovery = "opc.tcp://lds:4840"
discovery_period = 5
[[server]]
name = "near"
kind = "move"
robot = "opc.tcp://arm:4840"
[[server]]
name = "far"
kind = "move"
robot = "opc.tcp://arm:4840"
discovery = ["opc.tcp://a:4840", "opc.tcp://b:4840"]
discovery_period = 60
announce_as = "robots.example"
mdns = true
[[server]]
name = "hidden"
kind = "move"
robot = "opc.tcp://arm:4840"
discovery = []
)");
    ASSERT_TRUE(cell) << cell.error().message;
    const auto& near = cell->find("near")->discovery;
    EXPECT_THAT(near.servers, ElementsAre("opc.tcp://lds:4840"));
    EXPECT_EQ(near.period, 5.0);
    EXPECT_FALSE(near.mdns);
    const auto& far = cell->find("far")->discovery;
    EXPECT_THAT(far.servers, ElementsAre("opc.tcp://a:4840", "opc.tcp://b:4840"));
    EXPECT_EQ(far.period, 60.0);
    EXPECT_TRUE(far.mdns);
    EXPECT_EQ(far.announce_as, "robots.example");
    EXPECT_FALSE(cell->find("hidden")->discovery.enabled());
}

TEST_F(CellFile, TellsWhatIsWrongWithItsDiscovery) {
    const auto cell = load(R"(
name = "demo"
discovery = "lds:4840"
discovery_period = 1000
announce_as = "opc.tcp://host:1"
[[server]]
name = "discover"
kind = "move"
robot = "opc.tcp://arm:4840"
)");
    ASSERT_FALSE(cell);
    EXPECT_THAT(cell.error().message, HasSubstr(":3: discovery: \"lds:4840\" is no opc.tcp://"));
    EXPECT_THAT(cell.error().message, HasSubstr(":4: discovery_period: 1000 is not within"));
    EXPECT_THAT(cell.error().message, HasSubstr(":5: announce_as: "));
    EXPECT_THAT(cell.error().message, HasSubstr("server[0].name: \"discover\" means"));
}

TEST_F(CellFile, LetsACompositionUseWhateverItFinds) {
    std::ofstream(folder_ / "skill.toml") << "\n";
    const auto cell = load(R"(
name = "demo"
discovery = "opc.tcp://lds:4840"
[[server]]
name = "found"
kind = "composition"
compositions = ["skill.toml"]
servers = "discover"
rebind_after = 3
[[server]]
name = "both"
kind = "composition"
compositions = ["skill.toml"]
servers = ["found", "discover"]
)");
    ASSERT_TRUE(cell) << cell.error().message;
    const auto& found = std::get<CompositionServer>(cell->servers[0].kind);
    EXPECT_TRUE(found.discover);
    EXPECT_TRUE(found.servers.empty());
    EXPECT_EQ(found.rebind_after, 3.0);
    const auto& both = std::get<CompositionServer>(cell->servers[1].kind);
    EXPECT_TRUE(both.discover);
    EXPECT_EQ(both.servers.size(), 1U);
}

TEST_F(CellFile, LetsAMoveComponentMoveWhateverRobotItFinds) {
    const auto cell = load(R"(
name = "demo"
discovery = "opc.tcp://lds:4840"
[[server]]
name = "any"
kind = "move"
robot = "discover"
reach = 0.6
payload = 1.0
rebind_after = 3
)");
    ASSERT_TRUE(cell) << cell.error().message;
    const auto& move = std::get<MoveComponent>(cell->servers[0].kind);
    EXPECT_TRUE(move.discover);
    EXPECT_EQ(move.robot, "");
    EXPECT_EQ(move.reach, 0.6);
    EXPECT_EQ(move.payload, 1.0);
    EXPECT_EQ(move.rebind_after, 3.0);
}

TEST_F(CellFile, TakesWishesForARobotOnlyWhereItIsSought) {
    const auto cell = load(R"(
name = "demo"
[[server]]
name = "fixed"
kind = "move"
robot = "opc.tcp://arm:4840"
reach = 0.6
[[server]]
name = "any"
kind = "move"
robot = "discover"
reach = -1.0
)");
    ASSERT_FALSE(cell);
    EXPECT_THAT(cell.error().message, HasSubstr("server[0].reach: unknown key"));
    EXPECT_THAT(cell.error().message, HasSubstr("server[1].robot: \"discover\" needs"));
    EXPECT_THAT(cell.error().message, HasSubstr("server[1].reach: -1 m is under 0 m"));
}

TEST_F(CellFile, GivesAMoveComponentTheModelOfARobotThatPublishesNone) {
    std::ofstream(folder_ / "arm.toml") << "\n";
    const auto cell = load(R"(
name = "demo"
[[server]]
name = "move"
kind = "move"
robot = "opc.tcp://arm:4840"
model = "arm.toml"
axes = ["elbow", "base"]
controller = "Left"
device = "LeftArm"
)");
    ASSERT_TRUE(cell) << cell.error().message;
    const auto& move = std::get<MoveComponent>(cell->servers[0].kind);
    EXPECT_EQ(move.model, folder_ / "arm.toml");
    EXPECT_THAT(move.axes, ElementsAre("elbow", "base"));
    EXPECT_EQ(move.controller, "Left");
    EXPECT_EQ(move.device, "LeftArm");
}

TEST_F(CellFile, TakesAModelOnlyOfAKnownRobotAndAnOrderOnlyOfAModel) {
    std::ofstream(folder_ / "arm.toml") << "\n";
    const auto cell = load(R"(
name = "demo"
discovery = "opc.tcp://lds:4840"
[[server]]
name = "any"
kind = "move"
robot = "discover"
model = "arm.toml"
[[server]]
name = "move"
kind = "move"
robot = "opc.tcp://arm:4840"
axes = ["elbow", "base"]
device = "LeftArm"
)");
    ASSERT_FALSE(cell);
    EXPECT_THAT(cell.error().message, HasSubstr("server[0].model: unknown key"));
    EXPECT_THAT(cell.error().message, HasSubstr("server[1].axes: is the order of the joints"));
    EXPECT_THAT(cell.error().message, HasSubstr("server[1].device: is of a robot with a"));
}

TEST_F(CellFile, RefusesToDiscoverWithoutAnybodyToAsk) {
    std::ofstream(folder_ / "skill.toml") << "\n";
    const auto cell = load(R"(
name = "demo"
[[server]]
name = "found"
kind = "composition"
compositions = ["skill.toml"]
servers = "discover"
)");
    ASSERT_FALSE(cell);
    EXPECT_THAT(cell.error().message, HasSubstr("server[0].servers: \"discover\" needs"));
}

}  // namespace
}  // namespace metier::cell
