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

TEST(Scope, HasNoElementBeyondTheEndOfAValue) {
    const Scope scope({{"F", Frame{1, 2, 3, 4, 5, 6}},
                       {"V", skill::Vector3{1, 2, 3}},
                       {"N", std::vector<double>{7, 8}},
                       {"T", std::vector<std::string>{"a", "b"}},
                       {"L", std::vector<Frame>{Frame{9}}},
                       {"D", 1.0}});
    struct Case {
        const char* name;
        std::size_t size;
    };
    for (const auto& [name, size] :
         {Case{"F", 6}, Case{"V", 3}, Case{"N", 2}, Case{"T", 2}, Case{"L", 1}, Case{"D", 0}}) {
        for (std::size_t i = 0; i < size; ++i) {
            EXPECT_TRUE(scope.read({"", name, i})) << name << i;
        }
        const auto beyond = scope.read({"", name, size});
        ASSERT_FALSE(beyond) << name;
        EXPECT_EQ(beyond.error().code, Errc::out_of_range);
    }
}

TEST(Scope, ReadsNoNullAndNoNameThatItHasNot) {
    Scope scope({{"Empty", Value{}}});
    scope.setResult("grasp", {{"Width", 0.5}});
    EXPECT_EQ(scope.read({"", "Empty", {}}).error().message, "Empty has no value");
    EXPECT_EQ(scope.read({"", "Width", {}}).error().code, Errc::invalid_argument);
    EXPECT_EQ(scope.read({"grasp", "Held", 1}).error().message, "grasp.Held[1] has no value");
    EXPECT_EQ(scope.read({"grasp", "Width", {}}), Value(0.5));
    scope.setResult("grasp", {{"Width", 0.7}});
    EXPECT_EQ(scope.read({"grasp", "Width", {}}), Value(0.7)) << "of the last time";
}

TEST(Scope, MakesAValueOfTerms) {
    const Scope scope({{"N", 2.0}, {"I", std::int32_t{3}}, {"B", true}});
    Binding list{.line = 3, .key = "k"};
    list.source = std::vector<Term>{
        {1.0, {}}, {0.0, Reference{"", "N", {}}, -2.0}, {0.0, Reference{"", "I", {}}}};
    EXPECT_EQ(scope.evaluate(list, ValueType::vector3), Value(skill::Vector3{1, -4, 3}));
    EXPECT_EQ(scope.evaluate(list, ValueType::numbers), Value(std::vector<double>{1, -4, 3}));
    EXPECT_EQ(scope.evaluate(list, ValueType::frame).error().code, Errc::internal);
    EXPECT_EQ(scope.evaluate(list, ValueType::text).error().code, Errc::internal);
    auto& terms = std::get<std::vector<Term>>(list.source);
    terms.resize(6, {0.5, {}});
    EXPECT_EQ(scope.evaluate(list, ValueType::frame), Value(Frame{1, -4, 3, 0.5, 0.5, 0.5}));
    EXPECT_EQ(scope.evaluate(list, ValueType::vector3).error().code, Errc::internal);
    terms.push_back({0.0, Reference{"", "Missing", {}}});
    EXPECT_EQ(scope.evaluate(list, ValueType::numbers).error().message,
              "k (line 3): Missing has no value");
}

TEST(Scope, ShiftsANumberByOneAndAFrameAlongItsBase) {
    const Scope scope({{"D", 1.5}, {"F", Frame{1, 2, 3, 0, 0, 1}}, {"T", std::string("a")}});
    auto number = from({"", "D", {}});
    number.shift = {{0.25, {}}};
    EXPECT_EQ(scope.evaluate(number, ValueType::number), Value(1.75));
    number.shift.push_back({1.0, {}});
    EXPECT_EQ(scope.evaluate(number, ValueType::number).error().message,
              "k (line 3): 1.5 cannot be shifted by 2 numbers");
    auto frame = from({"", "F", {}});
    frame.shift = {{0.1, {}}, {0.2, {}}, {0.3, {}}};
    EXPECT_EQ(scope.evaluate(frame, ValueType::frame), Value(Frame{1.1, 2.2, 3.3, 0, 0, 1}));
    frame.shift.pop_back();
    EXPECT_FALSE(scope.evaluate(frame, ValueType::frame));
    auto text = from({"", "T", {}});
    text.shift = {{1.0, {}}};
    EXPECT_FALSE(scope.evaluate(text, ValueType::text));
    number.shift = {{0.0, Reference{"", "Missing", {}}}};
    EXPECT_FALSE(scope.evaluate(number, ValueType::number));
}

TEST(Scope, TakesAVectorsShiftWithThreeNumbersAlone) {
    const Scope scope({{"V", skill::Vector3{1, 2, 3}}});
    auto vector = from({"", "V", {}});
    vector.shift = {{1.0, {}}, {0.0, {}}};
    EXPECT_EQ(scope.evaluate(vector, ValueType::vector3).error().code, Errc::invalid_argument);
}

TEST(Scope, ReadsANumberOfAnyType) {
    const Scope scope(
        {{"I", std::int32_t{-3}}, {"U", std::uint64_t{7}}, {"B", true}, {"T", std::string("two")}});
    EXPECT_EQ(scope.number(from({"", "I", {}})), -3.0);
    EXPECT_EQ(scope.number(from({"", "U", {}})), 7.0);
    EXPECT_EQ(scope.number(from({"", "B", {}})).error().message, "k (line 3): is no number");
    EXPECT_EQ(scope.number(from({"", "T", {}})).error().code, Errc::invalid_argument);
    EXPECT_FALSE(scope.number(from({"", "Missing", {}})));
}

Condition comparison(Condition::Kind kind, const char* subject, const char* operand) {
    return {.kind = kind, .subject = {"", subject, {}}, .operand = from({"", operand, {}})};
}

TEST(Scope, ComparesNumbersByTheirValueAndAllElseAsItIs) {
    using Kind = Condition::Kind;
    const Scope scope({{"One", std::uint32_t{1}},
                       {"OnePointZero", 1.0},
                       {"Two", 2.0},
                       {"A", std::string("a")},
                       {"B", std::string("b")},
                       {"F", Frame{1, 2, 3, 0, 0, 0}}});
    EXPECT_EQ(scope.holds(comparison(Kind::is, "One", "OnePointZero")), true);
    EXPECT_EQ(scope.holds(comparison(Kind::is, "One", "Two")), false);
    EXPECT_EQ(scope.holds(comparison(Kind::is, "A", "A")), true);
    EXPECT_EQ(scope.holds(comparison(Kind::is, "A", "B")), false);
    EXPECT_EQ(scope.holds(comparison(Kind::is, "F", "F")), true);
    EXPECT_EQ(scope.holds(comparison(Kind::is, "One", "A")), false);
    EXPECT_EQ(scope.holds(comparison(Kind::less, "One", "Two")), true);
    EXPECT_EQ(scope.holds(comparison(Kind::less, "One", "OnePointZero")), false);
    EXPECT_EQ(scope.holds(comparison(Kind::greater, "Two", "One")), true);
    EXPECT_EQ(scope.holds(comparison(Kind::greater, "One", "OnePointZero")), false);
    EXPECT_EQ(scope.holds(comparison(Kind::less, "One", "A")).error().code, Errc::internal);
    EXPECT_EQ(scope.holds(comparison(Kind::greater, "A", "One")).error().code, Errc::internal);
    EXPECT_EQ(scope.holds(comparison(Kind::is, "Missing", "One")).error().message,
              "k (line 3): Missing has no value");
    EXPECT_EQ(scope.holds(comparison(Kind::is, "One", "Missing")).error().message,
              "k (line 3): Missing has no value");
}

TEST(Scope, JoinsConditionsUpToTheFirstThatDecides) {
    using Kind = Condition::Kind;
    const Scope scope({{"One", 1.0}, {"Two", 2.0}});
    const auto right = comparison(Kind::less, "One", "Two");
    const auto wrong = comparison(Kind::greater, "One", "Two");
    const auto broken = comparison(Kind::is, "Missing", "One");
    const auto joined = [&](Kind kind, std::vector<Condition> parts) {
        return scope.holds({.kind = kind, .parts = std::move(parts)});
    };
    EXPECT_EQ(joined(Kind::all, {right, right}), true);
    EXPECT_EQ(joined(Kind::all, {right, wrong}), false);
    EXPECT_EQ(joined(Kind::all, {wrong, broken}), false);
    EXPECT_FALSE(joined(Kind::all, {right, broken}));
    EXPECT_EQ(joined(Kind::any, {wrong, wrong}), false);
    EXPECT_EQ(joined(Kind::any, {wrong, right}), true);
    EXPECT_EQ(joined(Kind::any, {right, broken}), true);
    EXPECT_FALSE(joined(Kind::any, {wrong, broken}));
    EXPECT_EQ(joined(Kind::negation, {right}), false);
    EXPECT_EQ(joined(Kind::negation, {wrong}), true);
    EXPECT_FALSE(joined(Kind::negation, {broken}));
}

}  // namespace
}  // namespace metier::composition
