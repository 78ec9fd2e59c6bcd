#include "server_locks.hpp"

#include <sys/stat.h>

#include "recorded.hpp"

namespace metier::records {
namespace {

/// Two programs that record into one file.
class TwoHolders : public ::testing::Test {
protected:
    static std::string freshFile() {
        const auto folder = testFolder();
        std::filesystem::create_directories(folder);
        return (folder / "records.db-servers").string();
    }

    const std::string file_ = freshFile();
    std::shared_ptr<ServerLocks> one_ = ServerLocks::open(file_).value();
    std::shared_ptr<ServerLocks> other_ = ServerLocks::open(file_).value();
};

TEST_F(TwoHolders, SeeTheNamesOfTheOtherAlone) {
    ASSERT_TRUE(one_->hold("urn:ur5"));
    EXPECT_TRUE(other_->isHeldByOthers("urn:ur5").value());
    EXPECT_FALSE(one_->isHeldByOthers("urn:ur5").value()) << "its own";
    EXPECT_FALSE(other_->isHeldByOthers("urn:edo").value());
    EXPECT_FALSE(other_->isHeldByOthers("").value());
}

TEST_F(TwoHolders, MayHoldOneNameTogether) {
    ASSERT_TRUE(one_->hold("urn:ur5"));
    ASSERT_TRUE(other_->hold("urn:ur5"));
    EXPECT_TRUE(one_->isHeldByOthers("urn:ur5").value());
    EXPECT_TRUE(other_->isHeldByOthers("urn:ur5").value());
}

TEST_F(TwoHolders, FreeTheirNamesWhenTheyGo) {
    ASSERT_TRUE(one_->hold("urn:ur5"));
    ASSERT_TRUE(one_->hold("urn:edo"));
    { const auto looking = ServerLocks::open(file_).value(); }
    EXPECT_TRUE(other_->isHeldByOthers("urn:ur5").value()) << "whoever closes the file besides";
    one_.reset();
    EXPECT_FALSE(other_->isHeldByOthers("urn:ur5").value());
    EXPECT_FALSE(other_->isHeldByOthers("urn:edo").value());
}

TEST_F(TwoHolders, UseAFileThatIsEmptyAndTheirOwnersAlone) {
    ASSERT_TRUE(one_->hold("urn:ur5"));
    struct stat status {};
    ASSERT_EQ(::stat(file_.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777U, 0600U);
    EXPECT_EQ(status.st_size, 0);
}

TEST(ServerLocks, CannotBeWhereThereIsNoFolder) {
    const auto file = (testFolder() / "nowhere" / "locks").string();
    const auto locks = ServerLocks::open(file);
    ASSERT_FALSE(locks);
    EXPECT_EQ(locks.error().code, Errc::resource_unavailable);
    EXPECT_THAT(locks.error().message, ::testing::HasSubstr(file));
}

}  // namespace
}  // namespace metier::records
