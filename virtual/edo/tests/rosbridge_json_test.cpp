#include "rosbridge_json.hpp"

#include <gtest/gtest.h>

#include <string>

namespace metier::virtual_edo {
namespace {

std::string nested(int levels) {
    return std::string(static_cast<std::size_t>(levels), '[') +
           std::string(static_cast<std::size_t>(levels), ']');
}

TEST(RosbridgeJson, IsTakenDownToThirtyTwoLevels) {
    EXPECT_TRUE(parseJson(nested(32)).is_array());
    EXPECT_TRUE(parseJson(nested(33)).is_discarded());
    EXPECT_TRUE(parseJson(nested(100'000)).is_discarded());
    const std::string flat = "[" + nested(31) + "," + nested(31) + "]";
    EXPECT_EQ(parseJson(flat).size(), 2U) << "many, but none too deep";
    for (const auto* text : {"", "{", "{\"a\":}", "\xFF", "{} {}"}) {
        EXPECT_TRUE(parseJson(text).is_discarded()) << text;
    }
}

TEST(RosbridgeJson, IsSentAsPlainAscii) {
    EXPECT_EQ(toText("\xC3\xA4"), R"("\u00e4")");
    EXPECT_EQ(toText("\xFF"), R"("\ufffd")") << "text that is no UTF-8";
}

TEST(RosbridgeJson, HasIdsOfTextOrNumber) {
    EXPECT_EQ(requestId({{"id", "call:1"}}), "call:1");
    EXPECT_EQ(requestId({{"id", 7}}), "7");
    EXPECT_EQ(requestId({{"id", nullptr}}), "");
    EXPECT_EQ(requestId({{"id", Json::array({1})}}), "");
    EXPECT_EQ(requestId(Json::object()), "");
}

TEST(RosbridgeJson, HasTextsThatMayOrMayNotBeMissing) {
    EXPECT_EQ(optionalText(Json::object(), "type").value(), "");
    EXPECT_EQ(requiredText(Json::object(), "type").error().message,
              "Expected a type field but none was found.");
    for (const auto& wrong : {Json(nullptr), Json(1), Json::object()}) {
        EXPECT_FALSE(optionalText({{"type", wrong}}, "type"));
        EXPECT_FALSE(requiredText({{"type", wrong}}, "type"));
    }
}

TEST(RosbridgeJson, HasCountsFromNoughtToAThousandMillion) {
    const auto count = [](const std::string& number) {
        return optionalCount(parseJson("{\"n\":" + number + "}"), "n");
    };
    EXPECT_EQ(optionalCount(Json::object(), "n").value(), 0);
    EXPECT_EQ(count("null").value(), 0);
    EXPECT_EQ(count("-5").value(), 0);
    EXPECT_EQ(count("-9223372036854775808").value(), 0);
    EXPECT_EQ(count("12").value(), 12);
    EXPECT_EQ(count("1000000001").value(), 1'000'000'000);
    EXPECT_EQ(count("18446744073709551615").value(), 1'000'000'000);
    for (const auto* wrong : {"1.5", "1e3", "\"5\"", "true", "[]"}) {
        EXPECT_FALSE(count(wrong)) << wrong;
    }
}

}  // namespace
}  // namespace metier::virtual_edo
