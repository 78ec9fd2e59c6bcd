#include "metier/opcua_skill/values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <type_traits>
#include <utility>

namespace metier::opcua_skill {

namespace {

constexpr std::string_view kUnitNamespace = "http://www.opcfoundation.org/UA/units/un/cefact";
constexpr std::int32_t kScalar = -1;
constexpr std::int32_t kArray = 1;

template <typename T>
Result<skill::Value> take(const opcua::Value& value) {
    METIER_ASSIGN(auto taken, value.as<T>());
    return skill::Value(std::move(taken));
}

/// One row per type of value: where to look it up by its data type.
struct TypeRow {
    skill::ValueType type;
    std::uint32_t data_type;  ///< numeric id in namespace 0
    std::int32_t rank;
};

constexpr std::array kTypes{
    TypeRow{skill::ValueType::boolean, 1, kScalar},
    TypeRow{skill::ValueType::int32, 6, kScalar},
    TypeRow{skill::ValueType::uint32, 7, kScalar},
    TypeRow{skill::ValueType::uint64, 9, kScalar},
    TypeRow{skill::ValueType::number, 11, kScalar},
    TypeRow{skill::ValueType::text, 12, kScalar},
    TypeRow{skill::ValueType::frame, 18814, kScalar},
    TypeRow{skill::ValueType::vector3, 18808, kScalar},
    TypeRow{skill::ValueType::numbers, 11, kArray},
    TypeRow{skill::ValueType::texts, 12, kArray},
    TypeRow{skill::ValueType::ranges, 884, kArray},
    TypeRow{skill::ValueType::frames, 18814, kArray},
};

std::int32_t unitId(std::string_view code) {
    std::int32_t id = 0;
    for (const char letter : code) {
        id = id * 256 + static_cast<unsigned char>(letter);
    }
    return id;
}

}  // namespace

opcua::Value toOpcua(const skill::Value& value) {
    return std::visit(
        [](const auto& held) {
            using Held = std::decay_t<decltype(held)>;
            if constexpr (std::is_same_v<Held, std::monostate>) {
                return opcua::Value();
            } else {
                return opcua::Value::of(held);
            }
        },
        value);
}

Result<skill::Value> fromOpcua(const opcua::Value& value, skill::ValueType type) {
    if (value.isEmpty()) {
        return skill::Value();
    }
    switch (type) {
        case skill::ValueType::boolean:
            return take<bool>(value);
        case skill::ValueType::int32:
            return take<std::int32_t>(value);
        case skill::ValueType::uint32:
            return take<std::uint32_t>(value);
        case skill::ValueType::uint64:
            return take<std::uint64_t>(value);
        case skill::ValueType::number:
            return take<double>(value);
        case skill::ValueType::text:
            return take<std::string>(value);
        case skill::ValueType::frame:
            return take<opcua::ThreeDFrame>(value);
        case skill::ValueType::vector3:
            return take<opcua::ThreeDVector>(value);
        case skill::ValueType::numbers:
            return take<std::vector<double>>(value);
        case skill::ValueType::texts:
            return take<std::vector<std::string>>(value);
        case skill::ValueType::ranges:
            return take<std::vector<opcua::Range>>(value);
        case skill::ValueType::frames:
            return take<std::vector<opcua::ThreeDFrame>>(value);
        case skill::ValueType::null:
            break;
    }
    return fail(Errc::type_mismatch, fmt::format("{}: no skill takes it", value.typeName()));
}

skill::ValueType valueTypeOf(const opcua::Value& value) {
    return valueTypeOf(VariableShape{value.dataType(), value.isArray() ? kArray : kScalar});
}

VariableShape shapeOf(skill::ValueType type) {
    const auto* row = std::find_if(kTypes.begin(), kTypes.end(),
                                   [&](const TypeRow& entry) { return entry.type == type; });
    if (row == kTypes.end()) {
        return {opcua::NodeId(0, 24), kScalar};
    }
    return {opcua::NodeId(0, row->data_type), row->rank};
}

skill::ValueType valueTypeOf(const VariableShape& shape) {
    const auto* row = std::find_if(kTypes.begin(), kTypes.end(), [&](const TypeRow& entry) {
        return shape == VariableShape{opcua::NodeId(0, entry.data_type), entry.rank};
    });
    return row == kTypes.end() ? skill::ValueType::null : row->type;
}

opcua::EuInformation toOpcua(const skill::Unit& unit) {
    return {std::string(kUnitNamespace),
            unitId(unit.code),
            {"en", std::string(unit.symbol)},
            {"en", std::string(unit.name)}};
}

std::string symbolOf(const opcua::EuInformation& unit) {
    return unit.display_name.text;
}

}  // namespace metier::opcua_skill
