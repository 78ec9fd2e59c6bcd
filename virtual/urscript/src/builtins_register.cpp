#include "call.hpp"

namespace metier::urscript {
namespace {

/// Returns the result of the robot's `function` for the register whose number is the first
/// argument.
template <RegisterBank bank, auto function>
Value read(Call& call) {
    const int index = call.integer(0);
    return call.ok() ? call.checked((call.robot().*function)(bank, index)) : Value();
}

Value writeBit(Call& call) {
    const int index = call.integer(0);
    const bool value = call.boolean(1);
    return call.ok() ? call.checked(call.robot().writeBitRegister(index, value)) : Value();
}

Value writeFloat(Call& call) {
    const int index = call.integer(0);
    const double value = call.number(1);
    return call.ok() ? call.checked(call.robot().writeFloatRegister(index, value)) : Value();
}

Value writeInteger(Call& call) {
    const int index = call.integer(0);
    const int value = call.integer(1);
    return call.ok() ? call.checked(call.robot().writeIntegerRegister(index, value)) : Value();
}

}  // namespace

std::span<const Builtin> registerBuiltins() {
    using Bank = RegisterBank;
    static constexpr Builtin kAll[] = {
        {"read_input_boolean_register", "address", 1, read<Bank::input, &Robot::bitRegister>},
        {"read_input_float_register", "address", 1, read<Bank::input, &Robot::floatRegister>},
        {"read_input_integer_register", "address", 1, read<Bank::input, &Robot::integerRegister>},
        {"read_output_boolean_register", "address", 1, read<Bank::output, &Robot::bitRegister>},
        {"read_output_float_register", "address", 1, read<Bank::output, &Robot::floatRegister>},
        {"read_output_integer_register", "address", 1, read<Bank::output, &Robot::integerRegister>},
        {"write_output_boolean_register", "address value", 2, writeBit},
        {"write_output_float_register", "address value", 2, writeFloat},
        {"write_output_integer_register", "address value", 2, writeInteger},
    };
    return kAll;
}

}  // namespace metier::urscript
