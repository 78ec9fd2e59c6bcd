#include "node_limits.hpp"

#include <fmt/format.h>

#include <array>
#include <string_view>

#include "value_part.hpp"

namespace metier::opcua_skill {

namespace {

/// Names of the parts for messages, in the order of Part.
constexpr std::array<std::string_view, 9> kNames{"", "", "", ".x", ".y", ".z", ".a", ".b", ".c"};

/// Every number of that part.
std::vector<double> numbersOf(const skill::Value& value, Part part) {
    if (const auto* numbers = std::get_if<std::vector<double>>(&value)) {
        return *numbers;
    }
    if (const auto* ranges = std::get_if<std::vector<Range>>(&value)) {
        std::vector<double> numbers;
        for (const auto& range : *ranges) {
            numbers.insert(numbers.end(), {range.low, range.high});
        }
        return numbers;
    }
    const auto number = partOf(value, part).as<double>();
    return number ? std::vector{*number} : std::vector<double>();
}

}  // namespace

void NodeLimits::add(const opcua::AddressSpace& nodes, const opcua::NodeId& node,
                     NodeRole node_role) {
    const auto range =
        nodes.find(node, opcua::QualifiedName{0, "EURange"})
            .and_then([&](const auto& limit) { return nodes.read(limit); })
            .and_then([](const auto& read) { return read.value.template as<Range>(); });
    if (range && range->low < range->high) {
        limits_.push_back({node_role.field, static_cast<Part>(node_role.detail), *range});
    }
}

Result<void> NodeLimits::check(std::uint16_t index, const skill::Field& field,
                               const skill::Value& value) const {
    for (const auto& limit : limits_) {
        if (limit.field != index) {
            continue;
        }
        for (const double number : numbersOf(value, limit.part)) {
            if (!(number < limit.range.low || number > limit.range.high)) {
                continue;  // or is none, which the field's own check refuses
            }
            const auto& unit = limit.part >= Part::a ? skill::kRadian : field.unit;
            return fail(Errc::out_of_range,
                        fmt::format("{}{}: {} is outside {} to {}{}{}", field.name,
                                    kNames.at(static_cast<std::size_t>(limit.part)), number,
                                    limit.range.low, limit.range.high,
                                    unit.symbol.empty() ? "" : " ", unit.symbol));
        }
    }
    return {};
}

}  // namespace metier::opcua_skill
