#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "metier/virtual_controller/wire_bytes.hpp"
#include "robot_state.hpp"

namespace metier::virtual_ur {

using virtual_controller::ByteReader;
using virtual_controller::Bytes;
using virtual_controller::ByteWriter;

/// A value of an RTDE variable. The alternative is the variable's type on the wire.
using RtdeValue = std::variant<bool, std::uint8_t, std::uint32_t, std::uint64_t, std::int32_t,
                               double, Vector3, Vector6, std::array<std::int32_t, kAxes>>;

/// Destinations of the inputs of clients.
struct RtdeInputs {
    Registers& registers;
    ControlInputs& control;
};

/// A variable that a client asked for by name.
class RtdeVariable {
public:
    using Read = RtdeValue (*)(const RobotState& state, std::size_t number);
    using Write = void (*)(const RtdeInputs& inputs, const RtdeValue& value, std::size_t number);

    /// The output of that name; empty if there is none.
    static std::optional<RtdeVariable> output(std::string_view name);
    /// The input of that name; empty if there is none.
    static std::optional<RtdeVariable> input(std::string_view name);

    /// Name of the type, such as "VECTOR6D".
    std::string_view typeName() const;
    /// [bytes]
    std::size_t size() const;
    /// Appends the present value. Outputs only.
    void append(const RobotState& state, ByteWriter& package) const;
    /// Takes a value out of a package. Inputs only; a number that is not finite is not taken.
    void take(ByteReader& package, const RtdeInputs& inputs) const;

private:
    RtdeVariable(const RtdeValue& type, std::size_t number) : type_(type), number_(number) {}

    RtdeValue type_;  // value of the variable's type
    std::size_t number_ = 0;
    Read read_ = nullptr;
    Write write_ = nullptr;
};

/// An output and how it is read; what it reads has its type.
struct RtdeOutput {
    std::string_view name;
    RtdeVariable::Read read;
};

/// Every output that has no number.
std::span<const RtdeOutput> rtdeOutputs();

/// Every input that has no number.
std::vector<std::string> rtdeInputNames();

}  // namespace metier::virtual_ur
