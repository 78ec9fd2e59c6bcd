#include "metier/security/audit_log.hpp"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <future>
#include <sstream>

namespace metier::security {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

SteadyTime soon() {
    return std::chrono::steady_clock::now() + 30s;
}

class AuditFile : public ::testing::Test {
protected:
    AuditFile() { std::filesystem::remove_all(file_.parent_path()); }

    std::unique_ptr<AuditLog> open() {
        return AuditLog::open({.file = file_, .on_write_state = {}}).value();
    }
    static Entry entry(const std::string& event) {
        return {std::chrono::system_clock::now(), event, {{"user", "anna"}}};
    }
    std::string text() const {
        std::ostringstream all;
        all << std::ifstream(file_).rdbuf();
        return all.str();
    }
    void put(const std::string& text) const { std::ofstream(file_, std::ios::binary) << text; }

    const std::filesystem::path file_ =
        std::filesystem::path(::testing::TempDir()) / "audit" /
        ::testing::UnitTest::GetInstance()->current_test_info()->name() / "audit.jsonl";
};

TEST_F(AuditFile, HoldsWhatWasAppendedInItsOrder) {
    {
        const auto log = open();
        log->append(entry("Start"));
        log->append(entry("Halt"));
        ASSERT_TRUE(log->flush(soon()));
        EXPECT_EQ(verify(file_)->entries, 2U);
        log->append(entry("Reset"));
    }
    const auto verified = verify(file_);
    ASSERT_TRUE(verified) << verified.error().message;
    EXPECT_EQ(verified->entries, 3U);
    EXPECT_LT(text().find("Start"), text().find("Halt"));
    EXPECT_LE(verified->first_time, verified->last_time);
}

TEST_F(AuditFile, IsReadByItsOwnerAlone) {
    open()->append(entry("Start"));
    struct stat found {};
    ::stat(file_.c_str(), &found);
    EXPECT_EQ(found.st_mode & 0777U, 0600U);
}

TEST_F(AuditFile, GoesOnAfterARestart) {
    open()->append(entry("Start"));
    open()->append(entry("Halt"));
    const auto verified = verify(file_);
    ASSERT_TRUE(verified) << verified.error().message;
    EXPECT_EQ(verified->entries, 2U);
}

TEST_F(AuditFile, GoesOnAfterWhateverALongName) {
    open()->append(
        {std::chrono::system_clock::now(), "Login", {{"user", std::string(200'000, 'x')}}});
    open()->append(entry("Halt"));
    const auto verified = verify(file_);
    ASSERT_TRUE(verified) << verified.error().message;
    EXPECT_EQ(verified->entries, 2U);
}

TEST_F(AuditFile, TellsWhichLineWasTamperedWith) {
    {
        const auto log = open();
        for (const auto* event : {"Start", "Halt", "Reset"}) {
            log->append(entry(event));
        }
    }
    const auto whole = text();
    auto changed = whole;
    changed.replace(changed.find("Halt"), 4, "Stop");
    put(changed);
    EXPECT_THAT(verify(file_).error().message, HasSubstr("audit.jsonl:2: is not as it was"));
    const auto second = whole.find('\n') + 1;
    const auto third = whole.find('\n', second) + 1;
    put(whole.substr(0, second) + whole.substr(third));
    EXPECT_THAT(verify(file_).error().message, HasSubstr(":2: "));
    put(whole.substr(second));
    EXPECT_THAT(verify(file_).error().message, HasSubstr(":1: "));
    put(whole);
    EXPECT_TRUE(verify(file_));
}

TEST_F(AuditFile, ShowsTextThatWasPutBehindAChainValue) {
    {
        const auto log = open();
        log->append(entry("Start"));
        log->append(entry("Halt"));
    }
    const auto whole = text();
    auto changed = whole;
    changed.insert(changed.find("}\n"), R"(,"user":"bert")");
    put(changed);
    EXPECT_THAT(verify(file_).error().message, HasSubstr("audit.jsonl:1: is not as it was"));
    put(whole.substr(0, whole.size() - 1));
    EXPECT_THAT(verify(file_).error().message, HasSubstr("audit.jsonl:2: is not as it was"))
        << "the end of the line is missing";
}

TEST_F(AuditFile, ShowsThatItsEndWasCutOffToWhoeverKeptTheAnchor) {
    std::string early;
    std::string late;
    {
        const auto log = open();
        EXPECT_EQ(log->anchor(), std::string(64, '0'));
        log->append(entry("Start"));
        ASSERT_TRUE(log->flush(soon()));
        early = log->anchor();
        log->append(entry("Halt"));
        ASSERT_TRUE(log->flush(soon()));
        late = log->anchor();
    }
    EXPECT_EQ(verify(file_)->last_chain, late);
    EXPECT_EQ(open()->anchor(), late) << "after a restart";
    EXPECT_EQ(verify(file_, {early, late})->anchors, (std::set<std::string>{early, late}));
    const auto whole = text();
    put(whole.substr(0, whole.find('\n') + 1));
    const auto cut = verify(file_, {early, late});
    ASSERT_TRUE(cut) << "each line that is left is as it was";
    EXPECT_EQ(cut->anchors, std::set<std::string>{early});
}

TEST_F(AuditFile, DropsALastLineThatIsNotWholeAndSaysSo) {
    open()->append(entry("Start"));
    put(text() + R"({"n":2,"time":"20)");
    open()->append(entry("Halt"));
    const auto verified = verify(file_);
    ASSERT_TRUE(verified) << verified.error().message;
    EXPECT_EQ(verified->entries, 3U);
    EXPECT_THAT(text(), HasSubstr(R"("event":"LineDropped","bytes":"17")"));
}

TEST_F(AuditFile, IsNotMadeOfAnotherFile) {
    std::filesystem::create_directories(file_.parent_path());
    put("notes\n");
    EXPECT_EQ(AuditLog::open({.file = file_, .on_write_state = {}}).error().code,
              Errc::invalid_argument);
    EXPECT_EQ(text(), "notes\n");
    EXPECT_EQ(AuditLog::open({.file = "/proc/none/audit", .on_write_state = {}}).error().code,
              Errc::resource_unavailable);
    EXPECT_EQ(verify("/none").error().code, Errc::not_found);
}

/// Files of this process may not grow beyond a size, as on a full disk.
class FullDisk {
public:
    explicit FullDisk(rlim_t size) {
        ::signal(SIGXFSZ, SIG_IGN);
        ::getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit limit{size, before_.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FullDisk() { end(); }
    void end() { ::setrlimit(RLIMIT_FSIZE, &before_); }

private:
    rlimit before_{};
};

TEST_F(AuditFile, LosesNothingWhileTheDiskIsFullAndTellsThatItIs) {
    std::promise<std::string> failing;
    std::promise<void> writing;
    const auto log = AuditLog::open({.file = file_,
                                     .on_write_state =
                                         [&](WriteState write_state, const auto& why) {
                                             if (write_state == WriteState::failing) {
                                                 failing.set_value(why);
                                             } else {
                                                 writing.set_value();
                                             }
                                         }})
                         .value();
    log->append(entry("Start"));
    ASSERT_TRUE(log->flush(soon()));
    FullDisk disk(static_cast<rlim_t>(std::filesystem::file_size(file_)) + 20);
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < 100; ++i) {
        log->append(entry("Halt"));
    }
    // The disk stays full: whoever waits for it, waits for a second a hundred times.
    EXPECT_LT(std::chrono::steady_clock::now() - begin, 30s) << "whoever appends does not wait";
    auto why = failing.get_future();
    ASSERT_EQ(why.wait_until(soon()), std::future_status::ready);
    EXPECT_THAT(why.get(), HasSubstr("audit.jsonl: "));
    disk.end();
    ASSERT_TRUE(log->flush(soon()));
    EXPECT_EQ(writing.get_future().wait_until(soon()), std::future_status::ready);
    const auto verified = verify(file_);
    ASSERT_TRUE(verified) << verified.error().message;
    EXPECT_EQ(verified->entries, 101U);
}

TEST_F(AuditFile, CountsWhatItCouldNotKeep) {
    auto log = open();
    log->append(entry("Start"));
    ASSERT_TRUE(log->flush(soon()));
    {
        const FullDisk disk(static_cast<rlim_t>(std::filesystem::file_size(file_)));
        for (int i = 0; i < 10'100; ++i) {
            log->append(entry("Halt"));
        }
    }
    ASSERT_TRUE(log->flush(soon()));
    log->append(entry("Reset"));
    log.reset();
    ASSERT_TRUE(verify(file_));
    EXPECT_THAT(text(), HasSubstr(R"("event":"EntriesLost","count":"100")"));
}

TEST_F(AuditFile, DoesNotWaitBeyondADeadlineForAFullDisk) {
    const auto log = open();
    EXPECT_TRUE(log->flush(SteadyTime())) << "there is nothing to wait for";
    log->append(entry("Start"));
    ASSERT_TRUE(log->flush(soon()));
    const auto anchor = log->anchor();
    FullDisk disk(static_cast<rlim_t>(std::filesystem::file_size(file_)));
    log->append(entry("Halt"));
    EXPECT_FALSE(log->flush(std::chrono::steady_clock::now() + 20ms));
    EXPECT_EQ(log->waiting(), 1U);
    EXPECT_EQ(log->anchor(), anchor) << "of what is in the file";
    disk.end();
    EXPECT_TRUE(log->flush(soon()));
    EXPECT_EQ(log->waiting(), 0U);
    EXPECT_NE(log->anchor(), anchor);
}

TEST_F(AuditFile, EndsAlsoWhileTheDiskIsFull) {
    auto log = open();
    log->append(entry("Start"));
    ASSERT_TRUE(log->flush(soon()));
    {
        const FullDisk disk(static_cast<rlim_t>(std::filesystem::file_size(file_)) + 20);
        log->append(entry("Halt"));
        log.reset();
    }
    const auto verified = verify(file_);
    ASSERT_TRUE(verified) << "nothing is left of the line that did not fit";
    EXPECT_EQ(verified->entries, 1U);
}

TEST_F(AuditFile, HasNothingAtFirst) {
    open();
    const auto verified = verify(file_);
    ASSERT_TRUE(verified) << verified.error().message;
    EXPECT_EQ(verified->entries, 0U);
    EXPECT_EQ(verified->first_time, "");
    EXPECT_EQ(verified->last_chain, std::string(64, '0'));
}

}  // namespace
}  // namespace metier::security
