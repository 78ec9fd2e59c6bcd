// Questions to a cell, whatever it was read from.
#include <gmock/gmock.h>

#include "metier/cell/cell.hpp"

namespace metier::cell {
namespace {

using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::IsEmpty;

DriverChoice driver(const std::string& controller) {
    return {.type = "ur", .controller = controller, .settings = {}};
}

template <typename Kind>
ServerConfig server(const std::string& name, std::uint16_t port, Kind kind) {
    ServerConfig config;
    config.name = name;
    config.address = "127.0.0.1";
    config.port = port;
    config.kind = std::move(kind);
    return config;
}

ArmServer armAt(const std::string& controller) {
    ArmServer arm;
    arm.driver = driver(controller);
    return arm;
}

GripperServer gripperAt(const std::string& controller) {
    GripperServer gripper;
    gripper.driver = driver(controller);
    return gripper;
}

/// An arm "ur5" at port 4841, behind a virtual controller "box".
CellConfig cellOfOneArm() {
    CellConfig cell;
    VirtualController box;
    box.name = "box";
    box.address = "127.0.1.7";
    cell.virtual_controllers.push_back(box);
    cell.servers.push_back(server("ur5", 4841, armAt("box")));
    return cell;
}

TEST(ResolvedServer, ReachesVirtualControllersAtTheirAddress) {
    auto cell = cellOfOneArm();
    auto arm = armAt("box");
    arm.force_torque_sensor = driver("box");
    const auto with_sensor = cell.resolved(server("ur5", 0, arm));
    EXPECT_EQ(with_sensor.driver()->controller, "127.0.1.7");
    EXPECT_EQ(with_sensor.as<ArmServer>()->force_torque_sensor->controller, "127.0.1.7");
    EXPECT_EQ(cell.resolved(server("hand", 0, gripperAt("box"))).driver()->controller, "127.0.1.7");
}

TEST(ResolvedServer, KeepsAddressesThatAreNoNamesOfTheCell) {
    const auto cell = cellOfOneArm();
    EXPECT_EQ(cell.resolved(server("other", 0, armAt("10.0.0.5"))).driver()->controller,
              "10.0.0.5");
    const MoveComponent elsewhere{.robot = "opc.tcp://arm:4840"};
    EXPECT_EQ(cell.resolved(server("move", 0, elsewhere)).as<MoveComponent>()->robot,
              "opc.tcp://arm:4840");
}

TEST(ResolvedServer, MovesTheRobotAtItsServersPort) {
    const auto move = cellOfOneArm().resolved(server("move", 0, MoveComponent{.robot = "ur5"}));
    EXPECT_EQ(move.as<MoveComponent>()->robot, "opc.tcp://127.0.0.1:4841");
}

TEST(ResolvedServer, UsesServersAtTheirPortUnlessAnAddressIsGiven) {
    const auto cell = cellOfOneArm();
    const std::vector<UsedServer> used{
        {"ur5", ""}, {"opc.tcp://far:1", "opc.tcp://far:1"}, {"nobody", ""}};
    const auto urls = [&](const ServerConfig& config) {
        const auto resolved = cell.resolved(config);
        const auto servers = resolved.usedServers();
        return std::vector<UsedServer>(servers.begin(), servers.end());
    };
    const auto expected =
        ElementsAre(Field(&UsedServer::url, "opc.tcp://127.0.0.1:4841"),
                    Field(&UsedServer::url, "opc.tcp://far:1"), Field(&UsedServer::url, ""));
    EXPECT_THAT(urls(server("composed", 0, CompositionServer{.files = {}, .servers = used})),
                expected);
    EXPECT_THAT(urls(server("both", 0, SynchronizedServer{.servers = used})), expected);
}

TEST(ResolvedServer, KeepsAnAddressThatWasGivenInsteadOfThatOfTheName) {
    const auto both = cellOfOneArm().resolved(
        server("both", 0, SynchronizedServer{.servers = {{"ur5", "opc.tcp://other:2"}}}));
    EXPECT_EQ(both.usedServers()[0].url, "opc.tcp://other:2");
}

TEST(ServerConfig, HasADriverOnlyWithADevice) {
    EXPECT_EQ(server("arm", 0, armAt("a")).driver()->controller, "a");
    EXPECT_EQ(server("hand", 0, gripperAt("b")).driver()->controller, "b");
    EXPECT_EQ(server("move", 0, MoveComponent{}).driver(), nullptr);
    EXPECT_EQ(server("composed", 0, CompositionServer{}).driver(), nullptr);
    EXPECT_EQ(server("both", 0, SynchronizedServer{}).driver(), nullptr);
}

TEST(ServerConfig, UsesOthersOnlyIfItIsMadeOfTheirSkills) {
    EXPECT_THAT(server("arm", 0, armAt("a")).usedServers(), IsEmpty());
    EXPECT_THAT(server("move", 0, MoveComponent{.robot = "ur5"}).usedServers(), IsEmpty());
}

TEST(CellConfig, IsVirtualAsLongAsNothingRealCanMove) {
    auto cell = cellOfOneArm();
    cell.servers.push_back(server("move", 0, MoveComponent{.robot = "ur5"}));
    cell.servers.push_back(server("both", 0, SynchronizedServer{.servers = {{"ur5", ""}}}));
    cell.servers.push_back(
        server("composed", 0, CompositionServer{.files = {}, .servers = {{"move", ""}}}));
    EXPECT_TRUE(cell.isVirtual());
    const std::vector<ServerConfig> real{
        server("one", 0, armAt("10.0.0.5")),
        server("one", 0, gripperAt("10.0.0.5")),
        server("one", 0, MoveComponent{.robot = "opc.tcp://arm:4840"}),
        server("one", 0, MoveComponent{.robot = "ur5", .discover = true}),
        server("one", 0, SynchronizedServer{.servers = {{"opc.tcp://arm:4840", ""}}}),
        server("one", 0, CompositionServer{.files = {}, .servers = {}, .discover = true})};
    for (const auto& one : real) {
        auto with_one = cell;
        with_one.servers.push_back(one);
        EXPECT_FALSE(with_one.isVirtual()) << with_one.servers.back().kind.index();
    }
}

}  // namespace
}  // namespace metier::cell
