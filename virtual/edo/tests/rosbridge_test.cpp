#include "rosbridge.hpp"

#include <gmock/gmock.h>

#include "rig.hpp"

namespace metier::virtual_edo {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

/// The error that a publication causes; empty if none.
std::string errorOf(Rig& rig, const std::string& topic, const Json& message) {
    rig.client.received.clear();
    rig.client.publish(topic, message);
    const auto errors = rig.client.errors();
    return errors.empty() ? "" : errors.front();
}

TEST(Conversion, RefusesAMessageWithAnUnknownFieldAsAWhole) {
    Rig rig;
    EXPECT_EQ(errorOf(rig, "/bridge_jnt_calib", {{"joints_mask", 63}, {"speed", 1}}),
              "publish: Message type edo_core_msgs/JointCalibration does not have a field speed");
    EXPECT_EQ(rig.state(), 2);
    EXPECT_THAT(errorOf(rig, "/bridge_move", {{"target", {{"joint_data", {1}}}}}),
                HasSubstr("does not have a field target.joint_data"));
}

TEST(Conversion, TakesAnIntegerForAFloatButNotTheReverse) {
    Rig rig;
    EXPECT_EQ(errorOf(rig, "/bridge_jnt_reset", {{"disengage_offset", 3}}), "");
    EXPECT_EQ(errorOf(rig, "/bridge_jnt_reset", {{"disengage_steps", 2000.0}}),
              "publish: edo_core_msgs/JointReset message requires a uint32 for field "
              "disengage_steps, but got a <type 'float'>");
}

TEST(Conversion, RefusesOtherTypesAndRanges) {
    Rig rig;
    EXPECT_THAT(errorOf(rig, "/bridge_init", {{"mode", 256}}), HasSubstr("range"));
    EXPECT_THAT(errorOf(rig, "/bridge_init", {{"mode", -1}}), HasSubstr("range"));
    EXPECT_THAT(errorOf(rig, "/bridge_init", {{"mode", "0"}}), HasSubstr("'unicode'"));
    EXPECT_THAT(errorOf(rig, "/bridge_init", {{"mode", nullptr}}), HasSubstr("'NoneType'"));
    EXPECT_THAT(errorOf(rig, "/bridge_init", {{"mode", true}}), HasSubstr("'bool'"));
    EXPECT_THAT(errorOf(rig, "/bridge_init", {{"reduction_factor", 1e39}}), HasSubstr("range"));
    EXPECT_THAT(errorOf(rig, "/tablet_HB_start", {{"data", 1}}), HasSubstr("bool"));
    EXPECT_THAT(errorOf(rig, "/bridge_move", {{"target", 5}}), HasSubstr("target"));
    EXPECT_THAT(errorOf(rig, "/external_control", {{"position", {1, 2}}}), HasSubstr("length 7"));
    EXPECT_THAT(errorOf(rig, "/bridge_init", Json::array()), HasSubstr("JSON object"));
}

TEST(Conversion, FillsInWhatIsMissing) {
    const MessageTypes types(Software::find("3.2.0").value());
    const auto whole = types.complete("edo_core_msgs/MovementCommand", {{"ovr", 50}}).value();
    EXPECT_EQ(whole["ovr"], 50);
    EXPECT_EQ(whole["target"]["joints_data"], Json::array());
    EXPECT_EQ(whole["target"]["cartesian_data"]["config_flags"], "");
    EXPECT_EQ(whole["payload"]["mass"], 0.0);
    EXPECT_EQ(whole.begin().key(), "move_command");
}

TEST(Conversion, TakesBytesAsBase64OrList) {
    const MessageTypes types(Software::find("3.2.0").value());
    const auto in = [&](const Json& bytes) {
        return types.complete("edo_core_msgs/JointsPositions",
                              Json::object({{"joints_type", bytes}}));
    };
    EXPECT_EQ(in("AQID").value()["joints_type"], Json({1, 2, 3}));
    EXPECT_EQ(in({1, 2, 3}).value()["joints_type"], Json({1, 2, 3}));
    EXPECT_FALSE(in("A"));
}

TEST(Conversion, SendsNullForWhatIsNoNumber) {
    EXPECT_TRUE(finiteOrNull(std::nan("")).is_null());
    EXPECT_EQ(finiteOrNull(1.5), 1.5);
}

TEST(Conversion, KnowsTheFieldsOfEachRelease) {
    const MessageTypes old(Software::find("2.4.0").value());
    EXPECT_FALSE(old.complete("edo_core_msgs/JointState", {{"R_jnt", 0.0}}));
    EXPECT_FALSE(old.complete("edo_core_msgs/JointControl", {{"R_rasp", 0.0}}));
    EXPECT_FALSE(old.complete("edo_core_msgs/JointState", {{"commandFlag", 256}}));
    EXPECT_FALSE(old.complete("edo_core_msgs/MovementCommand", {{"payload", Json::object()}}));
    const MessageTypes middle(Software::find("3.0.1").value());
    EXPECT_TRUE(middle.complete("edo_core_msgs/JointState", {{"R_jnt", 0.0}}));
    EXPECT_FALSE(middle.complete("edo_core_msgs/JointState", {{"commandFlag", 256}}));
    const MessageTypes newest(Software::find("3.2.0").value());
    EXPECT_TRUE(newest.complete("edo_core_msgs/JointState", {{"commandFlag", 256}}));
    EXPECT_FALSE(Software::find("1.0"));
}

TEST(Bridge, SendsNoFieldThatTheReleaseDoesNotHave) {
    for (const auto& [release, fields] : {std::pair("2.4.0", 4U), std::pair("3.2.0", 5U)}) {
        Rig rig({.software = release});
        rig.run(1);
        EXPECT_THAT(rig.client.last("/usb_jnt_state")["joints"][0], SizeIs(fields));
    }
}

TEST(Bridge, RefusesTopicsItCannotInferTheTypeOf) {
    Rig rig;
    rig.client.publish("/nowhere", {{"data", 1}});
    rig.client.subscribe("/nowhere");
    rig.client.say({{"op", "advertise"}, {"topic", "/nowhere"}, {"type", "foo_msgs/Bar"}});
    EXPECT_THAT(rig.client.errors(), ElementsAre(HasSubstr("publish: Cannot infer topic type"),
                                                 HasSubstr("subscribe: Cannot infer topic type"),
                                                 HasSubstr("advertise: Unable to import")));
}

TEST(Bridge, RefusesAnotherTypeForAKnownTopic) {
    Rig rig;
    rig.client.say({{"op", "advertise"}, {"topic", "/bridge_init"}, {"type", "std_msgs/Bool"}});
    EXPECT_THAT(rig.client.errors(), ElementsAre(HasSubstr("already established with type")));
}

TEST(Bridge, CarriesTopicsOfTheClientsToo) {
    Rig rig;
    ScriptedClient other(rig.bridge);
    rig.client.say({{"op", "advertise"}, {"topic", "/note"}, {"type", "std_msgs/String"}});
    other.subscribe("/note");
    rig.client.publish("/note", {{"data", "hello"}});
    EXPECT_EQ(other.last("/note")["data"], "hello");
    EXPECT_THAT(rig.client.errors(), IsEmpty());
}

TEST(Bridge, AnswersServicesWithTheIdOfTheCall) {
    Rig rig;
    rig.client.say({{"op", "call_service"},
                    {"service", "/algo_jnt_number_srv"},
                    {"id", "call_service:/algo_jnt_number_srv:1"}});
    const auto& answer = rig.client.received.back();
    EXPECT_EQ(answer["op"], "service_response");
    EXPECT_EQ(answer["id"], "call_service:/algo_jnt_number_srv:1");
    EXPECT_EQ(answer["result"], true);
    EXPECT_EQ(answer["values"]["counter"], 7);
}

TEST(Bridge, TakesArgumentsAsAList) {
    Rig rig;
    EXPECT_EQ(rig.client.call("/algo_control_switch_srv", {2})["result"], 0);
    EXPECT_EQ(rig.client.call("/algo_control_switch_srv", {0})["result"], 0);
    EXPECT_EQ(rig.client.call("/algo_control_switch_srv", {1, 2})["result"], false);
    EXPECT_EQ(rig.client.call("/algo_jnt_number_srv", Json::array())["counter"], 7);
}

TEST(Bridge, TellsWhyAServiceFails) {
    Rig rig;
    const auto unknown = rig.client.call("/no_srv");
    EXPECT_EQ(unknown["result"], false);
    EXPECT_EQ(unknown["values"], "Service /no_srv does not exist");
    EXPECT_EQ(rig.client.call("/algo_control_switch_srv", {{"mode", 1.5}})["result"], false);
    EXPECT_EQ(rig.client.call("/algo_control_switch_srv", {{"mood", 1}})["result"], false);
}

TEST(Bridge, ThrottlesASubscription) {
    Rig rig;
    ScriptedClient slow(rig.bridge);
    slow.say({{"op", "subscribe"},
              {"topic", "/usb_jnt_state"},
              {"type", "edo_core_msgs/JointStateArray"},
              {"throttle_rate", 200}});
    rig.runSeconds(2.0);
    EXPECT_THAT(slow.messages("/usb_jnt_state"), SizeIs(10));
}

TEST(Bridge, KeepsTheNewestMessagesOfAThrottledQueue) {
    Rig rig;
    ScriptedClient slow(rig.bridge);
    slow.say({{"op", "subscribe"},
              {"topic", "/note"},
              {"type", "std_msgs/Int32"},
              {"throttle_rate", 100},
              {"queue_length", 2}});
    rig.run(1);
    for (int i = 0; i < 5; ++i) {
        rig.client.publish("/note", {{"data", i}});
    }
    rig.run(50);
    const auto notes = slow.messages("/note");
    ASSERT_THAT(notes, SizeIs(3));
    EXPECT_EQ(notes[0]["data"], 0);
    EXPECT_EQ(notes[1]["data"], 3);
    EXPECT_EQ(notes[2]["data"], 4);
}

TEST(Bridge, SendsWithoutCompressionAndSaysSo) {
    for (const char* compression : {"png", "cbor", "cbor-raw"}) {
        Rig rig;
        ScriptedClient other(rig.bridge);
        other.say({{"op", "subscribe"}, {"topic", "/machine_state"}, {"compression", compression}});
        rig.run(20);
        EXPECT_THAT(other.messages("/machine_state"), SizeIs(2));
        EXPECT_THAT(other.errors(), ElementsAre(HasSubstr("/machine_state is sent without")));
    }
    Rig rig;
    rig.client.say({{"op", "subscribe"}, {"topic", "/machine_state"}, {"compression", "none"}});
    EXPECT_THAT(rig.client.errors(), IsEmpty());
}

TEST(Bridge, EndsASubscriptionById) {
    Rig rig;
    ScriptedClient other(rig.bridge);
    other.say({{"op", "subscribe"}, {"topic", "/machine_state"}, {"id", "a"}});
    other.say({{"op", "subscribe"}, {"topic", "/machine_state"}, {"id", "b"}});
    other.say({{"op", "unsubscribe"}, {"topic", "/machine_state"}, {"id", "a"}});
    rig.run(20);
    EXPECT_THAT(other.messages("/machine_state"), SizeIs(2));
    other.say({{"op", "unsubscribe"}, {"topic", "/machine_state"}});
    rig.run(20);
    EXPECT_THAT(other.messages("/machine_state"), SizeIs(2));
}

TEST(Bridge, SendsFragmentsWhenAsked) {
    Rig rig;
    ScriptedClient other(rig.bridge);
    other.say({{"op", "subscribe"}, {"topic", "/usb_jnt_state"}, {"fragment_size", 100}});
    rig.run(1);
    std::string whole;
    for (const auto& part : other.received) {
        EXPECT_EQ(part["op"], "fragment");
        EXPECT_EQ(part["total"], other.received.size());
        whole += part["data"].get<std::string>();
    }
    EXPECT_EQ(Json::parse(whole)["topic"], "/usb_jnt_state");
}

TEST(Bridge, JoinsFragmentsInAnyOrder) {
    Rig rig;
    const std::string whole =
        Json({{"op", "publish"}, {"topic", "/tablet_HB"}, {"msg", {{"data", 1}}}}).dump();
    rig.client.subscribe("/tablet_HB");
    const auto part = [&](int number, const std::string& data) {
        rig.client.say(
            {{"op", "fragment"}, {"id", "f"}, {"data", data}, {"num", number}, {"total", 2}});
    };
    part(1, whole.substr(20));
    EXPECT_THAT(rig.client.messages("/tablet_HB"), IsEmpty());
    part(0, whole.substr(0, 20));
    EXPECT_THAT(rig.client.messages("/tablet_HB"), SizeIs(1));
    part(5, "x");
    EXPECT_THAT(rig.client.errors(), ElementsAre(HasSubstr("fragment:")));
}

TEST(Bridge, AnswersWhatIsNoRequest) {
    Rig rig;
    for (const char* text :
         {"", "{", "[]", "5", "{}", R"({"op":7})", R"({"op":"dance"})", R"({"op":"publish"})",
          R"({"op":"subscribe","topic":5})", R"({"op":"call_service"})",
          R"({"op":"set_level","level":"loud"})",
          R"({"op":"subscribe","topic":"/machine_state","compression":5})",
          R"({"op":"subscribe","topic":"/machine_state","throttle_rate":"1"})"}) {
        rig.client.received.clear();
        rig.client.sayText(text);
        EXPECT_THAT(rig.client.errors(), SizeIs(1)) << text;
    }
    rig.client.sayText(std::string(100'000, '['));
    EXPECT_THAT(rig.client.errors(), SizeIs(2));
}

TEST(Bridge, KeepsSilentAtLevelNone) {
    Rig rig;
    rig.client.say({{"op", "set_level"}, {"level", "none"}});
    rig.client.publish("/nowhere", {});
    EXPECT_THAT(rig.client.errors(), IsEmpty());
}

TEST(Bridge, ServesTwoClientsApart) {
    Rig rig;
    ScriptedClient other(rig.bridge);
    other.subscribe("/machine_movement_ack");
    other.sayText("garbage");
    rig.moveJoints({2});
    rig.runUntilState(2);
    EXPECT_THAT(rig.client.errors(), IsEmpty());
    EXPECT_THAT(other.messages("/machine_movement_ack"), SizeIs(2));
    EXPECT_THAT(other.messages("/machine_state"), IsEmpty());
}

}  // namespace
}  // namespace metier::virtual_edo
