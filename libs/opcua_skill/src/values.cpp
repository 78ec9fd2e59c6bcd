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
    Result<skill::Value> (*take)(const opcua::Value& value);
};

constexpr std::array kTypes{
    TypeRow{skill::ValueType::boolean, 1, kScalar, take<bool>},
    TypeRow{skill::ValueType::int32, 6, kScalar, take<std::int32_t>},
    TypeRow{skill::ValueType::uint32, 7, kScalar, take<std::uint32_t>},
    TypeRow{skill::ValueType::uint64, 9, kScalar, take<std::uint64_t>},
    TypeRow{skill::ValueType::number, 11, kScalar, take<double>},
    TypeRow{skill::ValueType::text, 12, kScalar, take<std::string>},
    TypeRow{skill::ValueType::frame, 18814, kScalar, take<opcua::ThreeDFrame>},
    TypeRow{skill::ValueType::vector3, 18808, kScalar, take<opcua::ThreeDVector>},
    TypeRow{skill::ValueType::numbers, 11, kArray, take<std::vector<double>>},
    TypeRow{skill::ValueType::texts, 12, kArray, take<std::vector<std::string>>},
    TypeRow{skill::ValueType::ranges, 884, kArray, take<std::vector<opcua::Range>>},
    TypeRow{skill::ValueType::frames, 18814, kArray, take<std::vector<opcua::ThreeDFrame>>},
};

/// Null for a type that no field has.
const TypeRow* rowOf(skill::ValueType type) {
    const auto* row = std::find_if(kTypes.begin(), kTypes.end(),
                                   [&](const TypeRow& entry) { return entry.type == type; });
    return row == kTypes.end() ? nullptr : row;
}

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
    const auto* row = rowOf(type);
    return row == nullptr
               ? fail(Errc::type_mismatch, fmt::format("{}: no skill takes it", value.typeName()))
               : row->take(value);
}

skill::ValueType valueTypeOf(const opcua::Value& value) {
    return valueTypeOf(opcua::VariableShape{value.dataType(), value.isArray() ? kArray : kScalar});
}

opcua::VariableShape shapeOf(skill::ValueType type) {
    const auto* row = rowOf(type);
    if (row == nullptr) {
        return {opcua::ids::kBaseDataType};
    }
    opcua::VariableShape shape{opcua::NodeId(0, row->data_type), row->rank};
    if (row->rank == kArray) {
        shape.array_dimensions = {0};
    }
    return shape;
}

skill::ValueType valueTypeOf(const opcua::VariableShape& shape) {
    const auto* row = std::find_if(kTypes.begin(), kTypes.end(), [&](const TypeRow& entry) {
        return shape.data_type == opcua::NodeId(0, entry.data_type) &&
               shape.value_rank == entry.rank;
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
