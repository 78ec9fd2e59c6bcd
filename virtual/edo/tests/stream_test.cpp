#include <gmock/gmock.h>

#include <cmath>

#include "rig.hpp"

namespace metier::virtual_edo {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

int switchControl(Rig& rig, int mode) {
    return rig.client.call("/algo_control_switch_srv", Json::object({{"mode", mode}}))["result"]
        .get<int>();
}

/// A set-point for every axis, as that software wants it.
void stream(Rig& rig, const std::vector<double>& position) {
    if (rig.software.external_control) {
        auto seven = position;
        seven.resize(7, 0.0);
        rig.client.publish("/external_control",
                           Json::object({{"position", seven},
                                         {"ff_velocity", std::vector<double>(7, 0.0)},
                                         {"ff_current", std::vector<double>(7, 0.0)}}));
        return;
    }
    Json joints = Json::array();
    for (const double value : position) {
        joints.push_back(Json::object({{"position", value}, {"velocity", 0.0}}));
    }
    rig.client.publish("/algo_jnt_ctrl",
                       Json::object({{"size", position.size()}, {"joints", joints}}));
}

std::vector<double> measured(const Rig& rig) {
    std::vector<double> position;
    const Json state = rig.client.last("/usb_jnt_state");
    for (const auto& joint : state["joints"]) {
        position.push_back(joint["position"].get<double>());
    }
    return position;
}

class Stream : public testing::TestWithParam<const char*> {};

TEST_P(Stream, GivesBackEverySetPoint) {
    Rig rig({.software = GetParam()});
    rig.run(2);
    const auto start = measured(rig);
    const bool newer = rig.software.external_control;
    ASSERT_EQ(switchControl(rig, newer ? 2 : 1), 0);
    rig.client.received.clear();
    std::vector<double> sent;
    for (int cycle = 1; cycle <= 200; ++cycle) {
        auto wanted = start;
        wanted[0] += 5.0 * (1.0 - std::cos(cycle * 0.02));
        wanted[4] -= 3.0 * (1.0 - std::cos(cycle * 0.03));
        stream(rig, wanted);
        sent.push_back(wanted[0]);
        rig.run(1);
    }
    rig.run(3);
    const auto states = rig.client.messages("/usb_jnt_state");
    std::size_t found = 0;
    for (const auto& state : states) {
        if (found < sent.size() &&
            std::abs(state["joints"][0]["position"].get<double>() - sent[found]) < 1e-9) {
            ++found;
        }
    }
    EXPECT_EQ(found, sent.size());
    EXPECT_EQ(rig.state(), 2);
    EXPECT_EQ(rig.client.messages("/algorithm_state").size(), newer ? 203U : 0U);
    EXPECT_THAT(rig.client.messages("/cartesian_pose"), IsEmpty());
    // They hold the last target.
    rig.runSeconds(1.0);
    EXPECT_NEAR(measured(rig)[0], sent.back(), 1e-9);
    EXPECT_EQ(switchControl(rig, newer ? 0 : 2), 0);
    rig.runSeconds(0.5);
    EXPECT_NEAR(measured(rig)[0], sent.back(), 1e-9);
    EXPECT_EQ(rig.client.last("/algorithm_state")["data"], 1);
    rig.moveJoints({1});
    EXPECT_TRUE(rig.runUntilState(2));
}

TEST_P(Stream, BrakesWhenNoAxisCouldFollow) {
    Rig rig({.software = GetParam()});
    rig.run(2);
    auto position = measured(rig);
    const bool newer = rig.software.external_control;
    ASSERT_EQ(switchControl(rig, newer ? 2 : 1), 0);
    position[1] += 10.0;
    stream(rig, position);
    rig.run(5);
    EXPECT_EQ(rig.state(), 6);
    const int flags = rig.client.last("/usb_jnt_state")["joints"][1]["commandFlag"].get<int>();
    EXPECT_NE(flags & (1 << 5), 0);
    EXPECT_EQ((flags & (1 << 11)) != 0, newer);  // eight bits before 3.1.2
}

TEST_P(Stream, BrakesWhenAnAxisIsStreamedTooFast) {
    Rig rig({.software = GetParam()});
    rig.run(2);
    auto position = measured(rig);
    ASSERT_EQ(switchControl(rig, rig.software.external_control ? 2 : 1), 0);
    for (int cycle = 0; cycle < 100; ++cycle) {
        position[0] += 0.5;  // 50 deg/s
        stream(rig, position);
        rig.run(1);
    }
    EXPECT_EQ(rig.state(), 6);
}

TEST_P(Stream, IgnoresArraysOfAnotherLength) {
    Rig rig({.software = GetParam()});
    rig.run(2);
    const auto start = measured(rig);
    ASSERT_EQ(switchControl(rig, rig.software.external_control ? 2 : 1), 0);
    Json joints = Json::array();
    for (int i = 0; i < 6; ++i) {
        joints.push_back(Json::object({{"position", 1.0}}));
    }
    rig.client.publish("/algo_jnt_ctrl", Json::object({{"size", 6}, {"joints", joints}}));
    rig.run(5);
    EXPECT_EQ(measured(rig), start);
}

INSTANTIATE_TEST_SUITE_P(Releases, Stream, testing::Values("2.4.0", "3.0.1", "3.1.2", "3.2.0"),
                         [](const auto& tested) {
                             std::string name = tested.param;
                             std::erase(name, '.');
                             return "Release" + name;
                         });

TEST(Control, OfOlderSoftwareIsTakenByOneAndGivenBackByTwo) {
    Rig rig({.software = "2.4.0"});
    rig.run(1);
    EXPECT_EQ(switchControl(rig, 0), 1);
    EXPECT_EQ(switchControl(rig, 2), 1);
    EXPECT_EQ(switchControl(rig, 3), 1);
    EXPECT_EQ(switchControl(rig, 1), 0);
    EXPECT_EQ(switchControl(rig, 1), 1);
    EXPECT_EQ(switchControl(rig, 0), 1);
    EXPECT_EQ(switchControl(rig, 2), 0);
    EXPECT_EQ(rig.robot.state()["algorithm_state"], 0);
    rig.run(1);
    EXPECT_EQ(rig.robot.state()["algorithm_state"], 1);
}

TEST(Control, OfNewerSoftwareIsTakenByOneToFourAndGivenBackByNought) {
    Rig rig;
    rig.run(1);
    EXPECT_EQ(switchControl(rig, 0), 1);
    EXPECT_EQ(switchControl(rig, 5), 1);
    EXPECT_EQ(switchControl(rig, 1), 0);
    EXPECT_EQ(rig.robot.state()["algorithm_state"], 9);
    EXPECT_EQ(switchControl(rig, 1), 1);
    EXPECT_EQ(switchControl(rig, 2), 0);
    EXPECT_EQ(rig.robot.state()["algorithm_state"], 10);
    EXPECT_EQ(switchControl(rig, 2), 1);
    EXPECT_EQ(switchControl(rig, 3), 0);
    EXPECT_EQ(switchControl(rig, 4), 0);
    EXPECT_EQ(switchControl(rig, 0), 0);
    EXPECT_EQ(rig.robot.state()["algorithm_state"], 1);
}

TEST(Control, ByVelocityMovesTheAxes) {
    Rig rig;
    rig.run(2);
    const double start = measured(rig)[0];
    ASSERT_EQ(switchControl(rig, 3), 0);
    rig.client.publish("/external_control",
                       Json::object({{"ff_velocity", {10, 0, 0, 0, 0, 0, 0}}}));
    rig.runSeconds(1.0);
    EXPECT_NEAR(measured(rig)[0], start + 10.0, 0.3);
}

TEST(Control, DropsTheMovesThatWaited) {
    Rig rig;
    ASSERT_EQ(switchControl(rig, 2), 0);
    rig.moveJoints({5});
    rig.moveJoints({6});
    rig.run(20);
    EXPECT_EQ(rig.state(), 3);
    rig.feedback();
    ASSERT_EQ(switchControl(rig, 0), 0);
    rig.run(5);
    EXPECT_EQ(rig.state(), 2);
    EXPECT_THAT(rig.feedback(), ElementsAre(std::pair(2, 30), std::pair(2, 30)));
}

TEST(Control, OfNewerSoftwareIsNotDisturbedByCollisionsOlderIs) {
    for (const auto& [release, state] : {std::pair("3.2.0", 2), std::pair("2.4.0", 6)}) {
        Rig rig({.software = release});
        rig.run(1);
        ASSERT_EQ(switchControl(rig, 1), 0);
        rig.inject("collision");
        rig.run(10);
        EXPECT_EQ(rig.state(), state) << release;
    }
}

TEST(Control, OfNewerSoftwareIsLostWhenTheBrakesCome) {
    Rig rig;
    rig.run(1);
    ASSERT_EQ(switchControl(rig, 2), 0);
    rig.inject("brake");
    rig.run(5);
    EXPECT_EQ(rig.robot.state()["control_taken"], false);
    EXPECT_EQ(switchControl(rig, 0), 1);
}

TEST(Control, TheNodeOfNewerSoftwareFightsWithAClientThatWritesItsTopic) {
    Rig rig;
    rig.run(2);
    auto position = measured(rig);
    ASSERT_EQ(switchControl(rig, 2), 0);
    rig.client.subscribe("/algo_jnt_ctrl");
    for (int cycle = 0; cycle < 200; ++cycle) {
        position[0] += 0.2;
        Json joints = Json::array();
        for (const double value : position) {
            joints.push_back(Json::object({{"position", value}}));
        }
        rig.client.publish("/algo_jnt_ctrl", Json::object({{"size", 7}, {"joints", joints}}));
        rig.run(1);
    }
    EXPECT_EQ(rig.state(), 6);
    EXPECT_EQ(rig.client.messages("/algo_jnt_ctrl").size(), 400U);
}

TEST(Services, TellTheSoftware) {
    Rig rig({.software = "2.4.0"});
    const auto answer = rig.client.call("/machine_bridge_sw_version_srv");
    const auto& nodes = answer["version"]["nodes"];
    EXPECT_EQ(nodes.size(), 4U + 7U);
    EXPECT_EQ(nodes[0]["id"], 0);
    EXPECT_EQ(nodes[1]["id"], 255);
    EXPECT_EQ(nodes[1]["version"].get<std::string>().substr(0, 9), "edo_2.4.0");
    EXPECT_EQ(nodes[10]["id"], 7);
    EXPECT_EQ(answer["tool_id"], 1);
}

TEST(Services, TellTheJoints) {
    Rig cold({.ready = false});
    EXPECT_EQ(cold.client.call("/algo_jnt_number_srv")["counter"], -2);
    Rig rig;
    const auto answer = rig.client.call("/algo_jnt_number_srv");
    EXPECT_EQ(answer["counter"], 7);
    EXPECT_EQ(answer["joints_mask"], 127);
    EXPECT_EQ(answer["joints_aux_mask"], 64);
}

TEST(Services, ComputeKinematicsWhenAsked) {
    Rig rig({.kinematics_services = true});
    const auto pose = rig.client.call(
        "/algo_direct_kinematics_srv",
        Json::object({{"positions", Json::object({{"positions", {0, 0, 90, 0, 0, 0}}})}}));
    EXPECT_NEAR(pose["cartesian_pose"]["x"].get<double>(), 442.5, 1e-4);
    EXPECT_NEAR(pose["cartesian_pose"]["z"].get<double>(), 547.5, 1e-4);
    EXPECT_NEAR(pose["cartesian_pose"]["e"].get<double>(), 90.0, 1e-4);
    const auto joints = rig.client.call("/algo_inverse_kinematics_srv", Json(pose));
    EXPECT_NEAR(joints["positions"]["positions"][2].get<double>(), 90.0, 1e-4);
    auto far = pose;
    far["cartesian_pose"]["x"] = 3000;
    EXPECT_EQ(rig.client.call("/algo_inverse_kinematics_srv", far)["result"], false);
}

}  // namespace
}  // namespace metier::virtual_edo
