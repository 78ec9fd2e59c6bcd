// A copy of all records in a file.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "either_database.hpp"
#include "sqlite_database.hpp"

namespace metier::records {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class ExportedStore : public EitherDatabase {
protected:
    void SetUp() override {
        EitherDatabase::SetUp();
        fs::create_directories(folder_);
    }

    const fs::path folder_ = testFolder("records_copies");
    const std::string copy_ = (folder_ / (std::string("copy_") + GetParam() + ".db")).string();
};
INSTANTIATE_EITHER(ExportedStore);

TEST_P(ExportedStore, IsWholeAlthoughNothingIsInTheFileOfTheStoreYet) {
    const auto recorder = recorderOf(url_);
    auto execution = moveOf("m-1");
    execution.parent = "p-1";
    const auto key = recorder->begin(execution);
    recorder->transition(key, {.time = at(1), .from = "Ready", .to = "Running"});
    recorder->sample(key, sampleAt(0.5, 1.5));
    recorder->end(key, halted(at(2), "axis 1"));
    constexpr int kMore = 1'100;  // more than are copied at once
    for (int i = 0; i < kMore; ++i) {
        recordOne(*recorder, moveOf("n-" + std::to_string(i), at(i)), finished(at(i + 1)));
    }
    ASSERT_TRUE(recorder->flush(soon()));
    const auto exported = Store::open(url_).value()->exportTo(copy_);
    ASSERT_TRUE(exported) << exported.error().message;
    EXPECT_EQ(*exported, kMore + 1U);
    EXPECT_FALSE(fs::exists(copy_ + "-wal"));

    const auto copy = Store::open(copy_).value();
    const auto original = Store::open(url_).value();
    EXPECT_EQ(copy->latestRevision().value(), original->latestRevision().value());
    EXPECT_EQ(copy->list({}, {.before = 0, .count = 10'000})->executions.size(), kMore + 1U);
    const auto found = copy->find("m-1").value();
    EXPECT_EQ(found.number, original->find("m-1")->number);
    EXPECT_EQ(found.reason_text, "axis 1");
    EXPECT_EQ(found.parent, "p-1");
    EXPECT_EQ(found.started, at(0));
    EXPECT_EQ(copy->transitions(found.number)->size(), 1U);
    EXPECT_EQ(copy->path(found.number)->front().actual, sampleAt(0.5, 1.5).actual);
}

TEST_P(ExportedStore, IsOneMomentOfAStoreThatIsBeingWritten) {
    const auto recorder = recorderOf(url_);
    const std::jthread writing([&](const std::stop_token& stop) {
        for (int i = 0; !stop.stop_requested(); ++i) {
            const auto key = recorder->begin(moveOf("m-" + std::to_string(i), at(i)));
            recorder->transition(key, {.time = at(i), .from = "Ready", .to = "Running"});
            recorder->end(key, halted(at(i), "reason " + std::to_string(i)));
            if (i % 100 == 99) {
                recorder->flush(soon());
            }
        }
    });
    ASSERT_TRUE(recorder->flush(soon()));
    for (int round = 0; round < 3; ++round) {
        fs::remove(copy_);
        const auto exported = Store::open(url_).value()->exportTo(copy_);
        ASSERT_TRUE(exported) << exported.error().message;
        const auto copy = SqliteDatabase::open(copy_, Store::Access::read).value();
        const auto count = [&](const char* sql) { return copy->query(sql)->front().integer(0); };
        EXPECT_EQ(count("SELECT count(*) FROM history"), count("SELECT count(*) FROM executions"))
            << "each has its kind and its note";
        EXPECT_EQ(count("SELECT count(*) FROM executions"), static_cast<std::int64_t>(*exported));
        EXPECT_EQ(count("SELECT count(*) FROM executions WHERE number NOT IN "
                        "(SELECT part / 1048576 FROM parts) AND "
                        "number < (SELECT max(number) FROM executions)"),
                  0)
            << "each but the newest, which may have begun only, has its part";
        EXPECT_EQ(count("SELECT count(*) FROM parts WHERE part / 1048576 NOT IN "
                        "(SELECT number FROM executions)"),
                  0);
    }
}

TEST_P(ExportedStore, IsContinuedByAServer) {
    {
        const auto recorder = recorderOf(url_);
        recordOne(*recorder, moveOf("m-1"), finished(at(1)));
    }
    ASSERT_TRUE(Store::open(url_).value()->exportTo(copy_));
    const auto recorder = recorderOf(copy_);
    recordOne(*recorder, moveOf("m-2"), finished(at(2)));
    ASSERT_TRUE(recorder->flush(soon()));
    EXPECT_EQ(Store::open(copy_).value()->find("m-2")->number, 2);
}

TEST_P(ExportedStore, OverwritesNothing) {
    ASSERT_TRUE(recorderOf(url_)->flush(soon()));
    std::ofstream(copy_) << "mine";
    const auto refused = Store::open(url_).value()->exportTo(copy_);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::already_exists);
    EXPECT_THAT(refused.error().message, HasSubstr(copy_));
    EXPECT_EQ(fs::file_size(copy_), 4U);
}

TEST_P(ExportedStore, LeavesNothingWhereItCannotBe) {
    ASSERT_TRUE(recorderOf(url_)->flush(soon()));
    std::ofstream(copy_) << "a file where the folder should be";
    const auto refused = Store::open(url_).value()->exportTo(copy_ + "/copy.db");
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr(copy_));
}

}  // namespace
}  // namespace metier::records
