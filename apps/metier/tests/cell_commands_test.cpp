#include "cell_commands.hpp"

#include <gmock/gmock.h>

namespace metier::app {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsSupersetOf;
using ::testing::Not;
using ::testing::StartsWith;

/// A cell in /cells/one.toml, and the commands of its processes.
class CommandsOfACell : public ::testing::Test {
protected:
    CommandsOfACell() { cell_.file = "/cells/one.toml"; }

    cell::VirtualController& addVirtual(const std::string& name, const std::string& type) {
        cell::VirtualController controller;
        controller.name = name;
        controller.type = type;
        return cell_.virtual_controllers.emplace_back(controller);
    }
    template <typename Kind>
    static cell::ServerConfig server(const std::string& name, Kind kind,
                                     std::uint16_t port = 4841) {
        cell::ServerConfig config;
        config.name = name;
        config.port = port;
        config.kind = std::move(kind);
        return config;
    }
    /// Words after the program.
    template <typename Process>
    std::vector<std::string> words(const Process& process, Ports ports = Ports::configured) const {
        const auto command = MetierCommands(cell_, ports, security_).of(process, known_);
        EXPECT_THAT(command.words.front(), StartsWith("/"));
        return {command.words.begin() + 1, command.words.end()};
    }

    cell::CellConfig cell_;
    server::CellAddresses known_;
    server::Security security_;
};

TEST_F(CommandsOfACell, ServeEachServerByItsName) {
    EXPECT_THAT(words(server("ur5", cell::ArmServer())),
                ElementsAre("serve", "/cells/one.toml", "--server", "ur5", "--lab-is-known"));
}

TEST_F(CommandsOfACell, HandOnHowConnectionsAreSecured) {
    security_ = {.insecure_lab = true, .folder = "/keys"};
    EXPECT_THAT(words(server("ur5", cell::ArmServer())),
                ElementsAre("--insecure-lab", "--security", "/keys", "serve", "/cells/one.toml",
                            "--server", "ur5", "--lab-is-known"));
}

TEST_F(CommandsOfACell, TakeFreePortsAndTheSameOnesAgain) {
    const auto ur5 = server("ur5", cell::ArmServer());
    const MetierCommands free(cell_, Ports::free, security_);
    EXPECT_THAT(free.of(ur5, known_).words, IsSupersetOf({"--port", "0", "--metrics", "off"}));
    EXPECT_EQ(free.of(ur5, known_).option_for_port, "--again-at");
    const MetierCommands configured(cell_, Ports::configured, security_);
    EXPECT_EQ(configured.of(ur5, known_).option_for_port, "");
    EXPECT_EQ(configured.of(server("any", cell::ArmServer(), 0), known_).option_for_port,
              "--again-at");
}

TEST_F(CommandsOfACell, NameTheAddressesOfDevices) {
    known_.controllers = {{"box", "127.1.2.3"}, {"feeler", "127.1.2.4"}};
    cell::ArmServer arm;
    arm.driver.controller = "box";
    arm.force_torque_sensor = cell::DriverChoice{"netft", "feeler", {}};
    EXPECT_THAT(words(server("ur5", arm)),
                IsSupersetOf({"--controller", "127.1.2.3", "--sensor", "127.1.2.4"}));
    arm.driver.controller = "10.0.0.5";
    EXPECT_THAT(words(server("ur5", arm)), Not(Contains("--controller")));
    cell::GripperServer hand;
    hand.driver.controller = "box";
    EXPECT_THAT(words(server("hand", hand)), IsSupersetOf({"--controller", "127.1.2.3"}));
}

TEST_F(CommandsOfACell, NameTheAddressesOfServersThatAreUsed) {
    known_.servers = {{"ur5", "opc.tcp://a:1"}, {"iiwa", "opc.tcp://b:2"}};
    EXPECT_THAT(words(server("move", cell::MoveComponent{.robot = "ur5"})),
                IsSupersetOf({"--robot", "opc.tcp://a:1"}));
    const std::vector<cell::UsedServer> used{
        {"ur5", ""}, {"opc.tcp://far:1", "opc.tcp://far:1"}, {"iiwa", ""}};
    EXPECT_THAT(words(server("both", cell::SynchronizedServer{.servers = used})),
                IsSupersetOf({"--use", "ur5=opc.tcp://a:1", "iiwa=opc.tcp://b:2"}));
    const auto composed = cell::CompositionServer{.files = {}, .servers = used};
    EXPECT_THAT(words(server("composed", composed)), Contains("ur5=opc.tcp://a:1"));
    EXPECT_THAT(words(server("composed", composed)), Not(Contains("opc.tcp://far:1")));
}

TEST_F(CommandsOfACell, RunVirtualControllersInTheirWorld) {
    addVirtual("box", "ur");
    EXPECT_THAT(words(cell_.virtual_controllers[0]),
                ElementsAre("virtual", "run", "/cells/one.toml", "box"));
    addVirtual("world", "world");
    known_.controllers = {{"world", "127.0.1.1"}};
    EXPECT_THAT(words(cell_.virtual_controllers[0]),
                ElementsAre("virtual", "run", "/cells/one.toml", "box", "--world", "127.0.1.1"));
    EXPECT_THAT(words(cell_.virtual_controllers[1]),
                ElementsAre("virtual", "run", "/cells/one.toml", "world"));
}

TEST_F(CommandsOfACell, RunVirtualControllersAtFreeAddresses) {
    addVirtual("box", "ur");
    const auto first = words(cell_.virtual_controllers[0], Ports::free);
    ASSERT_EQ(first.size(), 6U);
    EXPECT_EQ(first[4], "--address");
    EXPECT_THAT(first[5], StartsWith("127."));
    EXPECT_NE(words(cell_.virtual_controllers[0], Ports::free)[5], first[5]);
}

}  // namespace
}  // namespace metier::app
