#include "metier/opcua/value.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <open62541/types_generated.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>
#include <nlohmann/json.hpp>
#include <type_traits>
#include <vector>

#include "common/convert.hpp"

namespace metier::opcua {
namespace {

using ::testing::HasSubstr;
using namespace std::chrono_literals;

template <typename T>
class ValueOfEachType : public ::testing::Test {};

template <typename T>
T sample() {
    return T(1);
}
template <>
std::string sample() {
    return "text";
}
template <>
UtcTime sample() {
    return UtcTime(1'700'000'000'123'456'700ns);
}
template <>
Guid sample() {
    return {1, 2, 3, {4, 5, 6, 7, 8, 9, 10, 11}};
}
template <>
ByteString sample() {
    return {{0, 255, 3}};
}
template <>
NodeId sample() {
    return {2, "Skills"};
}
template <>
StatusCode sample() {
    return status::kBadLocked;
}
template <>
QualifiedName sample() {
    return {3, "Start"};
}
template <>
LocalizedText sample() {
    return {"en", "Ready"};
}
template <>
Range sample() {
    return {-1.5, 2.5};
}
template <>
EuInformation sample() {
    return {
        "http://www.opcfoundation.org/UA/units/un/cefact", 5067858, {"en", "m"}, {"en", "metre"}};
}
template <>
ThreeDFrame sample() {
    return {1, 2, 3, 4, 5, 6};
}
template <>
ThreeDVector sample() {
    return {1, 2, 3};
}
template <>
Argument sample() {
    return {"LeaseMs", NodeId(0, 7U), 1, {3}, {"", "Lease [ms]"}};
}
template <>
ThreeDCartesianCoordinates sample() {
    return {1, 2, 3};
}
template <>
ThreeDOrientation sample() {
    return {4, 5, 6};
}
template <>
ProgramDiagnostic sample() {
    return {.create_session_id = {1, 7U},
            .create_client_name = "panel",
            .invocation_creation_time = sample<UtcTime>(),
            .last_transition_time = sample<UtcTime>() + 1s,
            .last_method_call = "Start",
            .last_method_session_id = {1, 8U},
            .last_method_input_arguments = {sample<Argument>()},
            .last_method_output_arguments = {sample<Argument>(), sample<Argument>()},
            .last_method_input_values = {Value::of(2.5), Value()},
            .last_method_output_values = {Value::of("done")},
            .last_method_call_time = sample<UtcTime>() + 2s,
            .last_method_return_status = status::kBadLocked};
}
template <>
KeyValue sample() {
    return {{0, "MaxVelocity"}, Value::of(std::vector<double>{1.0, 2.0})};
}

using Types =
    ::testing::Types<bool, std::int8_t, std::uint8_t, std::int16_t, std::uint16_t, std::int32_t,
                     std::uint32_t, std::int64_t, std::uint64_t, float, double, std::string,
                     UtcTime, Guid, ByteString, NodeId, StatusCode, QualifiedName, LocalizedText,
                     Range, EuInformation, ThreeDFrame, ThreeDVector, ThreeDCartesianCoordinates,
                     ThreeDOrientation, Argument, KeyValue, ProgramDiagnostic>;
TYPED_TEST_SUITE(ValueOfEachType, Types);

TYPED_TEST(ValueOfEachType, KeepsAScalar) {
    const auto value = Value::of(sample<TypeParam>());
    EXPECT_FALSE(value.isArray());
    const auto back = value.template as<TypeParam>();
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(*back, sample<TypeParam>());
}

TYPED_TEST(ValueOfEachType, KeepsAnArray) {
    const std::vector<TypeParam> samples(3, sample<TypeParam>());
    const auto value = Value::of(samples);
    EXPECT_TRUE(value.isArray());
    EXPECT_EQ(value.size(), 3U);
    const auto back = value.template as<std::vector<TypeParam>>();
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(*back, samples);
}

TYPED_TEST(ValueOfEachType, KeepsAnEmptyArray) {
    const auto value = Value::of(std::vector<TypeParam>{});
    EXPECT_TRUE(value.isArray());
    EXPECT_EQ(value.template as<std::vector<TypeParam>>()->size(), 0U);
}

TYPED_TEST(ValueOfEachType, CopiesAreEqualAndIndependent) {
    auto value = Value::of(sample<TypeParam>());
    const Value copy = value;
    EXPECT_EQ(copy, value);
    value = Value();
    EXPECT_EQ(*copy.template as<TypeParam>(), sample<TypeParam>());
    EXPECT_NE(copy, value);
}

TYPED_TEST(ValueOfEachType, IsPrintable) {
    const std::string json = Value::of(sample<TypeParam>()).toJson();
    EXPECT_FALSE(json.empty());
    EXPECT_THAT(json, ::testing::Not(HasSubstr("unprintable")));
}

TEST(Value, IsNullAtFirst) {
    const Value value;
    EXPECT_TRUE(value.isEmpty());
    EXPECT_EQ(value.size(), 0U);
    EXPECT_EQ(value.typeName(), "Null");
    EXPECT_EQ(value.toJson(), "null");
    EXPECT_TRUE(value.dataType().isNull());
    EXPECT_FALSE(value.as<double>());
}

TEST(Value, NamesBothTypesWhenTheyDiffer) {
    const auto wrong = Value::of(std::vector<float>(6, 0.0F)).as<double>();
    ASSERT_FALSE(wrong);
    EXPECT_EQ(wrong.error().code, Errc::type_mismatch);
    EXPECT_EQ(wrong.error().message, "Double expected, Float[6] given");
    EXPECT_EQ(Value::of(true).as<std::vector<double>>().error().message,
              "Double[] expected, Boolean given");
}

TEST(Value, DoesNotConvertNumbers) {
    EXPECT_FALSE(Value::of(std::int32_t{5}).as<double>());
    EXPECT_FALSE(Value::of(std::int32_t{5}).as<std::uint32_t>());
}

TEST(Value, PrintsForPeopleAndAsJson) {
    EXPECT_EQ(Value::of("it's \"ok\"\n").toString(), "it's \"ok\"\xEF\xBF\xBD");
    EXPECT_EQ(Value::of("it's \"ok\"\n").toJson(), "\"it's \\\"ok\\\"\xEF\xBF\xBD\"");
    EXPECT_EQ(Value::of(std::vector<std::int32_t>{1, 2}).toString(), "[1,2]");
    EXPECT_EQ(Value::of(Range{0.5, 1.5}).toJson(), R"({"Low":0.5,"High":1.5})");
}

TEST(Value, PrintsTextThatIsNotUtf8WellFormed) {
    EXPECT_EQ(Value::of("a\xFF").toJson(), "\"a\xEF\xBF\xBD\"");
    const std::string json = Value::of(LocalizedText{"", "a\xFF"}).toJson();
    EXPECT_EQ(json.find('\xFF'), std::string::npos);
    EXPECT_TRUE(json.starts_with('"'));
}

// The stack writes {"Value":{"Body":{"Id":7,"Namespace":}}} for it.
TEST(Value, PrintsANodeIdWithinAVariantAsJson) {
    UA_NodeId node = UA_NODEID_NUMERIC(5, 7);
    UA_DataValue within{};
    UA_Variant_setScalar(&within.value, &node, &UA_TYPES[UA_TYPES_NODEID]);
    within.hasValue = true;
    UA_Variant variant;
    UA_Variant_setArray(&variant, &within, 1, &UA_TYPES[UA_TYPES_DATAVALUE]);
    const auto json = ValueAccess::copyOf(variant).toJson();
    EXPECT_TRUE(nlohmann::json::accept(json)) << json;
    EXPECT_THAT(json, HasSubstr("7"));
}

/// Text of a list that holds one Variant, of no numbers with these dimensions.
std::string jsonOfNothing(std::vector<UA_UInt32> dimensions) {
    UA_Variant within;
    UA_Variant_setArray(&within, UA_EMPTY_ARRAY_SENTINEL, 0, &UA_TYPES[UA_TYPES_INT16]);
    within.arrayDimensions = dimensions.data();
    within.arrayDimensionsSize = dimensions.size();
    UA_DataValue nested{};
    nested.value = within;
    nested.hasValue = true;
    UA_Variant variant;
    UA_Variant_setArray(&variant, &nested, 1, &UA_TYPES[UA_TYPES_DATAVALUE]);
    return ValueAccess::copyOf(variant).toJson();
}

// Decoded as they are: their product is 0 in 64 bits. The stack would read numbers there.
TEST(Value, DoesNotFollowDimensionsThatOverflow) {
    EXPECT_EQ(jsonOfNothing({0x10000, 0x10000, 0x10000, 0x10000}), R"(["unprintable DataValue"])");
    EXPECT_EQ(jsonOfNothing({0xFFFFFFFF, 0xFFFFFFFF, 0}), R"(["unprintable DataValue"])");
    EXPECT_THAT(jsonOfNothing({0, 3}), HasSubstr("[]"));
}

TEST(Value, FindsDimensionsThatDoNotFitInStructures) {
    std::array<UA_UInt32, 4> dimensions{0x10000, 0x10000, 0x10000, 0x10000};
    UA_ProgramDiagnostic2DataType diagnostic{};
    UA_Variant input;
    UA_Variant_setArray(&input, UA_EMPTY_ARRAY_SENTINEL, 0, &UA_TYPES[UA_TYPES_INT16]);
    diagnostic.lastMethodInputValues = &input;
    diagnostic.lastMethodInputValuesSize = 1;
    UA_Variant variant;
    UA_Variant_setScalar(&variant, &diagnostic, &UA_TYPES[UA_TYPES_PROGRAMDIAGNOSTIC2DATATYPE]);
    EXPECT_THAT(ValueAccess::copyOf(variant).toJson(), HasSubstr("LastMethodInputValues"));
    input.arrayDimensions = dimensions.data();
    input.arrayDimensionsSize = dimensions.size();
    EXPECT_EQ(ValueAccess::copyOf(variant).toJson(), "\"unprintable ProgramDiagnostic2DataType\"");
}

TEST(Value, PrintsNumbersThatAreNotFinite) {
    EXPECT_FALSE(Value::of(std::numeric_limits<double>::quiet_NaN()).toJson().empty());
    EXPECT_EQ(Value::of(std::numeric_limits<double>::quiet_NaN()),
              Value::of(std::numeric_limits<double>::quiet_NaN()));
}

TEST(Value, ReadsAnEnumerationAsInt32) {
    UA_ServerState state = UA_SERVERSTATE_SUSPENDED;
    UA_Variant variant;
    UA_Variant_setScalar(&variant, &state, &UA_TYPES[UA_TYPES_SERVERSTATE]);
    EXPECT_EQ(*ValueAccess::copyOf(variant).as<std::int32_t>(), 3);
}

TEST(Value, TakesStructuresOutOfExtensionObjects) {
    UA_Range range{1.0, 2.0};
    UA_ExtensionObject object;
    UA_ExtensionObject_setValueNoDelete(&object, &range, &UA_TYPES[UA_TYPES_RANGE]);
    UA_Variant variant;
    UA_Variant_setArray(&variant, &object, 1, &UA_TYPES[UA_TYPES_EXTENSIONOBJECT]);
    const Value value = ValueAccess::copyOf(variant);
    EXPECT_EQ(value.as<std::vector<Range>>()->at(0), (Range{1.0, 2.0}));
    EXPECT_FALSE(value.as<std::vector<ThreeDFrame>>());
}

TEST(Value, KeepsStructuresItDoesNotKnow) {
    UA_ServerStatusDataType status{};
    UA_Variant variant;
    UA_Variant_setScalar(&variant, &status, &UA_TYPES[UA_TYPES_SERVERSTATUSDATATYPE]);
    const Value value = ValueAccess::copyOf(variant);
    EXPECT_EQ(value.typeName(), "ServerStatusDataType");
    EXPECT_THAT(value.toJson(), HasSubstr("StartTime"));
    EXPECT_EQ(value, Value(value));
}

TEST(Value, KeepsTheEndsOfTime) {
    EXPECT_EQ(*Value::of(UtcTime::max()).as<UtcTime>(), UtcTime::max());
    EXPECT_EQ(*Value::of(UtcTime::min()).as<UtcTime>(), UtcTime::min());
    EXPECT_EQ(*Value::of(UtcTime{}).as<UtcTime>(), UtcTime{});
}

// A message may hold any 64 bits as a time.
TEST(Value, ReadsATimeBeforeAllOthersAsTheEarliest) {
    for (const auto ticks : {std::numeric_limits<UA_DateTime>::min(), UA_DateTime{-1}}) {
        EXPECT_EQ(timeFrom(ticks), UtcTime::min()) << ticks;
    }
    EXPECT_EQ(timeFrom(std::numeric_limits<UA_DateTime>::max()), UtcTime::max());
}

TEST(Matrix, KeepsItsRows) {
    const std::vector<std::vector<double>> rows{{1, 2, 3}, {4, 5, 6}};
    const auto value = Value::ofRows(rows);
    EXPECT_EQ(value.asRows().value(), rows);
    EXPECT_FALSE(value.as<std::vector<double>>()) << "its rows would be lost";
    EXPECT_EQ(Value(value).asRows().value(), rows);
    EXPECT_TRUE(Value::ofRows({}).isEmpty());
    EXPECT_EQ(Value().asRows().value().size(), 0U);
    EXPECT_FALSE(Value::of(std::vector{1.0, 2.0}).asRows());
    EXPECT_FALSE(Value::of(std::string("1")).asRows());
    EXPECT_THROW(Value::ofRows({{1, 2}, {3}}), std::invalid_argument);
}

TEST(Matrix, IsNoneOfOtherDimensions) {
    std::array<double, 6> numbers{1, 2, 3, 4, 5, 6};
    std::array<UA_UInt32, 3> dimensions{};
    UA_Variant variant;
    UA_Variant_setArray(&variant, numbers.data(), numbers.size(), &UA_TYPES[UA_TYPES_DOUBLE]);
    variant.arrayDimensions = dimensions.data();
    const auto rowsOf = [&](const std::vector<UA_UInt32>& sizes) {
        std::copy(sizes.begin(), sizes.end(), dimensions.begin());
        variant.arrayDimensionsSize = sizes.size();
        return ValueAccess::copyOf(variant).asRows();
    };
    EXPECT_EQ(rowsOf({2, 3})->at(1), (std::vector<double>{4, 5, 6}));
    for (const auto& wrong : std::vector<std::vector<UA_UInt32>>{{2, 4}, {3, 3}, {6}, {1, 2, 3}}) {
        const auto rows = rowsOf(wrong);
        ASSERT_FALSE(rows);
        EXPECT_EQ(rows.error().message, "Double matrix expected, Double[6] given");
    }
    EXPECT_FALSE(rowsOf({65'536, 65'536})) << "their product is 0 in 32 bits";
}

TEST(Value, HoldsValuesOfManyTypes) {
    const auto mixed = Value::ofMixed({Value::of(1.5), Value::of("two"), Value()});
    EXPECT_EQ(mixed.typeName(), "Variant[3]");
    EXPECT_EQ(mixed, Value(mixed));
    EXPECT_NE(mixed, Value::ofMixed({Value::of(1.5), Value::of("two")}));
    EXPECT_THAT(mixed.toJson(), HasSubstr("two"));
    EXPECT_TRUE(nlohmann::json::accept(mixed.toJson())) << mixed.toJson();
    EXPECT_EQ(mixed.as<std::vector<double>>().error().code, Errc::type_mismatch);
}

TEST(Value, ReadsASubtypeAsItsBuiltInType) {
    UA_Duration duration = 12.5;
    UA_Variant variant;
    UA_Variant_setScalar(&variant, &duration, &UA_TYPES[UA_TYPES_DURATION]);
    const auto value = ValueAccess::copyOf(variant);
    EXPECT_EQ(value.as<double>(), 12.5);
    EXPECT_FALSE(value.as<float>());
    std::array states{UA_SERVERSTATE_RUNNING, UA_SERVERSTATE_FAILED};
    UA_Variant_setArray(&variant, states.data(), states.size(), &UA_TYPES[UA_TYPES_SERVERSTATE]);
    EXPECT_EQ(ValueAccess::copyOf(variant).as<std::vector<std::int32_t>>(),
              (std::vector<std::int32_t>{0, 1}));
    EXPECT_FALSE(ValueAccess::copyOf(variant).as<std::vector<std::uint32_t>>());
}

// One of the structures is of another type: none of them is taken.
TEST(Value, TakesAllOfAnArrayOrNone) {
    UA_Range range{1.0, 2.0};
    UA_ThreeDVector vector{1.0, 2.0, 3.0};
    std::array<UA_ExtensionObject, 3> objects{};
    UA_ExtensionObject_setValueNoDelete(objects.data(), &range, &UA_TYPES[UA_TYPES_RANGE]);
    UA_ExtensionObject_setValueNoDelete(&objects[1], &vector, &UA_TYPES[UA_TYPES_THREEDVECTOR]);
    UA_Variant variant;
    UA_Variant_setArray(&variant, objects.data(), 2, &UA_TYPES[UA_TYPES_EXTENSIONOBJECT]);
    EXPECT_FALSE(ValueAccess::copyOf(variant).as<std::vector<Range>>());
    UA_Variant_setScalar(&variant, &objects[2], &UA_TYPES[UA_TYPES_EXTENSIONOBJECT]);
    EXPECT_FALSE(ValueAccess::copyOf(variant).as<Range>()) << "it holds nothing";
}

TEST(Value, DropsWhatIsShorterThanATickOfOpcUa) {
    const UtcTime time{1'700'000'000'123'456'789ns};
    EXPECT_EQ(Value::of(time).as<UtcTime>(), UtcTime(1'700'000'000'123'456'700ns));
    const UtcTime before{-1ns};
    EXPECT_EQ(Value::of(before).as<UtcTime>(), UtcTime(-100ns)) << "never later than it was";
}

TEST(DataValue, KeepsOnlyWhatIsGiven) {
    const auto there = [](const DataValue& value) {
        Owned<UA_DataValue> native(UA_TYPES[UA_TYPES_DATAVALUE]);
        toNative(value, *native);
        return fromNative(*native);
    };
    const DataValue whole{Value::of(1.5), status::kBadLocked, sample<UtcTime>(),
                          sample<UtcTime>() + 1s};
    EXPECT_EQ(there(whole), whole);
    EXPECT_EQ(there({}), DataValue{});
    UA_DataValue native{};  // what is there does not count without its flag
    native.status = UA_STATUSCODE_BADLOCKED;
    native.sourceTimestamp = UA_DateTime{1} << 60U;
    native.serverTimestamp = UA_DateTime{1} << 60U;
    EXPECT_EQ(fromNative(native), DataValue{});
}

}  // namespace
}  // namespace metier::opcua
