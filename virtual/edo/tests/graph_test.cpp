// What each release has: topics, services, and how clients look around among them.
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
using testing::IsSupersetOf;

using Names = std::vector<std::string>;

Names topicsOf(Rig& rig) {
    return rig.client.call("/rosapi/topics")["topics"].get<Names>();
}

Names servicesOf(Rig& rig) {
    return rig.client.call("/rosapi/services")["services"].get<Names>();
}

Json advertisement(const std::string& topic, const std::string& type) {
    return {{"op", "advertise"}, {"topic", topic}, {"type", type}};
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
