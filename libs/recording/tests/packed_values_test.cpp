#include "packed_values.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "metier/skill/json.hpp"

namespace metier::recording {
namespace {

using skill::Value;
using skill::ValueMap;

/// One of each type, empty and full.
ValueMap everything() {
    return {{"null", {}},
            {"boolean", true},
            {"int32", std::int32_t{-7}},
            {"uint32", std::uint32_t{7}},
            {"uint64", std::numeric_limits<std::uint64_t>::max()},
            {"number", 0.1},
            {"no number", std::numeric_limits<double>::quiet_NaN()},
            {"text", std::string("a \"quote\" and \0 in it", 21)},
            {"frame", Frame{1, 2, 3, 4, 5, 6}},
            {"vector", Vector3{1, 2, 3}},
            {"numbers", std::vector{0.1, -0.2}},
            {"no numbers", std::vector<double>{}},
            {"texts", std::vector<std::string>{"", "one", "two"}},
            {"ranges", std::vector{Range{-1, 1}}},
            {"frames", std::vector{Frame{}, Frame{6, 5, 4, 3, 2, 1}}}};
}

TEST(PackedValues, BecomeTheJsonOfTheValues) {
    std::string bytes = "what was there before";
    pack(everything(), bytes);
    EXPECT_EQ(packedJson(bytes), skill::jsonOf(everything()));
    pack({}, bytes);
    EXPECT_EQ(packedJson(bytes), "{}");
}

TEST(PackedValues, MayBeASingleOne) {
    for (const auto& [name, value] : everything()) {
        EXPECT_EQ(packedJson(packed(value)), skill::jsonOf(value)) << name;
    }
}

TEST(PackedValues, KeepJsonAsItIs) {
    EXPECT_EQ(packedJson(packedText(R"({"started":1})")), R"({"started":1})");
}

TEST(PackedValues, MayBeAnyBytes) {
    std::string bytes;
    pack(everything(), bytes);
    EXPECT_EQ(packedJson(""), "");
    EXPECT_EQ(packedJson("?"), "null");
    for (std::size_t i = 1; i < bytes.size(); ++i) {
        EXPECT_FALSE(packedJson(bytes.substr(0, i)).empty()) << i;
        for (const int bit : {0x01, 0x80, 0xFF}) {
            auto damaged = bytes;
            damaged[i] = static_cast<char>(damaged[i] ^ bit);
            EXPECT_FALSE(packedJson(damaged).empty()) << i;
        }
    }
}

}  // namespace
}  // namespace metier::recording
