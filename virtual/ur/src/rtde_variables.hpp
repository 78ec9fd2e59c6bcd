#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "robot_state.hpp"
#include "wire_bytes.hpp"

namespace metier::virtual_ur {

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

/// Every name that has no number, with whether it is an output or an input.
std::vector<std::string> rtdeOutputNames();
std::vector<std::string> rtdeInputNames();

}  // namespace metier::virtual_ur
