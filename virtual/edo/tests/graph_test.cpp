// Topics and services of each release, and the ways in which clients list them.
#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "rig.hpp"

namespace metier::virtual_edo {
namespace {

using namespace std::chrono_literals;
using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::IsSupersetOf;
using testing::Not;

using Names = std::vector<std::string>;

Names topicsOf(Rig& rig) {
    return rig.client.call("/rosapi/topics")["topics"].get<Names>();
}

Names servicesOf(Rig& rig) {
    return rig.client.call("/rosapi/services")["services"].get<Names>();
}

bool has(const Names& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

Json advertisement(const std::string& topic, const std::string& type) {
    return {{"op", "advertise"}, {"topic", topic}, {"type", type}};
}

TEST(Topics, AreThoseOfTheRelease) {
    const Names later{"/app_jnt_state",   "/algo_coll_thr",      "/tablet_HB",
                      "/tablet_HB_start", "/brakes_check_start", "/brakes_check_ack"};
    const Names newest{"/external_control", "/tool_configuration"};
    for (const std::string release : {"2.4.0", "3.0.1", "3.1.2", "3.2.0"}) {
        Rig rig({.software = release});
        const auto topics = topicsOf(rig);
        EXPECT_THAT(topics, IsSupersetOf({"/bridge_init", "/bridge_jnt_reset", "/bridge_move",
                                          "/machine_state", "/usb_jnt_state", "/algorithm_state",
                                          "/machine_movement_ack", "/algo_jnt_ctrl"}));
        EXPECT_EQ(has(topics, "/machine_bridge_jnt_state"), release == "2.4.0");
        for (const auto& topic : later) {
            EXPECT_EQ(has(topics, topic), release >= "3.0.1") << release << topic;
        }
        for (const auto& topic : newest) {
            EXPECT_EQ(has(topics, topic), release >= "3.1.2") << release << topic;
        }
    }
}

TEST(Topics, CarryTheJointStatesOnUnderTheNameOfTheRelease) {
    Rig old({.software = "2.4.0"});
    old.client.subscribe("/machine_bridge_jnt_state");
    old.run(3);
    EXPECT_EQ(old.client.messages("/machine_bridge_jnt_state"),
              old.client.messages("/usb_jnt_state"));
    EXPECT_EQ(old.client.messages("/usb_jnt_state").size(), 3U);

    Rig later({.software = "3.0.1"});
    later.client.subscribe("/app_jnt_state");
    later.run(3);
    EXPECT_EQ(later.client.messages("/app_jnt_state").size(), 3U);
    EXPECT_NEAR(later.client.last("/app_jnt_state")["joints"][2]["position"].get<double>(), 90.0,
                1e-9);
}

TEST(Topics, AreLeftToTheClientsWhereTheReleaseHasNone) {
    Rig rig({.software = "2.4.0"});
    rig.client.say(advertisement("/tablet_HB_start", "std_msgs/String"));
    rig.client.say(advertisement("/external_control", "std_msgs/Bool"));
    rig.client.say(advertisement("/app_jnt_state", "std_msgs/Int8"));
    rig.client.subscribe("/app_jnt_state");
    rig.client.publish("/tablet_HB_start", {{"data", "true"}});
    rig.client.publish("/external_control", {{"data", true}});
    rig.client.publish("/app_jnt_state", {{"data", 7}});
    rig.runSeconds(3.0);
    EXPECT_THAT(rig.client.errors(), IsEmpty());
    EXPECT_EQ(rig.state(), 2);
    EXPECT_THAT(rig.client.messages("/app_jnt_state"), ElementsAre(Json::object({{"data", 7}})));
}

TEST(Services, AreThoseOfTheRelease) {
    const Names newest{"/algo_tool_configuration_srv", "/calibration_counter_srv",
                       "/increment_calib_counter_srv"};
    for (const std::string release : {"2.4.0", "3.0.1", "3.1.2", "3.2.0"}) {
        Rig rig({.software = release});
        const auto services = servicesOf(rig);
        EXPECT_THAT(services, IsSupersetOf({"/algo_jnt_number_srv", "/algo_control_switch_srv",
                                            "/algo_load_configuration_file_srv",
                                            "/machine_bridge_sw_version_srv"}));
        EXPECT_THAT(services, Not(Contains("/algo_direct_kinematics_srv")));
        EXPECT_THAT(services, Not(Contains("/algo_inverse_kinematics_srv")));
        for (const auto& service : newest) {
            EXPECT_EQ(has(services, service), release >= "3.1.2") << release << service;
        }
    }
}

TEST(Services, CountCalibrationsByTheOneAndTellThemByTheOther) {
    Rig rig;
    const auto count = [&](const Json& arguments = Json::object()) {
        return rig.client.call("/calibration_counter_srv", arguments)["cnt"];
    };
    EXPECT_EQ(count({{"increment", true}}), 0);
    EXPECT_EQ(rig.client.call("/increment_calib_counter_srv", {{"increment", true}})["cnt"], 0);
    EXPECT_EQ(count(), 1);
    rig.client.call("/increment_calib_counter_srv", {{"increment", false}});
    EXPECT_EQ(count(), 2);
}

TEST(RosApi, TellsTopicsAndTheirTypes) {
    Rig rig;
    const auto all = rig.client.call("/rosapi/topics");
    ASSERT_EQ(all["topics"].size(), all["types"].size());
    const auto names = all["topics"].get<Names>();
    const auto at = std::find(names.begin(), names.end(), "/machine_state") - names.begin();
    EXPECT_EQ(all["types"][static_cast<std::size_t>(at)], "edo_core_msgs/MachineState");
    const auto type = [&](const char* topic) {
        return rig.client.call("/rosapi/topic_type", {{"topic", topic}})["type"];
    };
    EXPECT_EQ(type("/bridge_jog"), "edo_core_msgs/MovementCommand");
    EXPECT_EQ(type("/nowhere"), "");
    const auto wanted = Json::object({{"type", "edo_core_msgs/MovementCommand"}});
    EXPECT_EQ(rig.client.call("/rosapi/topics_for_type", wanted)["topics"],
              Json::array({"/bridge_jog", "/bridge_move"}));
}

TEST(RosApi, TellsTopicsOfTheClients) {
    Rig rig;
    rig.client.say(advertisement("/note", "std_msgs/String"));
    EXPECT_THAT(topicsOf(rig), Contains("/note"));
    const auto wanted = Json::object({{"type", "std_msgs/String"}});
    EXPECT_EQ(rig.client.call("/rosapi/topics_for_type", wanted)["topics"], Json::array({"/note"}));
}

TEST(RosApi, TellsServicesAndTheirTypesItsOwnAmongThem) {
    Rig rig;
    EXPECT_THAT(servicesOf(rig),
                IsSupersetOf({"/algo_jnt_number_srv", "/rosapi/topics", "/rosapi/get_time"}));
    const auto type = [&](const char* service) {
        return rig.client.call("/rosapi/service_type", {{"service", service}})["type"];
    };
    EXPECT_EQ(type("/algo_control_switch_srv"), "edo_core_msgs/ControlSwitch");
    EXPECT_EQ(type("/rosapi/topics"), "rosapi/Topics");
    EXPECT_EQ(type("/no_srv"), "");
}

TEST(RosApi, IsFoundWithoutALeadingSlash) {
    Rig rig;
    EXPECT_EQ(rig.client.call("rosapi/topics"), rig.client.call("/rosapi/topics"));
}

TEST(RosApi, TellsTheTimeOfTheRobot) {
    const MessageTypes types(Software::find("3.2.0").value());
    Rosbridge bridge(types, RosGraph{}, UtcTime(1'600'000'000s));
    ScriptedClient client(bridge);
    bridge.setTime(SteadyTime(2'500ms));
    EXPECT_EQ(client.call("/rosapi/get_time")["time"],
              Json({{"secs", 1'600'000'002}, {"nsecs", 500'000'000}}));
}

}  // namespace
}  // namespace metier::virtual_edo
