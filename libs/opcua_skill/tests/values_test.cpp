// Values of skills as they travel: types, parts, units and diagnostics.
#include "metier/opcua_skill/values.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <string_view>

#include "diagnostic.hpp"
#include "metier/skill/program_observer.hpp"
#include "owner_loss.hpp"
#include "value_part.hpp"

namespace metier::opcua_skill::testing {
namespace {

using opcua::NodeId;
using skill::Frame;
using skill::Value;
using skill::ValueType;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// A value of each type but null.
std::vector<Value> oneOfEach() {
    return {Value(true),
            Value(std::int32_t{-7}),
            Value(std::uint32_t{7}),
            Value(std::uint64_t{1} << 40U),
            Value(0.5),
            Value(std::string("text")),
            Value(Frame{1, 2, 3, 0.1, 0.2, 0.3}),
            Value(skill::Vector3{1, 2, 3}),
            Value(std::vector{0.5, -1.0}),
            Value(std::vector<std::string>{"a", ""}),
            Value(std::vector{skill::Range{-1, 1}, skill::Range{}}),
            Value(std::vector{Frame{}, Frame{1, 2, 3, 0.1, 0.2, 0.3}})};
}

TEST(Values, TravelToAPeerAndBack) {
    for (const auto& value : oneOfEach()) {
        const auto type = skill::typeOf(value);
        const auto travelled = toOpcua(value);
        EXPECT_EQ(fromOpcua(travelled, type).value(), value) << skill::toString(type);
        EXPECT_EQ(valueTypeOf(travelled), type) << skill::toString(type);
        EXPECT_EQ(travelled.dataType(), shapeOf(type).data_type) << skill::toString(type);
        EXPECT_EQ(travelled.isArray(), shapeOf(type).value_rank == 1) << skill::toString(type);
    }
}

TEST(Values, AreNeverConvertedToAnotherType) {
    const auto values = oneOfEach();
    for (const auto& value : values) {
        for (const auto& other : values) {
            const auto wanted = skill::typeOf(other);
            if (wanted == skill::typeOf(value)) {
                continue;
            }
            const auto travelled = toOpcua(value);
            const auto refused = fromOpcua(travelled, wanted);
            ASSERT_FALSE(refused) << travelled.typeName() << " as " << skill::toString(wanted);
            EXPECT_EQ(refused.error().code, Errc::type_mismatch);
            EXPECT_THAT(refused.error().message, HasSubstr(travelled.typeName()));
        }
    }
}

TEST(Values, TheEmptyValueIsNullOfEveryType) {
    EXPECT_TRUE(toOpcua(Value()).isEmpty());
    EXPECT_EQ(valueTypeOf(opcua::Value()), ValueType::null);
    for (const auto& value : oneOfEach()) {
        EXPECT_EQ(fromOpcua(opcua::Value(), skill::typeOf(value)).value(), Value());
    }
}

TEST(Values, OfTypesThatNoSkillHasAreRefused) {
    const auto refused = fromOpcua(opcua::Value::of(std::int8_t{1}), ValueType::null);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::type_mismatch);
    EXPECT_EQ(valueTypeOf(opcua::Value::of(1.5F)), ValueType::null);
    EXPECT_EQ(valueTypeOf(opcua::Value::of(std::vector{NodeId(0, 1U)})), ValueType::null);
}

TEST(Values, ShapesLeadBackToTheirTypes) {
    for (const auto& value : oneOfEach()) {
        const auto type = skill::typeOf(value);
        EXPECT_EQ(valueTypeOf(shapeOf(type)), type) << skill::toString(type);
    }
    EXPECT_EQ(shapeOf(ValueType::null).data_type, opcua::ids::kBaseDataType);
    EXPECT_EQ(shapeOf(ValueType::null).value_rank, -1);
    EXPECT_EQ(valueTypeOf(shapeOf(ValueType::null)), ValueType::null);
    EXPECT_EQ(valueTypeOf(opcua::VariableShape{NodeId(0, 11U), 2}), ValueType::null);  // a matrix
    EXPECT_EQ(valueTypeOf(opcua::VariableShape{NodeId(1, 11U), -1}), ValueType::null);
}

// Ids of UNECE Recommendation 20 as OPC 10000-8 publishes them.
TEST(Values, UnitsHaveTheirPublishedIds) {
    EXPECT_EQ(toOpcua(skill::kMetre).unit_id, 5067858);
    EXPECT_EQ(toOpcua(skill::kMetrePerSecond).unit_id, 5067859);
    EXPECT_EQ(toOpcua(skill::kRadian).unit_id, 4405297);
    EXPECT_EQ(toOpcua(skill::kSecond).unit_id, 5457219);
    EXPECT_EQ(toOpcua(skill::kNewton).unit_id, 5129559);
    EXPECT_EQ(toOpcua(skill::kNewtonMetre).unit_id, 20053);
    EXPECT_EQ(toOpcua(skill::kRadianPerSecond).unit_id, 12865);
    EXPECT_EQ(toOpcua(skill::kKilogram).unit_id, 4933453);
    const auto unit = toOpcua(skill::kNewtonMetre);
    EXPECT_EQ(unit.namespace_uri, "http://www.opcfoundation.org/UA/units/un/cefact");
    EXPECT_EQ(unit.description.text, "newton metre");
    EXPECT_EQ(symbolOf(unit), "N m");
    EXPECT_EQ(symbolOf(toOpcua(skill::kOne)), "");
}

const skill::Field kTarget{.name = "TargetPosition", .type = ValueType::frame};
constexpr Frame kFrame{1, 2, 3, 0.1, 0.2, 0.3};

TEST(ValueParts, OfAFrameAreItsGroupsAndNumbers) {
    const Value frame(kFrame);
    EXPECT_EQ(partOf(frame, Part::whole), opcua::Value::of(kFrame));
    EXPECT_EQ(partOf(frame, Part::position),
              opcua::Value::of(opcua::ThreeDCartesianCoordinates{1, 2, 3}));
    EXPECT_EQ(partOf(frame, Part::orientation),
              opcua::Value::of(opcua::ThreeDOrientation{0.1, 0.2, 0.3}));
    EXPECT_EQ(partOf(frame, Part::y), opcua::Value::of(2.0));
    EXPECT_EQ(partOf(frame, Part::c), opcua::Value::of(0.3));
}

TEST(ValueParts, OfAVectorAreItsNumbersAndNoAngles) {
    const Value vector(skill::Vector3{4, 5, 6});
    EXPECT_EQ(partOf(vector, Part::z), opcua::Value::of(6.0));
    EXPECT_TRUE(partOf(vector, Part::a).isEmpty());
    EXPECT_TRUE(partOf(vector, Part::position).isEmpty());
    EXPECT_TRUE(partOf(Value(0.5), Part::x).isEmpty());
    EXPECT_TRUE(partOf(Value(), Part::x).isEmpty());
}

TEST(ValueParts, AWrittenPartLeavesTheOthers) {
    const auto with = [](Part part, const opcua::Value& value) {
        return withPart(kTarget, Value(kFrame), part, value).value();
    };
    EXPECT_EQ(with(Part::b, opcua::Value::of(-1.0)), Value(Frame{1, 2, 3, 0.1, -1, 0.3}));
    EXPECT_EQ(with(Part::position, opcua::Value::of(opcua::ThreeDCartesianCoordinates{7, 8, 9})),
              Value(Frame{7, 8, 9, 0.1, 0.2, 0.3}));
    EXPECT_EQ(with(Part::orientation, opcua::Value::of(opcua::ThreeDOrientation{})),
              Value(Frame{1, 2, 3, 0, 0, 0}));
    EXPECT_EQ(with(Part::x, opcua::Value()), Value()) << "Null is for the whole value";
}

TEST(ValueParts, APartOfNothingBeginsAtZero) {
    EXPECT_EQ(withPart(kTarget, Value(), Part::z, opcua::Value::of(0.5)).value(),
              Value(Frame{0, 0, 0.5, 0, 0, 0}));
    const skill::Field vector{.name = "Force", .type = ValueType::vector3};
    EXPECT_EQ(withPart(vector, Value(), Part::y, opcua::Value::of(-2.0)).value(),
              Value(skill::Vector3{0, -2, 0}));
}

TEST(ValueParts, OfAnotherTypeAreRefused) {
    for (const auto part : {Part::whole, Part::position, Part::orientation, Part::x, Part::c}) {
        const auto refused = withPart(kTarget, Value(kFrame), part, opcua::Value::of("far"));
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().code, Errc::type_mismatch);
        EXPECT_THAT(refused.error().message, HasSubstr("String"));
    }
    EXPECT_FALSE(withPart(kTarget, Value(kFrame), Part::x, opcua::Value::of(std::int32_t{1})));
    const skill::Field vector{.name = "Force", .type = ValueType::vector3};
    const auto angle = withPart(vector, Value(), Part::a, opcua::Value::of(1.0));
    ASSERT_FALSE(angle);
    EXPECT_THAT(angle.error().message, HasSubstr("Force has no part"));
}

TEST(OwnerLoss, NumbersThatAreNoActionAreRefusedWithTheirLimits) {
    EXPECT_EQ(ownerLossActionFrom(0).value(), skill::OwnerLossAction::skill_default);
    EXPECT_EQ(ownerLossActionFrom(3).value(), skill::OwnerLossAction::keep_going);
    EXPECT_EQ(ownerLossActionFrom(4).error().message, "OnOwnerLoss: 4 is not within 0 to 3");
    EXPECT_EQ(ownerLossActionFrom(-1).error().code, Errc::out_of_range);
}

TEST(Diagnostics, OfAProgramThatNobodyCalledAreEmpty) {
    const auto empty = toOpcua(skill::Diagnostic{});
    EXPECT_TRUE(empty.create_session_id.isNull());
    EXPECT_TRUE(empty.last_method_session_id.isNull());
    EXPECT_EQ(empty.last_method_call, "");
    EXPECT_EQ(empty.last_transition_time, UtcTime::min()) << "null in OPC UA, not 1970";
    EXPECT_THAT(empty.last_method_input_arguments, IsEmpty());
    EXPECT_EQ(empty.last_method_return_status, opcua::status::kGood);
}

TEST(Diagnostics, NameEachInputWithItsTypeAndTheRefusal) {
    skill::Diagnostic diagnostic;
    diagnostic.create_session_id = "no session";
    diagnostic.last_method_call = "Start";
    diagnostic.last_method_inputs = {{"Bounds", Value(std::vector{0.5, 1.0})}, {"Name", Value()}};
    diagnostic.last_method_status = fail(Errc::out_of_range, "too far");
    const auto shown = toOpcua(diagnostic);
    EXPECT_TRUE(shown.create_session_id.isNull());
    ASSERT_THAT(shown.last_method_input_arguments, SizeIs(2));
    EXPECT_EQ(shown.last_method_input_arguments[0].name, "Bounds");
    EXPECT_EQ(shown.last_method_input_arguments[0].data_type, NodeId(0, 11U));
    EXPECT_EQ(shown.last_method_input_arguments[0].value_rank, 1);
    EXPECT_EQ(shown.last_method_input_values[0], opcua::Value::of(std::vector{0.5, 1.0}));
    EXPECT_TRUE(shown.last_method_input_values[1].isEmpty());
    EXPECT_EQ(shown.last_method_return_status, opcua::status::kBadOutOfRange);
    const auto read = [&shown](std::string_view path) {
        const auto items = diagnosticItems();
        return std::ranges::find(items, path, &DiagnosticItem::path)->read(shown);
    };
    EXPECT_EQ(read("/LastMethodReturnStatus"), opcua::Value::of(opcua::status::kBadOutOfRange));
    EXPECT_EQ(read("/LastMethodInputValues").size(), 2U);
}

}  // namespace
}  // namespace metier::opcua_skill::testing
