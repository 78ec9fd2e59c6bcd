// A force move that ends at a sensor's force: what it does when the sensor or its cable fails.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>

#include "metier_program.hpp"
#include "running_cell.hpp"

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;
using skill::Reason;
using skill::State;
using ::testing::HasSubstr;

constexpr auto kNoticed = 5s;

class CellWithASensor : public ::testing::Test {
protected:
    /// A slow move along z with 20 N as its end.
    opcua::Answer<> startMove(double distance) {
        const skill::ValueMap parameters{{"TargetPosition", skill::Frame{0, 0, distance, 0, 0, 0}},
                                         {"Relative", 1},
                                         {"MaxForce", skill::Vector3{20, 0, 0}},
                                         {"SpeedOverride", 0.02}};
        for (const auto& [name, value] : parameters) {
            if (auto set = skill_.set(name, value); !set) {
                return set;
            }
        }
        return skill_.start();
    }

    RunningCell cell_{deviceCell("sensor")};
    std::unique_ptr<opcua::Client> client_ = connectTo(cell_.url("arm"));
    client::SkillHandle skill_ = openSkill(*client_, "CartesianLinearForceMoveSkill");
};

struct SensorFault {
    const char* name;
    const char* fault;
    const char* value;
    const char* text;
    const char* undo;
};

void PrintTo(const SensorFault& fault, std::ostream* out) {
    *out << fault.name;
}

class FaultOfTheSensor : public CellWithASensor,
                         public ::testing::WithParamInterface<SensorFault> {};

TEST_P(FaultOfTheSensor, HaltsAForceMoveAndRefusesAnotherUntilItIsOver) {
    ASSERT_TRUE(startMove(-0.1));
    const auto injected = std::chrono::system_clock::now();
    cell_.inject("netft", GetParam().fault, GetParam().value);
    const auto halted = skill_.awaitEnd(inAMinute()).value();
    EXPECT_EQ(halted.to, State::halted);
    EXPECT_EQ(halted.reason, Reason::error);
    EXPECT_LT(halted.time - injected, kNoticed);
    EXPECT_THAT(halted.reason_text, HasSubstr("failed during the motion"));
    EXPECT_THAT(halted.reason_text, HasSubstr(GetParam().text));
    ASSERT_TRUE(skill_.reset()) << "the arm itself is well";
    const auto refused = startMove(-0.1);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr(GetParam().text));
    cell_.inject("netft", GetParam().undo);
    const auto deadline = inAMinute();
    while (!startMove(-0.1)) {
        ASSERT_LT(std::chrono::steady_clock::now(), deadline) << skill_.reasonText();
    }
    ASSERT_TRUE(skill_.halt());
}

INSTANTIATE_TEST_SUITE_P(
    Netft, FaultOfTheSensor,
    ::testing::Values(SensorFault{"cut_link", "cut-link", "", "no record", "restore-link"},
                      SensorFault{"late_link", "delay", "5000", "no record", "restore-link"},
                      SensorFault{"saturation", "saturation", "", "saturation", "ok"},
                      SensorFault{"too_hot", "temperature-fault", "", "temperature", "ok"},
                      SensorFault{"broken_board", "status", "90000000", "analog board", "ok"}),
    [](const auto& fault) { return std::string(fault.param.name); });

struct Bearable {
    const char* name;
    const char* fault;
    const char* value;
};

void PrintTo(const Bearable& fault, std::ostream* out) {
    *out << fault.name;
}

class BearableFaultOfTheSensor : public CellWithASensor,
                                 public ::testing::WithParamInterface<Bearable> {};

TEST_P(BearableFaultOfTheSensor, LetsAForceMoveGoOnToItsTarget) {
    ASSERT_TRUE(startMove(-0.03));
    cell_.inject("netft", GetParam().fault, GetParam().value);
    const auto end = skill_.awaitEnd(inAMinute()).value();
    EXPECT_EQ(end.to, State::ready) << end.reason_text;
}

INSTANTIATE_TEST_SUITE_P(Netft, BearableFaultOfTheSensor,
                         ::testing::Values(Bearable{"late_link", "delay", "100"},
                                           Bearable{"lost_records", "lose", "50"},
                                           Bearable{"garbled_record", "garble", "1"},
                                           Bearable{"latched_warning", "warning", ""}),
                         [](const auto& fault) { return std::string(fault.param.name); });

// The line and the force that ends it are of one server; the component between them is another.
TEST(CellWithAPress, EndsALineByTheForceOfTheArmsOwnServer) {
    const RunningCell cell(std::filesystem::path(METIER_SOURCE_DIR) / "cells" / "force_move.toml");
    const auto pressed =
        runMetier({"run", cell.url("press"), "CartesianLinearForceMoveSkill", "--json", "--set",
                   "TargetPosition=-0.1,0,0,0,0,0", "--set", "Relative=1", "--set",
                   "MaxForce=20,0,0", "--set", "SpeedOverride=0.05"},
                  Errors::left_out);
    ASSERT_EQ(pressed.status, 0) << pressed.output;
    const auto result = nlohmann::json::parse(pressed.output);
    EXPECT_GE(std::abs(result.at("ForcesExceeded").at("x").get<double>()), 20.0);
    EXPECT_GT(result.at("ReactionTime").get<double>(), 0.0);
    const auto client = connectTo(cell.url("ur5"));
    EXPECT_EQ(openSkill(*client, "CartesianLinearMoveSkill").state().value(), State::ready);
}

}  // namespace
}  // namespace metier::system_tests
