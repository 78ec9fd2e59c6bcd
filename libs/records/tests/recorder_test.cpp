// The recorder while its store is slow, full, away or in use by others.
#include "metier/records/recorder.hpp"

#include <fmt/format.h>
#include <sched.h>
#include <sys/mount.h>
#include <unistd.h>

#include <condition_variable>
#include <fstream>
#include <mutex>
#include <thread>
#include <utility>

#include "recorded.hpp"
#include "sqlite_database.hpp"
#include "temporary_postgres.hpp"

namespace metier::records {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using ::testing::HasSubstr;

/// Reports of a recorder on whether it writes.
class Alarms {
public:
    std::function<void(const WriteReport&)> listener() {
        return [this](const WriteReport& report) {
            {
                const std::lock_guard lock(mutex_);
                reports_.push_back(report);
            }
            changed_.notify_all();
        };
    }
    /// The report of that number, from 0; throws if it does not come.
    WriteReport await(std::size_t number) {
        std::unique_lock lock(mutex_);
        if (!changed_.wait_until(lock, soon(), [&] { return reports_.size() > number; })) {
            throw std::runtime_error("no report " + std::to_string(number));
        }
        return reports_[number];
    }
    std::size_t count() {
        const std::lock_guard lock(mutex_);
        return reports_.size();
    }

private:
    std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<WriteReport> reports_;
};

/// Memory of three executions of moveOf() that wait, and not of a fourth [byte].
constexpr std::size_t kRoomForThree = 3'900;

class TroubledRecorder : public ::testing::Test {
protected:
    explicit TroubledRecorder(fs::path folder = testFolder()) : folder_(std::move(folder)) {}

    Recorder::Options options() {
        Recorder::Options options;
        options.url = file_.string();
        options.server = "urn:test:ur5";
        options.on_write_state = alarms_.listener();
        return options;
    }
    std::unique_ptr<Recorder> make(Recorder::Options options) {
        return Recorder::create(std::move(options)).value();
    }
    std::unique_ptr<Store> store() const { return Store::open(file_.string()).value(); }
    /// Somebody who writes and does not end: the file of a disk that hangs.
    std::unique_ptr<Database> locked() const {
        auto database = SqliteDatabase::open(file_, Store::Access::write).value();
        EXPECT_TRUE(database->begin());
        return database;
    }

    const fs::path folder_;
    const fs::path file_ = folder_ / "records.db";
    Alarms alarms_;
};

TEST_F(TroubledRecorder, KeepsWhatFitsWhileTheStoreIsAwayAndReportsItsLossOnce) {
    fs::create_directories(folder_.parent_path());
    std::ofstream(folder_) << "a file where the folder should be";
    auto few = options();
    few.most_waiting = kRoomForThree;
    const auto recorder = make(std::move(few));
    EXPECT_EQ(alarms_.await(0).write_state, WriteState::failing);
    EXPECT_THAT(alarms_.await(0).text, HasSubstr(file_.string()));
    std::vector<Recorder::Key> keys;
    for (int i = 0; i < 5; ++i) {
        keys.push_back(recorder->begin(moveOf("m-" + std::to_string(i))));
    }
    for (const auto key : keys) {
        recorder->end(key, finished(at(2)));
    }
    EXPECT_EQ(recorder->status().dropped.executions, 2U);
    EXPECT_EQ(recorder->status().waiting, 6U);
    EXPECT_EQ(recorder->status().write_state, WriteState::failing);
    EXPECT_EQ(alarms_.count(), 1U);

    fs::remove(folder_);
    EXPECT_EQ(alarms_.await(1).write_state, WriteState::writing);
    EXPECT_THAT(alarms_.await(1).text, HasSubstr("again"));
    EXPECT_THAT(alarms_.await(1).text, HasSubstr("2 executions"));
    ASSERT_TRUE(recorder->flush(soon()));
    EXPECT_EQ(recorder->status().written, 3U);
    const auto kept = store()->list({}, {})->executions;
    ASSERT_EQ(kept.size(), 3U);
    for (const auto& execution : kept) {
        EXPECT_EQ(execution.state, "Ready") << "an end must not be lost";
    }
    EXPECT_EQ(alarms_.count(), 2U);
}

TEST_F(TroubledRecorder, NeedsNoMoreMemoryForLargeRecordsThanItMay) {
    auto few = options();
    few.most_waiting = 1'000'000;
    const auto recorder = make(std::move(few));
    ASSERT_TRUE(recorder->flush(soon()));
    const auto hanging = locked();
    auto large = moveOf("large");
    large.parameters.assign(300'000, 'x');
    for (int i = 0; i < 10; ++i) {
        recorder->begin(large);
    }
    EXPECT_EQ(recorder->status().dropped.executions, 7U);
    hanging->rollBack();
}

TEST_F(TroubledRecorder, DelaysNobodyWhileTheDiskHangsAndDropsTheOldestSamples) {
    auto few = options();
    few.most_waiting_samples = 64;
    few.patience = 100ms;
    const auto recorder = make(std::move(few));
    const auto key = recorder->begin(moveOf("m-1"));
    ASSERT_TRUE(recorder->flush(soon()));
    constexpr int kSamples = 1'000;
    {
        const auto hanging = locked();
        recorder->transition(key, {.time = at(1),
                                   .from = "Running",
                                   .to = "Suspended",
                                   .sub_state = {},
                                   .step = {},
                                   .reason = {},
                                   .reason_text = {}});
        EXPECT_EQ(alarms_.await(0).write_state, WriteState::failing);
        // The file is locked until the end of this block: no call may wait for it.
        for (int i = 0; i < kSamples; ++i) {
            recorder->sample(key, sampleAt(i, i));
        }
        recorder->end(key, finished(at(2)));
        EXPECT_GE(recorder->status().dropped.samples, kSamples - 2U * 64U);
        EXPECT_FALSE(store()->find("m-1")->isOver());
        hanging->rollBack();
    }
    EXPECT_EQ(alarms_.await(1).write_state, WriteState::writing);
    ASSERT_TRUE(recorder->flush(soon()));
    EXPECT_EQ(store()->find("m-1")->state, "Ready");
    const auto path = store()->path(1).value();
    EXPECT_EQ(path.size() + recorder->status().dropped.samples, kSamples + 0U);
    ASSERT_FALSE(path.empty());
    EXPECT_EQ(path.back().time, kSamples - 1) << "the newest one is kept";
}

TEST_F(TroubledRecorder, CountsWhatAFloodBringsBeyondItsQueueAndReportsItOnce) {
    constexpr std::uint64_t kFlood = 5'000;
    auto few = options();
    few.most_waiting = 100'000;
    const auto recorder = make(std::move(few));
    ASSERT_TRUE(recorder->flush(soon()));
    for (std::uint64_t i = 0; i < kFlood; ++i) {
        recordOne(*recorder, moveOf("m-" + std::to_string(i)), finished(at(1)));
    }
    EXPECT_THAT(alarms_.await(0).text, HasSubstr("more comes than can be written"));
    EXPECT_THAT(alarms_.await(1).text, HasSubstr("recorded again; lost are"));
    ASSERT_TRUE(recorder->flush(soon()));
    const auto status = recorder->status();
    EXPECT_GT(status.dropped.executions, 0U);
    EXPECT_EQ(status.written + status.dropped.executions, kFlood);
    Filter over;
    over.state = "Ready";
    EXPECT_EQ(store()->list(over, {.before = 0, .count = 10'000})->executions.size(),
              status.written)
        << "each has its end";
}

TEST_F(TroubledRecorder, TakesNothingOutOfItsQueueWhileSomethingIsUnwritten) {
    auto few = options();
    few.most_waiting = kRoomForThree;
    const auto recorder = make(std::move(few));
    ASSERT_TRUE(recorder->flush(soon()));
    const auto others = SqliteDatabase::open(file_, Store::Access::write).value();
    ASSERT_TRUE(
        others->script("CREATE TRIGGER refusal BEFORE INSERT ON executions "
                       "BEGIN SELECT RAISE(ABORT, 'refused by the test'); END"));
    recordOne(*recorder, moveOf("m-0"), finished(at(1)));
    EXPECT_THAT(alarms_.await(0).text, HasSubstr("refused by the test"));
    for (int i = 1; i <= 5; ++i) {
        recordOne(*recorder, moveOf("m-" + std::to_string(i)), finished(at(1)));
    }
    EXPECT_FALSE(recorder->flush(std::chrono::steady_clock::now() + 1'500ms))
        << "it tries each second";
    const auto status = recorder->status();
    EXPECT_EQ(status.waiting, 2 * (6U - status.dropped.executions)) << "two messages each";
    EXPECT_GE(status.dropped.executions, 2U);
    ASSERT_TRUE(others->script("DROP TRIGGER refusal"));
    ASSERT_TRUE(recorder->flush(soon()));
    EXPECT_EQ(store()->list({}, {})->executions.size(), 6U - status.dropped.executions);
}

TEST_F(TroubledRecorder, DoesNotAnswerAFlushThatCannotBeDone) {
    const auto recorder = make(options());
    ASSERT_TRUE(recorder->flush(soon()));
    const auto hanging = locked();
    recorder->begin(moveOf("m-1"));
    EXPECT_FALSE(recorder->flush(std::chrono::steady_clock::now() + 300ms));
    hanging->rollBack();
    EXPECT_TRUE(recorder->flush(soon()));
}

TEST_F(TroubledRecorder, WritesWhatWaitsWhenItEnds) {
    {
        const auto recorder = make(options());
        recordOne(*recorder, moveOf("m-1"), finished(at(1)));
    }
    EXPECT_EQ(store()->find("m-1")->state, "Ready");
    EXPECT_EQ(alarms_.count(), 0U);
}

TEST_F(TroubledRecorder, LeavesADamagedFileAsItIs) {
    fs::create_directories(folder_);
    const std::string notes(20'000, 'x');
    std::ofstream(file_) << notes;
    {
        const auto recorder = make(options());
        EXPECT_THAT(alarms_.await(0).text, HasSubstr("is no SQLite file"));
        recordOne(*recorder, moveOf("m-1"), finished(at(1)));
    }
    std::ifstream in(file_);
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), notes);
    EXPECT_EQ(Store::open(file_.string()).error().code, Errc::invalid_argument);
}

TEST_F(TroubledRecorder, ReportsPagesThatAreDamaged) {
    {
        const auto recorder = make(options());
        for (int i = 0; i < 2'000; ++i) {
            recordOne(*recorder, moveOf("m-" + std::to_string(i)), finished(at(1)));
        }
        ASSERT_TRUE(recorder->flush(soon()));
    }
    const auto size = fs::file_size(file_);
    std::fstream file(file_, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(8'192);
    file << std::string(size - 16'384, '\xAA');
    file.close();
    auto opened = Store::open(file_.string());
    const auto listing = opened ? (*opened)->list({}, {}) : Result<Listing>(fail(opened.error()));
    ASSERT_FALSE(listing);
    EXPECT_EQ(listing.error().code, Errc::invalid_argument) << listing.error().message;
    const auto recorder = make(options());
    recordOne(*recorder, moveOf("m-1"), finished(at(1)));
    EXPECT_EQ(alarms_.await(0).write_state, WriteState::failing);
}

TEST_F(TroubledRecorder, ReportsNothingWhileOthersLockTheStoreForAWhile) {
    const auto recorder = make(options());
    recordOne(*recorder, moveOf("m-1"), finished(at(1)));
    ASSERT_TRUE(recorder->flush(soon()));
    const auto others = locked();
    recordOne(*recorder, moveOf("m-2"), finished(at(2)));
    EXPECT_FALSE(recorder->flush(std::chrono::steady_clock::now() + 2'500ms))
        << "SQLite itself waits for 2 s";
    others->rollBack();
    ASSERT_TRUE(recorder->flush(soon()));
    EXPECT_EQ(store()->find("m-2")->state, "Ready");
    EXPECT_EQ(alarms_.count(), 0U);
}

TEST_F(TroubledRecorder, LeavesTheTablesOfOthersAlone) {
    fs::create_directories(folder_);
    ASSERT_TRUE(SqliteDatabase::open(file_, Store::Access::write)
                    .value()
                    ->script("CREATE TABLE songs (title TEXT)"));
    const auto recorder = make(options());
    EXPECT_THAT(alarms_.await(0).text, HasSubstr("other tables"));
    EXPECT_EQ(Store::open(file_.string()).error().code, Errc::invalid_argument);
}

TEST_F(TroubledRecorder, DoesNotTouchALaterSchema) {
    ASSERT_TRUE(make(options())->flush(soon()));
    ASSERT_TRUE(SqliteDatabase::open(file_, Store::Access::write)
                    .value()
                    ->script("UPDATE metier_records SET value = 7 WHERE name = 'schema_version'"));
    const auto refused = Store::open(file_.string());
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::not_supported);
    EXPECT_THAT(refused.error().message, HasSubstr("schema version 7"));
    const auto recorder = make(options());
    EXPECT_THAT(alarms_.await(0).text, HasSubstr("schema version 7"));
}

/// Somebody who is not root, until the end of the block.
class AsNobody {
public:
    AsNobody() { allowed_ = ::getuid() != 0 || ::setresuid(65534, 65534, 0) == 0; }
    ~AsNobody() {
        if (::getuid() == 65534 && ::setresuid(0, 0, 0) != 0) {
            std::abort();
        }
    }
    AsNobody(const AsNobody&) = delete;
    AsNobody& operator=(const AsNobody&) = delete;
    bool allowed() const { return allowed_; }

private:
    bool allowed_ = false;
};

/// Its folder is where anybody may come: others may not enter the home of the user who builds.
class RecorderForOthers : public TroubledRecorder {
protected:
    RecorderForOthers()
        : TroubledRecorder(fs::temp_directory_path() /
                           fmt::format("metier_records_{}", ::getpid())) {
        fs::create_directories(folder_);
    }
    ~RecorderForOthers() override { fs::remove_all(folder_); }
};

TEST_F(RecorderForOthers, InAFolderThatCannotBeWrittenIsReadButNotContinued) {
    {
        const auto recorder = make(options());
        recordOne(*recorder, moveOf("m-1"), finished(at(1)));
    }
    // A reader that may not write finds no files beside it: the last server took them away.
    ASSERT_FALSE(fs::exists(file_.string() + "-wal"));
    fs::permissions(file_, fs::perms::owner_read | fs::perms::group_read | fs::perms::others_read);
    fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec | fs::perms::group_read |
                                 fs::perms::group_exec | fs::perms::others_read |
                                 fs::perms::others_exec);
    {
        const AsNobody nobody;
        if (!nobody.allowed()) {
            GTEST_SKIP() << "NOT TESTED: a folder that cannot be written";
        }
        const auto reading = Store::open(file_.string());
        ASSERT_TRUE(reading) << reading.error().message;
        EXPECT_EQ((*reading)->find("m-1")->state, "Ready");
        const auto recorder = make(options());
        recordOne(*recorder, moveOf("m-2"), finished(at(1)));
        EXPECT_EQ(alarms_.await(0).write_state, WriteState::failing);
        EXPECT_THAT(alarms_.await(0).text, HasSubstr(file_.string()));
    }
    fs::permissions(folder_, fs::perms::owner_all);
}

/// A disk of that size of its own, in a mount namespace of this process.
bool mountSmallDisk(const fs::path& folder, const char* size) {
    fs::create_directories(folder);
    return ::unshare(CLONE_NEWNS) == 0 &&
           ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
           ::mount("tmpfs", folder.c_str(), "tmpfs", 0, size) == 0;
}

TEST_F(TroubledRecorder, ReportsAFullDiskAndGoesOnOnceThereIsRoom) {
    if (!mountSmallDisk(folder_, "size=64k")) {
        GTEST_SKIP() << "A FULL DISK WAS NOT TESTED: to mount one needs root";
    }
    const auto recorder = make(options());
    recordOne(*recorder, moveOf("m-1"), finished(at(1)));
    const auto full = alarms_.await(0);
    EXPECT_EQ(full.write_state, WriteState::failing);
    EXPECT_THAT(full.text, ::testing::AnyOf(HasSubstr("full"), HasSubstr("I/O error")));
    ASSERT_EQ(::mount("tmpfs", folder_.c_str(), "tmpfs", MS_REMOUNT, "size=1m"), 0);
    EXPECT_EQ(alarms_.await(1).write_state, WriteState::writing);
    ASSERT_TRUE(recorder->flush(soon()));
    EXPECT_EQ(store()->find("m-1")->state, "Ready");
    // Full again, now with a store in it.
    std::string large(900'000, 'x');
    auto execution = moveOf("m-2");
    execution.parameters = large;
    recordOne(*recorder, execution, finished(at(2)));
    EXPECT_EQ(alarms_.await(2).write_state, WriteState::failing);
    EXPECT_EQ(store()->find("m-1")->state, "Ready");
    ASSERT_EQ(::mount("tmpfs", folder_.c_str(), "tmpfs", MS_REMOUNT, "size=16m"), 0);
    EXPECT_EQ(alarms_.await(3).write_state, WriteState::writing);
    ASSERT_TRUE(recorder->flush(soon()));
    EXPECT_EQ(store()->find("m-2")->parameters, large);
    EXPECT_EQ(store()->list({}, {})->executions.size(), 2U);
    ::umount2(folder_.c_str(), MNT_DETACH);
}

TEST(RecorderOfPostgres, GoesOnOnceTheDatabaseIsBackWithNothingTwice) {
    auto* postgres = TemporaryPostgres::instance();
    if (postgres == nullptr) {
        GTEST_SKIP() << "PostgreSQL is not installed";
    }
    Alarms alarms;
    Recorder::Options options;
    options.url = postgres->freshDatabase();
    options.server = "urn:test:ur5";
    options.on_write_state = alarms.listener();
    const auto url = options.url;
    const auto recorder = Recorder::create(std::move(options)).value();
    const auto key = recorder->begin(moveOf("m-1"));
    ASSERT_TRUE(recorder->flush(soon()));
    postgres->kill();
    recorder->end(key, finished(at(1)));
    recordOne(*recorder, moveOf("m-2"), halted(at(2), "axis 1"));
    EXPECT_EQ(alarms.await(0).write_state, WriteState::failing);
    EXPECT_EQ(Store::open(url).error().code, Errc::connection_lost);
    postgres->start();
    EXPECT_EQ(alarms.await(1).write_state, WriteState::writing);
    ASSERT_TRUE(recorder->flush(soon()));
    const auto all = Store::open(url).value()->list({}, {})->executions;
    ASSERT_EQ(all.size(), 2U);
    EXPECT_EQ(all[0].reason_text + all[1].reason_text, "axis 1");
    EXPECT_TRUE(all[0].isOver() && all[1].isOver());
}

TEST(RecorderOfPostgres, DoesNotShowItsPassword) {
    Alarms alarms;
    Recorder::Options options;
    options.url = "postgresql://anna:secret@127.0.0.1:1/records";
    options.server = "urn:test:ur5";
    options.on_write_state = alarms.listener();
    const auto recorder = Recorder::create(std::move(options)).value();
    EXPECT_THAT(alarms.await(0).text, ::testing::AllOf(HasSubstr("127.0.0.1:1/records"),
                                                       ::testing::Not(HasSubstr("secret"))));
}

}  // namespace
}  // namespace metier::records
