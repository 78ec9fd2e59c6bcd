// Texts of the wire, written down from the message definitions (docs/protocols/edo.md).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "decoder.hpp"
#include "metier/base/numbers.hpp"
#include "metier/base/testing/allocation_count.hpp"
#include "metier/edo_driver/encoder.hpp"

namespace metier::edo_driver {
namespace {

using ::testing::HasSubstr;

const JointLayout kWithGripper{6, true};
const JointLayout kSixAxes{6, false};

template <typename T>
T decoded(std::string_view text, const JointLayout& layout = kWithGripper) {
    const auto message = decode(text, layout);
    EXPECT_TRUE(message) << message.error().message;
    EXPECT_TRUE(message && std::holds_alternative<T>(*message)) << text;
    const auto in_full = decodeInFull(text, layout);
    EXPECT_TRUE(in_full && std::holds_alternative<T>(*in_full)) << text;
    return message && std::holds_alternative<T>(*message) ? std::get<T>(*message) : T{};
}

std::string refused(std::string_view text) {
    const auto message = decode(text, kWithGripper);
    EXPECT_FALSE(message) << text;
    return message ? "" : message.error().message;
}

constexpr std::string_view kJointStates =
    R"({"topic": "/usb_jnt_state", "msg": {"joints_mask": 127, "joints": [)"
    R"({"current": 0.25, "velocity": -1.5, "position": 90.0, "commandFlag": 0, "R_jnt": 0.0}, )"
    R"({"current": 0.0, "velocity": 0, "position": -45, "commandFlag": 32, "R_jnt": 0.0}, )"
    R"({"position": 1e1}, {"position": null}, {}, {"position": 0.5}, )"
    R"({"position": 80.0, "velocity": 10.0}]}, "op": "publish"})";

// ---- what the robot says ----

TEST(Decoder, ReadsJointStatesInRadiansAndMetres) {
    const auto states = decoded<JointStates>(kJointStates);
    ASSERT_EQ(states.count, 7U);
    EXPECT_DOUBLE_EQ(states.joints[0].position, 90.0 * kDegree);
    EXPECT_DOUBLE_EQ(states.joints[0].velocity, -1.5 * kDegree);
    EXPECT_DOUBLE_EQ(states.joints[0].current, 0.25);
    EXPECT_DOUBLE_EQ(states.joints[1].position, -45.0 * kDegree);
    EXPECT_EQ(states.joints[1].flags, 32U);
    EXPECT_TRUE(std::isnan(states.joints[3].position));
    EXPECT_EQ(states.joints[4].position, 0.0) << "missing fields keep their defaults";
    EXPECT_DOUBLE_EQ(states.joints[6].position, 0.08);
    EXPECT_DOUBLE_EQ(states.joints[6].velocity, 0.01);
}

TEST(Decoder, TheSeventhJointOfSixAxesIsNoGripper) {
    const auto states = decoded<JointStates>(kJointStates, kSixAxes);
    EXPECT_DOUBLE_EQ(states.joints[6].position, 80.0 * kDegree);
}

TEST(Decoder, ReadsMachineState) {
    const auto machine = decoded<MachineState>(
        R"({"op":"publish","topic":"/machine_state","msg":{"current_state":6,"opcode":64}})");
    EXPECT_EQ(machine.state, MachineState::braked);
    EXPECT_EQ(machine.opcode, MachineState::brake_active);
}

TEST(Decoder, ReadsAlgorithmState) {
    const auto text = R"({"op":"publish","topic":"/algorithm_state","msg":{"data":-1}})";
    EXPECT_EQ(decoded<AlgorithmState>(text).value, -1);
}

TEST(Decoder, ReadsMovementFeedback) {
    const auto feedback = decoded<MovementFeedback>(
        R"({"op":"publish","topic":"/machine_movement_ack","msg":{"type":-2,"data":-101}})");
    EXPECT_EQ(feedback.type, MovementFeedback::rejected);
    EXPECT_EQ(feedback.data, -101);
}

TEST(Decoder, ReadsTheSoftwareVersion) {
    const auto response = decoded<ServiceResponse>(
        R"({"op":"service_response","service":"/machine_bridge_sw_version_srv","id":"v",)"
        R"("values":{"tool_id":1,"version":{"nodes":[{"id":0,"version":"2.1"},)"
        R"({"id":255,"version":"edo_3.2.0"},{"id":1,"version":"x"}]}},"result":true})");
    EXPECT_EQ(response.id, "v");
    EXPECT_TRUE(response.ok);
    EXPECT_EQ(response.software, "edo_3.2.0");
    EXPECT_FALSE(response.result_code);
}

TEST(Decoder, ReadsTheAnswerOfTheControlSwitch) {
    const auto response = decoded<ServiceResponse>(
        R"({"values":{"result":1},"result":true,"service":"/algo_control_switch_srv",)"
        R"("op":"service_response","id":"s"})");
    EXPECT_EQ(response.result_code, 1);
}

TEST(Decoder, ReadsAFailedCall) {
    const auto response = decoded<ServiceResponse>(
        R"({"op":"service_response","id":"s","values":"Service /x does not exist","result":false})");
    EXPECT_FALSE(response.ok);
    EXPECT_EQ(response.text, "Service /x does not exist");
}

TEST(Decoder, ReadsStatusAndIgnoresTheRest) {
    const auto status = decoded<Status>(R"({"op":"status","level":"error","msg":"no type"})");
    EXPECT_EQ(status.text, "no type");
    decoded<Ignored>(R"({"op":"png","data":"x"})");
    decoded<Ignored>(R"({"topic":"/cartesian_pose"})");
    decoded<Ignored>(R"({"op":"publish","topic":"/cartesian_pose","msg":{"x":1}})");
}

TEST(Decoder, ReadsEscapedTopics) {
    const auto text = R"({"op":"publish","topic":"\/algorithm_state","msg":{"data":5}})";
    EXPECT_EQ(decoded<AlgorithmState>(text).value, 5);
}

TEST(Decoder, RefusesFragments) {
    EXPECT_THAT(refused(R"({"op":"fragment","id":"1","data":"{","num":0,"total":2})"),
                HasSubstr("fragments"));
}

TEST(Decoder, RefusesWhatIsNotRight) {
    EXPECT_THAT(refused("{\"op\":"), HasSubstr("not JSON"));
    EXPECT_THAT(refused(""), HasSubstr("not JSON"));
    EXPECT_THAT(refused("[1]"), HasSubstr("not an object"));
    EXPECT_THAT(refused(R"({"op":5})"), HasSubstr("message.op is not a text"));
    EXPECT_THAT(refused(R"({"op":"publish","topic":"/machine_state"})"),
                HasSubstr("msg is missing"));
    const auto machine = [](std::string_view fields) {
        return fmt::format(R"({{"op":"publish","topic":"/machine_state","msg":{}}})", fields);
    };
    EXPECT_THAT(refused(machine(R"({"current_state":2.0})")), HasSubstr("not an integer"));
    EXPECT_THAT(refused(machine(R"({"current_state":256})")), HasSubstr("0 and 255"));
    EXPECT_THAT(refused(machine(R"({"current_state":-1})")), HasSubstr("0 and 255"));
    EXPECT_THAT(refused(machine(R"({"opcode":18446744073709551615})")), HasSubstr("opcode"));
    EXPECT_THAT(refused(machine(R"({"current_state":true})")), HasSubstr("not an integer"));
    EXPECT_THAT(refused(machine("null")), HasSubstr("not an object"));
}

TEST(Decoder, NamesTheFirstOfSeveralProblems) {
    EXPECT_THAT(refused(R"({"op":"publish","topic":"/machine_state",)"
                        R"("msg":{"current_state":256,"opcode":-1}})"),
                HasSubstr("MachineState.current_state is not within 0 and 255"));
}

TEST(Decoder, RefusesAResultOfTheControlSwitchThatIsNone) {
    EXPECT_THAT(refused(R"({"op":"service_response","id":"s","values":{"result":256}})"),
                HasSubstr("ControlSwitch.result is not within 0 and 255"));
    EXPECT_THAT(refused(R"({"op":"service_response","id":5})"), HasSubstr("id is not a text"));
}

TEST(Decoder, TakesACallForDoneUnlessItsResultSaysOtherwise) {
    const auto response = [](std::string_view fields) {
        return decoded<ServiceResponse>(
            fmt::format(R"({{"op":"service_response","id":"s"{}}})", fields));
    };
    EXPECT_TRUE(response("").ok);
    EXPECT_TRUE(response(R"(,"result":true)").ok);
    EXPECT_FALSE(response(R"(,"result":false)").ok);
    EXPECT_FALSE(response(R"(,"result":1)").ok);
    EXPECT_EQ(response(R"(,"values":5)").text, "");
}

TEST(Decoder, FindsNoVersionWhereThereIsNone) {
    for (const std::string_view values :
         {R"({"tool_id":1})", R"({"version":5})", R"({"version":{}})", R"({"version":{"nodes":5}})",
          R"({"version":{"nodes":[]}})", R"({"version":{"nodes":[{"id":1,"version":"x"}]}})",
          R"({"version":{"nodes":[{"id":255,"version":5}]}})", R"({"version":{"nodes":[7]}})"}) {
        const auto response = decoded<ServiceResponse>(
            fmt::format(R"({{"op":"service_response","id":"v","values":{}}})", values));
        EXPECT_FALSE(response.software) << values;
    }
    const auto behind = decoded<ServiceResponse>(
        R"({"op":"service_response","id":"v","values":{"version":{"nodes":[7,)"
        R"({"id":255,"version":5},{"id":255,"version":"edo_3.2.0"}]}}})");
    EXPECT_EQ(behind.software, "edo_3.2.0");
}

TEST(Decoder, ReadsValuesUpToTheirLimits) {
    const auto message = [](std::string_view topic, std::string_view fields) {
        return fmt::format(R"({{"op":"publish","topic":"/{}","msg":{{{}}}}})", topic, fields);
    };
    EXPECT_EQ(decoded<AlgorithmState>(message("algorithm_state", R"("data":127)")).value, 127);
    EXPECT_EQ(decoded<AlgorithmState>(message("algorithm_state", R"("data":-128)")).value, -128);
    refused(message("algorithm_state", R"("data":128)"));
    refused(message("algorithm_state", R"("data":-129)"));
    refused(message("machine_movement_ack", R"("type":128)"));
    refused(message("machine_movement_ack", R"("data":-129)"));
    const auto machine = decoded<MachineState>(
        message("machine_state", R"("opcode":4294967295,"current_state":255)"));
    EXPECT_EQ(machine.opcode, 0xffff'ffffU);
    EXPECT_EQ(machine.state, 255);
    refused(message("machine_state", R"("opcode":4294967296)"));
    EXPECT_EQ(decoded<JointStates>(message("usb_jnt_state", R"("joints":[{"commandFlag":65535}])"))
                  .joints[0]
                  .flags,
              0xffffU);
}

TEST(Decoder, ReadsWhatIsNestedDeeply) {
    for (const std::size_t levels : {14U, 15U, 16U, 17U, 40U}) {
        const auto text = fmt::format(
            R"({{"op":"publish","topic":"/algorithm_state","msg":{{"data":5,"x":{}{}}}}})",
            std::string(levels, '['), std::string(levels, ']'));
        EXPECT_EQ(decoded<AlgorithmState>(text).value, 5) << levels;
    }
}

TEST(Decoder, RefusesJointStatesThatAreNotRight) {
    const auto joints = [](std::string_view list) {
        return fmt::format(R"({{"op":"publish","topic":"/usb_jnt_state","msg":{{"joints":{}}}}})",
                           list);
    };
    EXPECT_THAT(refused(joints("5")), HasSubstr("joints is not a list"));
    EXPECT_THAT(refused(R"({"op":"publish","topic":"/usb_jnt_state","msg":{}})"),
                HasSubstr("joints is not a list"));
    EXPECT_THAT(refused(joints("[{},{},{},{},{},{},{},{}]")), HasSubstr("8 entries"));
    EXPECT_THAT(refused(joints(R"([{"position":"1"}])")), HasSubstr("position is not a number"));
    EXPECT_THAT(refused(joints("[7]")), HasSubstr("not an object"));
    EXPECT_THAT(refused(joints(R"([{"commandFlag":65536}])")), HasSubstr("commandFlag"));
}

TEST(Decoder, DoesNotAllocateForWhatComesInEachCycle) {
    const auto before = allocationCount();
    bool right = true;
    for (const std::string_view text :
         {kJointStates,
          std::string_view(R"({"op":"publish","topic":"/algorithm_state","msg":{"data":5}})"),
          std::string_view(R"({"op":"publish","topic":"/machine_state","msg":{"opcode":0}})")}) {
        right = right && decode(text, kWithGripper);
    }
    EXPECT_EQ(allocationCount() - before, 0U);
    EXPECT_TRUE(right);
}

// ---- texts for the robot ----

TEST(Encoder, WritesSubscriptionsWithoutThrottle) {
    EXPECT_EQ(subscribeText("/machine_state", "edo_core_msgs/MachineState"),
              R"({"op":"subscribe","topic":"/machine_state","type":"edo_core_msgs/MachineState"})");
    EXPECT_EQ(advertiseText("/bridge_init", "edo_core_msgs/JointInit"),
              R"({"op":"advertise","topic":"/bridge_init","type":"edo_core_msgs/JointInit"})");
}

TEST(Encoder, WritesServiceCalls) {
    EXPECT_EQ(softwareVersionCallText("a"),
              R"({"op":"call_service","id":"a","service":"/machine_bridge_sw_version_srv",)"
              R"("args":{}})");
    EXPECT_EQ(controlSwitchCallText("b", 2),
              R"({"op":"call_service","id":"b","service":"/algo_control_switch_srv",)"
              R"("args":{"mode":2}})");
}

TEST(Encoder, WritesInitAndReset) {
    EXPECT_EQ(initText(kWithGripper),
              R"({"op":"publish","topic":"/bridge_init","msg":{"mode":0,"joints_mask":127,)"
              R"("reduction_factor":0.0}})");
    EXPECT_THAT(initText(kSixAxes), HasSubstr("\"joints_mask\":63"));
    EXPECT_EQ(resetText(kWithGripper, {2000, 3.5 * kDegree}),
              R"({"op":"publish","topic":"/bridge_jnt_reset","msg":{"joints_mask":127,)"
              R"("disengage_steps":2000,"disengage_offset":3.5000}})");
}

TEST(Encoder, WritesAMotionOfAllJoints) {
    JointMove move;
    move.target = {7, {0.0, 90 * kDegree, 0.0, 0.0, 0.0, -10.5 * kDegree, 0.035}};
    move.override_percent = 50;
    EXPECT_EQ(moveText(kWithGripper, move),
              R"({"op":"publish","topic":"/bridge_move","msg":{"move_command":77,"move_type":74,)"
              R"("ovr":50,"delay":0,"remote_tool":0,"cartesian_linear_speed":0.0,"target":)"
              R"({"data_type":74,"cartesian_data":{"x":0.0,"y":0.0,"z":0.0,"a":0.0,"e":0.0,)"
              R"("r":0.0,"config_flags":""},"joints_mask":127,"joints_data":[0.00000,90.00000,)"
              R"(0.00000,0.00000,0.00000,-10.50000,35.00000]},"via":{"data_type":0,)"
              R"("cartesian_data":{"x":0.0,"y":0.0,"z":0.0,"a":0.0,"e":0.0,"r":0.0,)"
              R"("config_flags":""},"joints_mask":0,"joints_data":[]},"tool":{"x":0.0,"y":0.0,)"
              R"("z":0.0,"a":0.0,"e":0.0,"r":0.0},"frame":{"x":0.0,"y":0.0,"z":0.0,"a":0.0,)"
              R"("e":0.0,"r":0.0}}})");
    EXPECT_THAT(cancelText(), HasSubstr("\"move_command\":67"));
}

TEST(Encoder, WritesSetPointsOfOlderSoftware) {
    const JointLayout two{2, false};
    SetPointText text;
    EXPECT_EQ(text.write(classicGeneration(), two, {2, {90 * kDegree, -kDegree}}),
              R"({"op":"publish","topic":"/algo_jnt_ctrl","msg":{"size":2,"joints":[)"
              R"({"position":90.00000,"velocity":0.0,"current":0.0,"ff_velocity":0.0,)"
              R"("ff_current":0.0},{"position":-1.00000,"velocity":0.0,"current":0.0,)"
              R"("ff_velocity":0.0,"ff_current":0.0}]}})");
}

TEST(Encoder, WritesSetPointsOfNewerSoftware) {
    SetPointText text;
    EXPECT_EQ(text.write(externalGeneration(), kWithGripper,
                         {7, {90 * kDegree, 0, 0, 0, 0, -kDegree, 0.08}}),
              R"({"op":"publish","topic":"/external_control","msg":{"position":[90.00000,0.00000,)"
              R"(0.00000,0.00000,0.00000,-1.00000,80.00000],"ff_velocity":)"
              R"([0.0,0.0,0.0,0.0,0.0,0.0,0.0],"ff_current":[0.0,0.0,0.0,0.0,0.0,0.0,0.0]}})");
}

TEST(Encoder, SetPointsOfSixAxesHaveSevenNumbersToo) {
    SetPointText text;
    EXPECT_THAT(
        std::string(text.write(externalGeneration(), kSixAxes, {6, {}})),
        HasSubstr(R"("position":[0.00000,0.00000,0.00000,0.00000,0.00000,0.00000,0.00000])"));
}

TEST(Encoder, DoesNotAllocateForSetPoints) {
    SetPointText text;
    const auto before = allocationCount();
    std::size_t longest = 0;
    for (const auto& generation : {classicGeneration(), externalGeneration()}) {
        for (const double value : {0.0, -1e9, 1.0 / 3.0, 1e-300}) {
            JointSetPoint all{7, {}};
            all.position.fill(value);
            longest = std::max(longest, text.write(generation, kWithGripper, all).size());
        }
    }
    EXPECT_EQ(allocationCount() - before, 0U);
    EXPECT_LT(longest, 1000U);
}

// ---- versions ----

TEST(GenerationOf, KnowsTheVersions) {
    for (const auto* classic : {"edo_2.1.0", "edo_2.4.0", "cube_2.4.0", "edo_3.0.1", "1.0.0"}) {
        ASSERT_TRUE(generationOf(classic)) << classic;
        EXPECT_EQ(generationOf(classic)->kind, Generation::Kind::classic) << classic;
    }
    for (const auto* external : {"edo_3.1.2", "edo_3.2.0", "cube_3.2.0", "3.2.0-rc1"}) {
        ASSERT_TRUE(generationOf(external)) << external;
        EXPECT_EQ(generationOf(external)->kind, Generation::Kind::external) << external;
    }
    for (const auto* unknown :
         {"edo_3.1.0", "edo_3.0.2", "edo_4.0.0", "edo", "", "edo_3.2", "3..1"}) {
        EXPECT_FALSE(generationOf(unknown)) << unknown;
    }
}

TEST(GenerationOf, KnowsHowControlIsTakenAndGivenBack) {
    const auto classic = generationOf("edo_2.4.0").value();
    EXPECT_EQ(classic.take_mode, 1);
    EXPECT_EQ(classic.give_back_mode, 2);
    EXPECT_EQ(classic.taken_state, 9);
    EXPECT_EQ(generationOf("edo_2.1.0")->taken_state, 8);
    const auto external = generationOf("edo_3.2.0").value();
    EXPECT_EQ(external.take_mode, 2);
    EXPECT_EQ(external.give_back_mode, 0);
    EXPECT_EQ(external.taken_state, 10);
}

}  // namespace
}  // namespace metier::edo_driver
