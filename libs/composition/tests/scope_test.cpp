#include "scope.hpp"

#include <gmock/gmock.h>

namespace metier::composition {
namespace {

using skill::Frame;
using skill::Value;
using skill::ValueType;
using ::testing::HasSubstr;

Binding from(Reference reference) {
    return {.line = 3, .key = "k", .source = std::move(reference)};
}

TEST(Scope, TakesOneElementOfEachKindOfValue) {
    const Scope scope({{"F", Frame{1, 2, 3, 4, 5, 6}},
                       {"V", skill::Vector3{1, 2, 3}},
                       {"N", std::vector<double>{7, 8}},
                       {"T", std::vector<std::string>{"a", "b"}},
                       {"L", std::vector<Frame>{Frame{9}}}});
    EXPECT_EQ(scope.read({"", "F", 5}), Value(6.0));
    EXPECT_EQ(scope.read({"", "V", 1}), Value(2.0));
    EXPECT_EQ(scope.read({"", "N", 1}), Value(8.0));
    EXPECT_EQ(scope.read({"", "T", 0}), Value(std::string("a")));
    EXPECT_EQ(scope.read({"", "L", 0}), Value(Frame{9}));
    const auto beyond = scope.read({"", "N", 2});
    ASSERT_FALSE(beyond);
    EXPECT_EQ(beyond.error().code, Errc::out_of_range);
    EXPECT_THAT(beyond.error().message, HasSubstr("there is no N[2] in [7, 8]"));
}

TEST(Scope, ShiftsEachKindOfValue) {
    const Scope scope({{"V", skill::Vector3{1, 2, 3}}, {"N", std::vector<double>{7, 8}}});
    auto vector = from({"", "V", {}});
    vector.shift = {{1.0, {}}, {0.0, {}}, {0.5, {}}};
    EXPECT_EQ(scope.evaluate(vector, ValueType::vector3), Value(skill::Vector3{2, 2, 3.5}));
    auto numbers = from({"", "N", {}});
    numbers.shift = {{1.0, {}}, {-1.0, {}}};
    EXPECT_EQ(scope.evaluate(numbers, ValueType::numbers), Value(std::vector<double>{8, 7}));
    numbers.shift.pop_back();
    EXPECT_FALSE(scope.evaluate(numbers, ValueType::numbers)) << "of another length";
}

TEST(Scope, NamesThePlaceOfWhatIsMissing) {
    const Scope scope({});
    const auto value = scope.evaluate(from({"grasp", "Width", {}}), ValueType::number);
    ASSERT_FALSE(value);
    EXPECT_EQ(value.error().message, "k (line 3): step grasp has no result yet");
}

}  // namespace
}  // namespace metier::composition
