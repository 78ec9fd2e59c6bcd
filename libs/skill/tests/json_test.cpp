#include "metier/skill/json.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace metier::skill {
namespace {

TEST(Json, TellsEveryKindOfValue) {
    EXPECT_EQ(jsonOf(Value{}), "null");
    EXPECT_EQ(jsonOf(Value{true}), "true");
    EXPECT_EQ(jsonOf(Value{std::int32_t{-3}}), "-3");
    EXPECT_EQ(jsonOf(Value{std::uint64_t{18446744073709551615U}}), "18446744073709551615");
    EXPECT_EQ(jsonOf(Value{0.1}), "0.1");
    EXPECT_EQ(jsonOf(Value{Frame{1, 2, 3, 0.5, 0, -1}}),
              R"({"x":1,"y":2,"z":3,"a":0.5,"b":0,"c":-1})");
    EXPECT_EQ(jsonOf(Value{Vector3{1, 2, 3}}), R"({"x":1,"y":2,"z":3})");
    EXPECT_EQ(jsonOf(Value{std::vector<double>{1, 2.5}}), "[1,2.5]");
    EXPECT_EQ(jsonOf(Value{std::vector<std::string>{"a", "b"}}), R"(["a","b"])");
    EXPECT_EQ(jsonOf(Value{std::vector<Range>{{0, 1}}}), R"([{"low":0,"high":1}])");
    EXPECT_EQ(jsonOf(Value{std::vector<Frame>{}}), "[]");
}

TEST(Json, HasNoNumberThatIsNotFinite) {
    EXPECT_EQ(jsonOf(Value{std::numeric_limits<double>::infinity()}), "null");
    EXPECT_EQ(jsonOf(Value{std::numeric_limits<double>::quiet_NaN()}), "null");
}

TEST(Json, EscapesTexts) {
    EXPECT_EQ(jsonOf(Value{std::string("a\"b\\c\n\x01")}), R"("a\"b\\c\u000a\u0001")");
    EXPECT_EQ(jsonText("\xC3\xBC"), "\"\xC3\xBC\"");
}

TEST(Json, TellsValuesByName) {
    EXPECT_EQ(jsonOf(ValueMap{}), "{}");
    EXPECT_EQ(jsonOf(ValueMap{{"Speed", 0.5}, {"Seam \"1\"", Value{}}}),
              R"({"Seam \"1\"":null,"Speed":0.5})");
}

}  // namespace
}  // namespace metier::skill
