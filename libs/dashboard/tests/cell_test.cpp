// A cell file as the page shows it, with the addresses that its servers really have.
#include "metier/dashboard/cell.hpp"

#include <gmock/gmock.h>

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

namespace metier::dashboard {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class EndpointsTest : public ::testing::Test {
protected:
    ~EndpointsTest() override { std::filesystem::remove(file_); }
    Result<Endpoints> load(const std::string& text) {
        std::ofstream(file_) << text;
        return loadEndpoints(file_);
    }

    const std::string file_ =
        std::string(::testing::TempDir()) + "endpoints_" + std::to_string(getpid()) + ".json";
};

TEST_F(EndpointsTest, AreReadByName) {
    const auto endpoints = load(R"({"servers":[{"name":"ur5","url":"opc.tcp://127.0.0.1:4841"}],
                                    "virtual":[{"name":"world","address":"127.0.1.9"}]})");
    ASSERT_TRUE(endpoints) << endpoints.error().message;
    EXPECT_EQ(endpoints->servers.at("ur5"), "opc.tcp://127.0.0.1:4841");
    EXPECT_EQ(endpoints->virtual_controllers.at("world"), "127.0.1.9");
}

TEST_F(EndpointsTest, ThatCannotBeReadNameTheirFile) {
    const auto missing = loadEndpoints(file_);
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().code, Errc::not_found);
    EXPECT_THAT(missing.error().message, HasSubstr(file_));
    for (const std::string text :
         {"", "{", "[]", "7", R"({"servers":[]})", R"({"servers":{},"virtual":[{}]})",
          R"({"servers":[{"name":"a"}],"virtual":[]})",
          R"({"servers":[{"name":"a","url":7}],"virtual":[]})", R"({"servers":[7],"virtual":[]})",
          R"({"servers":null,"virtual":{"a":"b"}})"}) {
        const auto broken = load(text);
        ASSERT_FALSE(broken) << text;
        EXPECT_EQ(broken.error().code, Errc::invalid_argument) << text;
        EXPECT_THAT(broken.error().message, HasSubstr(file_)) << text;
    }
}

/// An arm, the component that moves it, and its gripper, in a virtual world.
class ShownCell : public ::testing::Test {
protected:
    ShownCell() {
        config_.name = "test";
        config_.servers.resize(3);
        auto& arm = config_.servers[0];
        arm.name = "ur5";
        arm.address = "127.0.0.1";
        arm.port = 4840;
        cell::ArmServer of_arm;
        of_arm.driver = {"ur", "ur5-controller", {}};
        arm.kind = std::move(of_arm);
        auto& move = config_.servers[1];
        move.name = "ur5-move";
        move.kind = cell::MoveComponent{.robot = "ur5"};
        auto& gripper = config_.servers[2];
        gripper.name = "gripper";
        cell::GripperServer of_gripper;
        of_gripper.driver = {"wsg50", "wsg50-controller", {}};
        gripper.kind = std::move(of_gripper);
        world_.name = "world";
        world_.type = "world";
        world_.address = "127.0.1.1";
        world_.control_port = 7401;
    }
    /// With all settings of the world.
    Cell shown(const Endpoints& endpoints = {}) {
        config_.virtual_controllers = {world_};
        return cellFrom(config_, endpoints);
    }

    cell::CellConfig config_;
    cell::VirtualController world_;
};

TEST_F(ShownCell, HasTheAddressesOfItsFileUnlessOthersAreGiven) {
    const auto cell = shown();
    EXPECT_EQ(cell.name, "test");
    EXPECT_EQ(cell.servers.at(0).url, "opc.tcp://127.0.0.1:4840");
    ASSERT_TRUE(cell.world);
    EXPECT_EQ(cell.world->address, "127.0.1.1");
    EXPECT_EQ(cell.world->port, 7401);
    const auto moved =
        shown({{{"ur5", "opc.tcp://127.0.0.1:1"}, {"nobody", "x"}}, {{"world", "127.0.1.2"}}});
    EXPECT_EQ(moved.servers.at(0).url, "opc.tcp://127.0.0.1:1");
    EXPECT_EQ(moved.world->address, "127.0.1.2");
    EXPECT_EQ(moved.servers.size(), 3U);
}

TEST_F(ShownCell, LetsAMoveComponentMoveTheArmOfAnotherServer) {
    EXPECT_EQ(shown().servers.at(1).arm_of, "ur5");
    EXPECT_EQ(shown().servers.at(0).arm_of, "");
    config_.servers[1].kind = cell::MoveComponent{.robot = "opc.tcp://elsewhere:4840"};
    EXPECT_EQ(shown().servers.at(1).arm_of, "") << "of no server that is shown";
    EXPECT_THAT(shown().servers.at(1).uses, IsEmpty());
}

TEST_F(ShownCell, PlacesArmsAndGrippersAsItsWorldDoes) {
    EXPECT_EQ(shown().servers.at(0).world_from_base, Frame{}) << "an arm without a base";
    world_.settings.set("base.ur5-controller", std::vector<double>{1, 2, 3, 0, 0, 0.5});
    world_.settings.set("on.wsg50-controller", std::string("ur5-controller"));
    world_.settings.set("jaws.wsg50-controller", std::vector<double>{0, 0, 0.15, 0, 0, 0});
    const auto cell = shown();
    EXPECT_EQ(cell.servers.at(0).world_from_base, (Frame{1, 2, 3, 0, 0, 0.5}));
    EXPECT_FALSE(cell.servers.at(0).gripper);
    EXPECT_FALSE(cell.servers.at(1).world_from_base) << "it has no device";
    ASSERT_TRUE(cell.servers.at(2).gripper);
    EXPECT_EQ(cell.servers.at(2).gripper->on, "ur5");
    EXPECT_EQ(cell.servers.at(2).gripper->flange_from_jaws, (Frame{0, 0, 0.15, 0, 0, 0}));
    EXPECT_FALSE(cell.servers.at(2).world_from_base);
}

TEST_F(ShownCell, HasAGripperThatNoArmCarries) {
    for (const std::string on : {"", "nobody"}) {
        world_.settings.set("on.wsg50-controller", on);
        const auto cell = shown();
        ASSERT_TRUE(cell.servers.at(2).gripper);
        EXPECT_EQ(cell.servers.at(2).gripper->on, "") << on;
    }
}

TEST_F(ShownCell, PlacesNothingWithoutAWorld) {
    const auto cell = cellFrom(config_);
    EXPECT_FALSE(cell.world);
    EXPECT_FALSE(cell.servers.at(0).world_from_base) << "nobody says where a real arm stands";
    EXPECT_FALSE(cell.servers.at(2).gripper);
}

TEST_F(ShownCell, ShowsTableAndWalls) {
    EXPECT_TRUE(shown().world->fixed.at("table").is_null());
    EXPECT_EQ(shown().world->fixed.at("walls"), json::array());
    world_.settings.set("table", 0.8);
    world_.settings.set("wall.left", std::vector<double>{1, 2, 3, 0, 1, 0, 100, 5});
    world_.settings.set("wall.broken", std::vector<double>{1, 2, 3});
    const auto cell = shown();
    EXPECT_EQ(cell.world->fixed.at("table").at("height"), 0.8);
    EXPECT_EQ(cell.world->fixed.at("walls"),
              json::parse(R"([{"name":"left","point":[1,2,3],"normal":[0,1,0]}])"));
}

TEST_F(ShownCell, HasTheRecordsOfItsFile) {
    for (auto& server : config_.servers) {
        server.records.url = "/var/lib/cell.db";
    }
    EXPECT_EQ(shown().records, "/var/lib/cell.db");
}

}  // namespace
}  // namespace metier::dashboard
