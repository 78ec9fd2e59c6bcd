#pragma once

#include <gmock/gmock.h>

#include <string>

#include "recorded.hpp"
#include "temporary_postgres.hpp"

namespace metier::records {

/// A store that is not there yet, in a file and in a PostgreSQL database.
class EitherDatabase : public ::testing::TestWithParam<const char*> {
protected:
    void SetUp() override {
        url_ = fresh();
        if (url_.empty()) {
            GTEST_SKIP() << "PostgreSQL is not installed";
        }
    }
    static bool isFile() { return GetParam() == std::string("Sqlite"); }
    /// Another one; empty: PostgreSQL is not installed.
    static std::string fresh() {
        if (isFile()) {
            return (testFolder() / "records.db").string();
        }
        auto* postgres = TemporaryPostgres::instance();
        return postgres == nullptr ? std::string() : postgres->freshDatabase();
    }

    std::string url_;
};

}  // namespace metier::records

/// Runs the tests of that suite with both databases.
#define INSTANTIATE_EITHER(suite)                                                \
    INSTANTIATE_TEST_SUITE_P(Of, suite, ::testing::Values("Sqlite", "Postgres"), \
                             [](const auto& test) { return std::string(test.param); })
