// Logs that go on in another file.
#include "parts.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <fstream>

#include "metier/security/audit_log.hpp"

namespace metier::security {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class AuditParts : public ::testing::Test {
protected:
    AuditParts() { std::filesystem::remove_all(file_.parent_path()); }

    std::unique_ptr<AuditLog> open() const {
        return AuditLog::open({.file = file_, .on_write_state = {}, .part_size = 1}).value();
    }
    /// Each in a part of its own.
    void append(const std::vector<std::string>& events) const {
        const auto log = open();
        for (const auto& event : events) {
            log->append({std::chrono::system_clock::now(), event, {}});
            ASSERT_TRUE(log->flush(std::chrono::steady_clock::now() + 30s));
        }
    }

    const std::filesystem::path file_ =
        std::filesystem::path(::testing::TempDir()) / "audit_parts" /
        ::testing::UnitTest::GetInstance()->current_test_info()->name() / "arm.log";
};

TEST_F(AuditParts, FollowEachOtherInOneChain) {
    append({"Start", "Halt"});
    append({"Reset"});
    EXPECT_THAT(partsOf(file_), ElementsAre(file_, partOf(file_, 2), partOf(file_, 3)));
    EXPECT_EQ(partOf(file_, 2).filename(), "arm.2.log");
    const auto all = verify(file_);
    ASSERT_TRUE(all) << all.error().message;
    EXPECT_EQ(all->entries, 5U) << "three, and two that tell where the chain goes on";
    EXPECT_EQ(all->first_number, 1U);
    const auto last = verify(partOf(file_, 3));
    ASSERT_TRUE(last) << last.error().message;
    EXPECT_EQ(last->entries, 2U);
    EXPECT_EQ(last->first_number, 4U);
    EXPECT_EQ(last->last_chain, all->last_chain);
}

TEST_F(AuditParts, AreMissedWhenOneIsGone) {
    append({"Start", "Halt", "Reset"});
    std::filesystem::rename(partOf(file_, 2), file_.parent_path() / "kept");
    EXPECT_EQ(verify(file_).error().code, Errc::not_found);
    EXPECT_THAT(verify(file_).error().message, HasSubstr("arm.2.log cannot be read"));
    std::filesystem::rename(partOf(file_, 3), partOf(file_, 2));
    EXPECT_THAT(verify(file_).error().message, HasSubstr("arm.2.log:1: is not as it was written"));
}

TEST_F(AuditParts, AreMissedWhenTheEndOfOneIsCutOff) {
    append({"Start"});
    append({"Halt"});
    std::filesystem::resize_file(file_, 0);
    EXPECT_THAT(verify(file_).error().message, HasSubstr("arm.2.log:1: "));
}

// As after a loss of power.
TEST_F(AuditParts, GoOnAfterOneThatIsEmpty) {
    append({"Start"});
    std::ofstream(partOf(file_, 2)).flush();
    append({"Halt"});
    const auto all = verify(file_);
    ASSERT_TRUE(all) << all.error().message;
    EXPECT_EQ(all->entries, 3U);
}

TEST_F(AuditParts, AreNotOtherFilesOfTheFolder) {
    append({"Start"});
    for (const auto* name : {"arm.x.log", "arm.2x.log", "arm..log", "other.2.log", "arm.2.txt"}) {
        std::ofstream(file_.parent_path() / name) << "notes\n";
    }
    EXPECT_THAT(partsOf(file_), ElementsAre(file_));
}

TEST_F(AuditParts, AreOneServersAlone) {
    const auto log = open();
    const auto second = AuditLog::open({.file = file_, .on_write_state = {}});
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, Errc::resource_unavailable);
    EXPECT_THAT(second.error().message, HasSubstr("arm.log is written by another server"));
}

TEST_F(AuditParts, AreInAFolderForTheirOwnerAlone) {
    open();
    struct stat found {};
    ::stat(file_.parent_path().c_str(), &found);
    EXPECT_EQ(found.st_mode & 0777U, 0700U);
}

TEST_F(AuditParts, AreFoundInTheFolderInWhichAProcessRuns) {
    append({"Start", "Halt"});
    const auto before = std::filesystem::current_path();
    std::filesystem::current_path(file_.parent_path());
    const auto parts = partsOf("arm.log");
    const auto verified = verify("arm.log");
    {
        const auto log = AuditLog::open({.file = "arm.log", .on_write_state = {}, .part_size = 1});
        EXPECT_TRUE(log);
        (*log)->append({std::chrono::system_clock::now(), "Reset", {}});
    }
    std::filesystem::current_path(before);
    EXPECT_THAT(parts, ElementsAre("arm.log", "arm.2.log"));
    ASSERT_TRUE(verified) << verified.error().message;
    EXPECT_EQ(verified->entries, 3U);
    const auto all = verify(file_);
    ASSERT_TRUE(all) << all.error().message;
    EXPECT_EQ(all->entries, 5U) << "it went on at its end";
}

// "arm.20261124.log" is a copy; "arm.02.log" is not a name that the log gives.
TEST_F(AuditParts, AreNotCopiesWithADateInTheirName) {
    append({"Start", "Halt"});
    for (const auto* name : {"arm.20261124.log", "arm.4294967295.log", "arm.02.log", "arm.0.log",
                             "arm.1.log", "arm.1000000.log"}) {
        std::filesystem::copy_file(file_, file_.parent_path() / name);
    }
    EXPECT_THAT(partsOf(file_), ElementsAre(file_, partOf(file_, 2)));
    append({"Reset"});
    const auto all = verify(file_);
    ASSERT_TRUE(all) << all.error().message;
    EXPECT_EQ(all->entries, 5U);
    std::filesystem::rename(file_.parent_path() / "arm.02.log", partOf(file_, 5));
    EXPECT_THAT(verify(file_).error().message, HasSubstr("arm.4.log cannot be read"));
}

TEST_F(AuditParts, GoOnAfterAnIncompleteFirstLine) {
    append({"Start"});
    std::ofstream(partOf(file_, 2)) << R"({"n":2,"ti)";
    append({"Halt"});
    const auto all = verify(file_);
    ASSERT_TRUE(all) << all.error().message;
    EXPECT_GE(all->entries, 4U) << "Start, LineDropped and Halt, and where the chain goes on";
    std::ofstream(partOf(file_, lastPart(file_) + 1)) << "notes\n";
    EXPECT_EQ(AuditLog::open({.file = file_, .on_write_state = {}}).error().code,
              Errc::invalid_argument);
}

TEST_F(AuditParts, StayOneWhereTheNextCannotBeMade) {
    append({"Start"});
    {
        const auto log = open();
        std::filesystem::create_directories(partOf(file_, 2));
        for (const auto* event : {"Halt", "Reset"}) {
            log->append({std::chrono::system_clock::now(), event, {}});
            ASSERT_TRUE(log->flush(std::chrono::steady_clock::now() + 30s));
        }
    }
    std::filesystem::remove(partOf(file_, 2));
    const auto all = verify(file_);
    ASSERT_TRUE(all) << all.error().message;
    EXPECT_EQ(all->entries, 3U);
}

}  // namespace
}  // namespace metier::security
