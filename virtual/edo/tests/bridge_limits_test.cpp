// What a bridge keeps of its clients, and messages of every type that there is.
#include <gmock/gmock.h>

#include "rig.hpp"

namespace metier::virtual_edo {
namespace {

using testing::AnyOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr const char* kNote = R"({"op":"publish","topic":"/tablet_HB","msg":{"data":1}})";

/// Place of a fragment among those of its message.
struct Part {
    int number;
    int total;
};

void sendPart(Rig& rig, const Json& id, const std::string& data, Part part) {
    rig.client.say({{"op", "fragment"},
                    {"id", id},
                    {"data", data},
                    {"num", part.number},
                    {"total", part.total}});
}

TEST(Fragments, OfAsManyMessagesAsAClientMayHaveOpenAreJoined) {
    Rig rig;
    rig.client.subscribe("/tablet_HB");
    const std::string note = kNote;
    for (int id = 0; id < 256; ++id) {
        sendPart(rig, id, note.substr(0, 10), {0, 2});
    }
    EXPECT_THAT(rig.client.errors(), IsEmpty());
    sendPart(rig, 256, note.substr(0, 10), {0, 2});
    EXPECT_THAT(rig.client.errors(), SizeIs(1)) << "one too many";
    for (int id = 0; id < 256; ++id) {
        sendPart(rig, id, note.substr(10), {1, 2});
    }
    EXPECT_THAT(rig.client.messages("/tablet_HB"), SizeIs(256));
    sendPart(rig, 256, note, {0, 1});
    EXPECT_THAT(rig.client.messages("/tablet_HB"), SizeIs(257)) << "there is room again";
}

TEST(Fragments, OfOtherClientsAreNotMixedUp) {
    Rig rig;
    ScriptedClient other(rig.bridge);
    rig.client.subscribe("/tablet_HB");
    const std::string note = kNote;
    sendPart(rig, "same", note.substr(0, 10), {0, 2});
    other.say(
        {{"op", "fragment"}, {"id", "same"}, {"data", note.substr(10)}, {"num", 1}, {"total", 2}});
    EXPECT_THAT(rig.client.messages("/tablet_HB"), IsEmpty());
    sendPart(rig, "same", note.substr(10), {1, 2});
    EXPECT_THAT(rig.client.messages("/tablet_HB"), SizeIs(1));
}

TEST(Fragments, ThatMakeNoMessageOrAnotherFragmentAreRefused) {
    Rig rig;
    for (const char* whole : {"{", "5", R"({"op":"fragment"})", R"({"op":5})"}) {
        rig.client.received.clear();
        sendPart(rig, "f", whole, {0, 1});
        EXPECT_THAT(rig.client.errors(), Contains(HasSubstr("no message together"))) << whole;
    }
    for (const auto& [number, total] : {std::pair(0, 0), std::pair(1, 1), std::pair(0, 257)}) {
        rig.client.received.clear();
        sendPart(rig, "f", kNote, {number, total});
        EXPECT_THAT(rig.client.errors(), Contains(HasSubstr("total at most 256")));
    }
}

TEST(Fragments, OfMessagesForTheClientAreAnyLengthItAsksFor) {
    Rig rig;
    rig.client.say(
        {{"op", "call_service"}, {"service", "/rosapi/services"}, {"fragment_size", 7}, {"id", 5}});
    std::string whole;
    for (const auto& part : rig.client.received) {
        ASSERT_EQ(part["op"], "fragment");
        EXPECT_LE(part["data"].get<std::string>().size(), 7U);
        whole += part["data"].get<std::string>();
    }
    EXPECT_EQ(Json::parse(whole)["id"], 5) << "the id is what it was, a number";
}

TEST(Bridge, TopicsOfClientsAreLimited) {
    Rig rig;
    for (int i = 0; i < 300; ++i) {
        rig.client.say({{"op", "advertise"},
                        {"topic", "/mine" + std::to_string(i)},
                        {"type", "std_msgs/Bool"}});
    }
    EXPECT_THAT(rig.client.errors(), Contains(HasSubstr("Unable to import std_msgs/Bool")));
    rig.client.received.clear();
    rig.client.publish("/mine0", {{"data", true}});
    rig.moveJoints({2});
    EXPECT_THAT(rig.client.errors(), IsEmpty()) << "those that are there go on";
}

TEST(Bridge, TheMostEagerSubscriptionOfAClientSetsThePace) {
    Rig rig;
    ScriptedClient other(rig.bridge);
    for (const auto& [id, rate] : {std::pair("slow", 1000), std::pair("quick", 100)}) {
        other.say({{"op", "subscribe"},
                   {"topic", "/usb_jnt_state"},
                   {"throttle_rate", rate},
                   {"id", id}});
    }
    rig.runSeconds(1.0);
    EXPECT_THAT(other.messages("/usb_jnt_state"), SizeIs(10)) << "once each, not twice";
    other.say({{"op", "unsubscribe"}, {"topic", "/usb_jnt_state"}, {"id", "quick"}});
    other.received.clear();
    rig.runSeconds(2.0);
    EXPECT_THAT(other.messages("/usb_jnt_state"), SizeIs(2));
}

TEST(Bridge, ARateBelowNoughtIsNoneAndAHugeOneNeverComesAgain) {
    Rig rig;
    ScriptedClient negative(rig.bridge);
    ScriptedClient huge(rig.bridge);
    negative.say({{"op", "subscribe"}, {"topic", "/usb_jnt_state"}, {"throttle_rate", -5}});
    huge.sayText(R"({"op":"subscribe","topic":"/usb_jnt_state",)"
                 R"("throttle_rate":18446744073709551615,"queue_length":18446744073709551615})");
    rig.run(50);
    EXPECT_THAT(negative.messages("/usb_jnt_state"), SizeIs(50));
    EXPECT_THAT(huge.messages("/usb_jnt_state"), SizeIs(1));
}

TEST(Bridge, AnUnknownSubscriptionOrAdvertisementEndsWithoutAWord) {
    Rig rig;
    rig.client.say({{"op", "unsubscribe"}, {"topic", "/nowhere"}});
    rig.client.say({{"op", "unadvertise"}, {"topic", "/nowhere"}});
    rig.client.say({{"op", "unsubscribe"}, {"topic", "/machine_state"}, {"id", "no such"}});
    EXPECT_THAT(rig.client.errors(), IsEmpty());
    rig.run(20);
    EXPECT_THAT(rig.client.messages("/machine_state"), SizeIs(2));
}

TEST(Bridge, AServiceRefusesOtherArgumentsWithTheReasonTwice) {
    Rig rig;
    for (const Json& arguments : {Json(5), Json({1, 2, 3, 4, 5, 6, 7, 8, 9}),
                                  Json({{"nothing", 1}}), Json({{"mode", "1"}})}) {
        rig.client.received.clear();
        const auto response = rig.client.call("/algo_control_switch_srv", arguments);
        EXPECT_EQ(response["result"], false) << arguments;
        ASSERT_THAT(rig.client.errors(), SizeIs(1)) << arguments;
        EXPECT_EQ(rig.client.errors().front(),
                  "call_service: " + response["values"].get<std::string>());
    }
    EXPECT_EQ(rig.state(), 2) << "control was not taken";
}

class EachRelease : public testing::TestWithParam<const char*> {
protected:
    const Software software_ = Software::find(GetParam()).value();
    const MessageTypes types_{software_};
};

TEST_P(EachRelease, CompletesAnEmptyMessageOfEveryTypeOnceAndForAll) {
    for (const auto& [type, fields] : definitionsFor(software_)) {
        const auto whole = types_.complete(type, Json::object());
        ASSERT_TRUE(whole) << type << ": " << whole.error().message;
        EXPECT_THAT(*whole, SizeIs(fields.size())) << type;
        EXPECT_EQ(types_.complete(type, *whole).value().dump(), whole->dump()) << type;
    }
}

TEST_P(EachRelease, RefusesNullAndUnknownFieldsOfEveryType) {
    for (const auto& [type, fields] : definitionsFor(software_)) {
        EXPECT_FALSE(types_.complete(type, {{"no such field", 1}})) << type;
        EXPECT_FALSE(types_.complete(type, Json(nullptr))) << type;
        EXPECT_FALSE(types_.complete(type, Json::array())) << type;
        for (const auto& field : fields) {
            const auto refused = types_.complete(type, {{field.name, nullptr}});
            ASSERT_FALSE(refused) << type << "." << field.name;
            EXPECT_THAT(refused.error().message, HasSubstr(field.name));
        }
    }
}

TEST_P(EachRelease, IntegersHaveTheRangeOfTheirType) {
    for (const auto& [type, fields] : definitionsFor(software_)) {
        for (const auto& field : fields) {
            if (field.type != "uint8" && field.type != "int32") {
                continue;
            }
            const std::int64_t most = field.type == "uint8" ? 255 : 2'147'483'647;
            EXPECT_TRUE(types_.complete(type, {{field.name, most}})) << type << field.name;
            EXPECT_FALSE(types_.complete(type, {{field.name, most + 1}})) << type << field.name;
            EXPECT_FALSE(types_.complete(type, {{field.name, 1.0}})) << type << field.name;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Releases, EachRelease,
                         testing::Values("2.4.0", "3.0.1", "3.1.2", "3.2.0"));

}  // namespace
}  // namespace metier::virtual_edo
