#include "metier/base/error.hpp"

#include <gtest/gtest.h>

namespace metier {
namespace {

Result<int> half(int value) {
    if (value % 2 != 0) {
        return fail(Errc::invalid_argument, fmt::format("{} is odd", value));
    }
    return value / 2;
}

TEST(Result, HoldsTheValueOfASuccess) {
    EXPECT_EQ(half(4).value(), 2);
}

TEST(Result, TellsCodeAndTextOfAFailure) {
    const auto result = half(3);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, Errc::invalid_argument);
    EXPECT_EQ(result.error().message, "3 is odd");
}

TEST(Errc, HasANameForEveryCode) {
    for (int code = 0; code <= static_cast<int>(Errc::internal); ++code) {
        EXPECT_NE(toString(static_cast<Errc>(code)), "unknown") << code;
    }
}

}  // namespace
}  // namespace metier
