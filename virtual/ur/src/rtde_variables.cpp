#include "rtde_variables.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "metier/base/text.hpp"

namespace metier::virtual_ur {

namespace {

constexpr std::array<std::string_view, std::variant_size_v<RtdeValue>> kTypeNames{
    "BOOL", "UINT8", "UINT32", "UINT64", "INT32", "DOUBLE", "VECTOR3D", "VECTOR6D", "VECTOR6INT32"};

using Read = RtdeVariable::Read;
using Write = RtdeVariable::Write;
using State = RobotState;

struct Input {
    std::string_view name;
    RtdeValue type;
    Write write;
};

// ---- inputs ----

template <auto member>
Input control(std::string_view name) {
    using T = std::remove_reference_t<decltype(ControlInputs{}.*member)>;
    return {name, T{}, [](const RtdeInputs& inputs, const RtdeValue& given, std::size_t) {
                inputs.control.*member = std::get<T>(given);
            }};
}
template <std::size_t index>
Input analogOutput(std::string_view name) {
    return {name, 0.0, [](const RtdeInputs& inputs, const RtdeValue& given, std::size_t) {
                inputs.control.standard_analog_output[index] = std::get<double>(given);
            }};
}

using Control = ControlInputs;
const std::array kInputs{
    control<&Control::speed_slider_mask>("speed_slider_mask"),
    control<&Control::speed_slider_fraction>("speed_slider_fraction"),
    control<&Control::standard_digital_output_mask>("standard_digital_output_mask"),
    control<&Control::standard_digital_output>("standard_digital_output"),
    control<&Control::configurable_digital_output_mask>("configurable_digital_output_mask"),
    control<&Control::configurable_digital_output>("configurable_digital_output"),
    control<&Control::tool_digital_output_mask>("tool_digital_output_mask"),
    control<&Control::tool_digital_output>("tool_digital_output"),
    control<&Control::standard_analog_output_mask>("standard_analog_output_mask"),
    control<&Control::standard_analog_output_type>("standard_analog_output_type"),
    analogOutput<0>("standard_analog_output_0"),
    analogOutput<1>("standard_analog_output_1"),
    control<&Control::external_force_torque>("external_force_torque"),
};

// ---- registers ----

/// One kind of general purpose registers.
struct RegisterKind {
    std::string_view prefix;  // of its names, before the number
    std::size_t first;
    std::size_t end;
    RtdeValue type;
    Read read_input;
    Read read_output;
    Write write;
};

template <auto bank, auto values>
RtdeValue readRegister(const State& state, std::size_t i) {
    return RtdeValue((state.*bank.*values)[i]);
}

template <auto values, typename T>
constexpr RegisterKind kindOf(std::string_view prefix, std::size_t first, std::size_t end) {
    return {prefix,
            first,
            end,
            T{},
            readRegister<&State::inputs, values>,
            readRegister<&State::outputs, values>,
            [](const RtdeInputs& to, const RtdeValue& given, std::size_t i) {
                (to.registers.*values)[i] = std::get<T>(given);
            }};
}

/// 32 bits from `first` on as one number.
template <auto bank>
RtdeValue readPacked(const State& state, std::size_t first) {
    std::uint32_t result = 0;
    for (std::size_t i = 0; i < 32; ++i) {
        result |= static_cast<std::uint32_t>((state.*bank).bits[first + i]) << i;
    }
    return result;
}

const RegisterKind kPacked{"bit_registers",
                           0,
                           64,
                           std::uint32_t{},
                           readPacked<&State::inputs>,
                           readPacked<&State::outputs>,
                           [](const RtdeInputs& to, const RtdeValue& given, std::size_t first) {
                               for (std::size_t i = 0; i < 32; ++i) {
                                   to.registers.bits[first + i] =
                                       (std::get<std::uint32_t>(given) >> i & 1U) != 0;
                               }
                           }};

const std::array kKinds{kindOf<&Registers::bits, bool>("bit_register_", 64, 128),
                        kindOf<&Registers::integers, std::int32_t>("int_register_", 0, 48),
                        kindOf<&Registers::numbers, double>("double_register_", 0, 48)};

struct Register {
    const RegisterKind& kind;
    std::size_t number;  // of the first bit for packed ones
};

std::optional<std::size_t> numberAfter(std::string_view name, std::string_view prefix) {
    if (!name.starts_with(prefix)) {
        return std::nullopt;
    }
    name.remove_prefix(prefix.size());
    const bool leading_zero = name.size() > 1 && name.front() == '0';
    return leading_zero ? std::nullopt : numberIn<std::size_t>(name);
}

/// \param name without "input_" or "output_"
std::optional<Register> parseRegister(std::string_view name) {
    if (name == "bit_registers0_to_31" || name == "bit_registers32_to_63") {
        return Register{kPacked, name.find("32_") == std::string_view::npos ? 0U : 32U};
    }
    for (const auto& kind : kKinds) {
        if (const auto i = numberAfter(name, kind.prefix); i && *i >= kind.first && *i < kind.end) {
            return Register{kind, *i};
        }
    }
    return std::nullopt;
}

/// The name without the prefix; empty if it has another one.
std::string_view without(std::string_view prefix, std::string_view name) {
    return name.starts_with(prefix) ? name.substr(prefix.size()) : std::string_view{};
}

bool isFinite(const RtdeValue& given) {
    const auto finite = [](double x) { return std::isfinite(x); };
    if (const auto* one = std::get_if<double>(&given)) {
        return finite(*one);
    }
    const auto* six = std::get_if<Vector6>(&given);
    return six == nullptr || std::all_of(six->begin(), six->end(), finite);
}

}  // namespace

std::optional<RtdeVariable> RtdeVariable::output(std::string_view name) {
    const auto outputs = rtdeOutputs();
    const auto found = std::find_if(outputs.begin(), outputs.end(),
                                    [&](const RtdeOutput& o) { return o.name == name; });
    if (found != outputs.end()) {
        RtdeVariable variable(found->read(RobotState{}, 0), 0);
        variable.read_ = found->read;
        return variable;
    }
    const auto written = parseRegister(without("output_", name));
    const auto given = parseRegister(without("input_", name));
    if (!written && !given) {
        return std::nullopt;
    }
    const auto& [kind, number] = written ? *written : *given;
    RtdeVariable variable(kind.type, number);
    variable.read_ = written ? kind.read_output : kind.read_input;
    return variable;
}

std::optional<RtdeVariable> RtdeVariable::input(std::string_view name) {
    const auto* const found = std::find_if(kInputs.begin(), kInputs.end(),
                                           [&](const Input& i) { return i.name == name; });
    if (found != kInputs.end()) {
        RtdeVariable variable(found->type, 0);
        variable.write_ = found->write;
        return variable;
    }
    const auto parsed = parseRegister(without("input_", name));
    if (!parsed) {
        return std::nullopt;
    }
    RtdeVariable variable(parsed->kind.type, parsed->number);
    variable.write_ = parsed->kind.write;
    return variable;
}

std::string_view RtdeVariable::typeName() const {
    return kTypeNames.at(type_.index());
}

std::size_t RtdeVariable::size() const {
    return std::visit([](const auto& alternative) { return sizeof(alternative); }, type_);
}

void RtdeVariable::append(const RobotState& state, ByteWriter& package) const {
    std::visit(
        [&](const auto& present) {
            if constexpr (std::is_arithmetic_v<std::remove_cvref_t<decltype(present)>>) {
                package.put(present);
            } else {
                package.putAll(present);
            }
        },
        read_(state, number_));
}

void RtdeVariable::take(ByteReader& package, const RtdeInputs& inputs) const {
    RtdeValue given = type_;
    std::visit(
        [&](auto& to) {
            using T = std::remove_cvref_t<decltype(to)>;
            if constexpr (std::is_arithmetic_v<T>) {
                to = package.get<T>();
            } else {
                for (auto& one : to) {
                    one = package.get<typename T::value_type>();
                }
            }
        },
        given);
    if (isFinite(given)) {
        write_(inputs, given, number_);
    }
}

std::vector<std::string> rtdeInputNames() {
    std::vector<std::string> names;
    for (const auto& input : kInputs) {
        names.emplace_back(input.name);
    }
    return names;
}

}  // namespace metier::virtual_ur
