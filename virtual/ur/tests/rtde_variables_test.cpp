#include "rtde_variables.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <limits>
#include <string>

#include "rtde_names.hpp"

namespace metier::virtual_ur {
namespace {

TEST(RtdeVariables, EveryOutputOfTheMakerIsKnownWithItsType) {
    for (const auto& [name, type] : kOutputNames) {
        const auto variable = RtdeVariable::output(name);
        ASSERT_TRUE(variable) << name;
        EXPECT_EQ(variable->typeName(), type) << name;
        EXPECT_FALSE(RtdeVariable::input(name)) << name;
    }
    EXPECT_EQ(rtdeOutputs().size(), kOutputNames.size());
}

TEST(RtdeVariables, EveryInputOfTheMakerIsKnownWithItsType) {
    for (const auto& [name, type] : kInputNames) {
        const auto variable = RtdeVariable::input(name);
        ASSERT_TRUE(variable) << name;
        EXPECT_EQ(variable->typeName(), type) << name;
        EXPECT_FALSE(RtdeVariable::output(name)) << name;
    }
    EXPECT_EQ(rtdeInputNames().size(), kInputNames.size());
}

struct RegisterRange {
    std::string_view name;
    int first;
    int last;
    std::string_view type;
};
constexpr std::array kRegisters{
    RegisterRange{"bit_register_", 64, 127, "BOOL"},
    RegisterRange{"int_register_", 0, 47, "INT32"},
    RegisterRange{"double_register_", 0, 47, "DOUBLE"},
};

TEST(RtdeVariables, TogetherWithTheRegistersThereAre419Names) {
    std::size_t names = kOutputNames.size() + kInputNames.size();
    for (const std::string direction : {"input_", "output_"}) {
        for (const auto* packed : {"bit_registers0_to_31", "bit_registers32_to_63"}) {
            EXPECT_EQ(RtdeVariable::output(direction + packed)->typeName(), "UINT32");
            ++names;
        }
        for (const auto& range : kRegisters) {
            for (int i = range.first; i <= range.last; ++i) {
                const auto name = fmt::format("{}{}{}", direction, range.name, i);
                EXPECT_EQ(RtdeVariable::output(name)->typeName(), range.type) << name;
                EXPECT_EQ(RtdeVariable::input(name).has_value(), direction == "input_") << name;
                ++names;
            }
        }
    }
    EXPECT_EQ(names, 419U);
}

TEST(RtdeVariables, NamesThatAreNearlyRegistersAreNotKnown) {
    for (const auto* name :
         {"", "output_int_register_48", "output_double_register_-1", "output_bit_register_63",
          "output_bit_register_128", "output_int_register_", "output_int_register_07",
          "output_int_register_1 ", "output_int_register_99999999999999999999", "Timestamp",
          "output_output_int_register_1", "output_"}) {
        EXPECT_FALSE(RtdeVariable::output(name)) << name;
    }
}

TEST(RtdeVariables, SizesAreThoseOfTheWire) {
    EXPECT_EQ(RtdeVariable::output("timestamp")->size(), 8U);
    EXPECT_EQ(RtdeVariable::output("actual_q")->size(), 48U);
    EXPECT_EQ(RtdeVariable::output("payload_cog")->size(), 24U);
    EXPECT_EQ(RtdeVariable::output("joint_mode")->size(), 24U);
    EXPECT_EQ(RtdeVariable::output("robot_mode")->size(), 4U);
    EXPECT_EQ(RtdeVariable::output("actual_digital_input_bits")->size(), 8U);
    EXPECT_EQ(RtdeVariable::output("output_bit_register_64")->size(), 1U);
    EXPECT_EQ(RtdeVariable::input("standard_digital_output")->size(), 1U);
}

/// Value that a client writes to an input and reads from the register behind it.
template <typename T>
Bytes written(RobotState& state, std::string_view input, T value, std::string_view output) {
    ControlInputs control;
    ByteWriter given;
    given.put(value);
    const Bytes package = given.content();
    ByteReader reader(package);
    RtdeVariable::input(input)->take(reader, {state.inputs, control});
    ByteWriter answer;
    RtdeVariable::output(output)->append(state, answer);
    return answer.content();
}

TEST(RtdeVariables, WhatIsWrittenToAnInputRegisterIsReadBack) {
    RobotState state;
    ByteWriter expected;
    expected.put(std::int32_t{-7}).put(0.5).put(std::uint32_t{0x80000001});
    Bytes all;
    for (const auto& part :
         {written(state, "input_int_register_24", std::int32_t{-7}, "input_int_register_24"),
          written(state, "input_double_register_47", 0.5, "input_double_register_47"),
          written(state, "input_bit_registers32_to_63", std::uint32_t{0x80000001},
                  "input_bit_registers32_to_63")}) {
        all.insert(all.end(), part.begin(), part.end());
    }
    EXPECT_EQ(all, expected.content());
    EXPECT_TRUE(state.inputs.bits[32]);
    EXPECT_TRUE(state.inputs.bits[63]);
}

TEST(RtdeVariables, ANumberThatIsNotFiniteIsNotTaken) {
    RobotState state;
    state.inputs.numbers[0] = 1.5;
    written(state, "input_double_register_0", std::numeric_limits<double>::quiet_NaN(),
            "input_double_register_0");
    EXPECT_EQ(state.inputs.numbers[0], 1.5);
}

}  // namespace
}  // namespace metier::virtual_ur
