#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <vector>

#include "metier/base/error.hpp"

namespace metier {
namespace {

Result<int> half(int value) {
    if (value % 2 != 0) {
        return fail(Errc::invalid_argument, fmt::format("{} is odd", value));
    }
    return value / 2;
}

Result<> isEven(int value) {
    METIER_TRY(half(value));
    return {};
}

Result<int> quarter(int value) {
    METIER_ASSIGN(const auto halved, half(value));
    METIER_ASSIGN(const auto quartered, half(halved));
    return quartered;
}

TEST(Try, GoesOnWithAValue) {
    EXPECT_TRUE(isEven(4));
    const auto even_twice = []() -> Result<std::string> {
        METIER_TRY(isEven(4));
        METIER_TRY(isEven(6));
        return "both";
    };
    EXPECT_EQ(even_twice(), "both");
}

TEST(Try, LeavesWithTheError) {
    const auto result = isEven(3);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, Errc::invalid_argument);
    EXPECT_EQ(result.error().message, "3 is odd");
}

TEST(Assign, GivesTheValueOrLeavesWithTheError) {
    EXPECT_EQ(quarter(8), 2);
    EXPECT_EQ(quarter(3).error().message, "3 is odd");
    EXPECT_EQ(quarter(6).error().message, "3 is odd");
}

TEST(Assign, TakesCommasAndAnExistingVariable) {
    const auto sum = [](const std::vector<int>& values) -> Result<int> {
        int total = 0;
        for (const int value : values) {
            int part = 0;
            METIER_ASSIGN(part, std::invoke([](int a, int b) { return half(a + b); }, value, 2));
            total += part;
        }
        return total;
    };
    EXPECT_EQ(sum({2, 4}), 5);
    EXPECT_FALSE(sum({2, 3}));
}

/// Counts how often it is copied and made.
struct Counted {
    static inline int copies = 0;
    static inline int made = 0;
    Counted() { ++made; }
    Counted(const Counted& /*other*/) { ++copies; }
    Counted(Counted&&) noexcept = default;
    Counted& operator=(const Counted&) = default;
    Counted& operator=(Counted&&) noexcept = default;
    ~Counted() = default;
};

TEST(Assign, EvaluatesOnceAndMovesTheValue) {
    Counted::copies = Counted::made = 0;
    const auto pass = []() -> Result<Counted> {
        METIER_ASSIGN(auto counted, Result<Counted>(Counted()));
        return counted;
    };
    EXPECT_TRUE(pass());
    EXPECT_EQ(Counted::made, 1);
    EXPECT_EQ(Counted::copies, 0);
    const auto own = []() -> Result<std::unique_ptr<int>> {
        METIER_ASSIGN(auto number, Result<std::unique_ptr<int>>(std::make_unique<int>(7)));
        return number;
    };
    EXPECT_EQ(**own(), 7);
}

TEST(Try, LeavesANamedResultAsItIs) {
    const auto use = [](const Result<std::string>& given) -> Result<std::string> {
        METIER_TRY(given);
        METIER_ASSIGN(const auto& text, given);
        EXPECT_EQ(text, *given);
        return text;
    };
    EXPECT_EQ(use("long enough to be on the heap"), "long enough to be on the heap");
    Result<std::string> failed = fail(Errc::timeout, "late");
    const auto pass = [&]() -> Result<std::string> {
        METIER_ASSIGN(auto text, failed);
        return text;
    };
    EXPECT_EQ(pass().error().message, "late");
    EXPECT_EQ(failed.error().message, "late") << "copied, not moved";
}

TEST(Try, WorksWithinAnother) {
    const auto inner = [](int value) -> Result<int> {
        METIER_ASSIGN(const auto result, half(value));
        return result + 1;
    };
    const auto outer = [&](int value) -> Result<int> {
        METIER_TRY(std::invoke([&]() -> Result<> {
            METIER_TRY(isEven(value));
            return {};
        }));
        METIER_ASSIGN(const auto result, inner(value));
        return result;
    };
    EXPECT_EQ(outer(4), 3);
    EXPECT_FALSE(outer(5));
}

TEST(Try, MayBeACaseOfASwitch) {
    const auto look = [](int value) -> Result<std::string> {
        switch (value) {
            case 3:
                METIER_TRY(isEven(value));
                return "three";
            case 4:
                METIER_TRY(isEven(value));
                return "four";
            default:
                return "many";
        }
    };
    EXPECT_FALSE(look(3));
    EXPECT_EQ(look(4), "four");
    EXPECT_EQ(look(5), "many");
}

/// An error of a layer above, made of one below.
struct Failure : Error {
    Failure(Error error) : Error(std::move(error)) {}  // NOLINT: implicit, as in the layers above
};

TEST(Try, MakesTheErrorThatTheFunctionReturns) {
    const auto above = [](int value) -> tl::expected<int, Failure> {
        METIER_ASSIGN(const auto halved, half(value));
        return halved;
    };
    EXPECT_EQ(above(4), 2);
    EXPECT_EQ(above(3).error().message, "3 is odd");
}

}  // namespace
}  // namespace metier
