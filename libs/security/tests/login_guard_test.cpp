#include "metier/security/login_guard.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <string>

namespace metier::security {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

class Logins : public ::testing::Test {
protected:
    Logins() {
        UserTable table;
        EXPECT_TRUE(table.add("anna", Role::operator_, "right password"));
        EXPECT_TRUE(table.save(file_));
        // What a test changes counts at once, however busy the machine.
        guard_.emplace(LoginGuard::open(file_, clock_, 30s).value());
    }
    static std::filesystem::path freshFile() {
        const auto* name = ::testing::UnitTest::GetInstance()->current_test_info()->name();
        auto folder = std::filesystem::path(::testing::TempDir()) / "logins" / name;
        std::filesystem::remove_all(folder);
        return folder / "users";
    }

    Result<Role> right(const std::string& from = "panel") {
        return guard_->check("anna", "right password", from);
    }
    Result<Role> wrong(const std::string& from = "panel") {
        return guard_->check("anna", "wrong password", from);
    }
    void failFiveTimes() {
        for (int i = 0; i < 5; ++i) {
            EXPECT_EQ(wrong().error().message, "unknown user or wrong password");
        }
    }

    const std::filesystem::path file_ = freshFile();
    ManualClock clock_;
    std::optional<LoginGuard> guard_;
};

TEST_F(Logins, GiveTheRoleOfWhoKnowsThePassword) {
    EXPECT_EQ(right(), Role::operator_);
    EXPECT_EQ(wrong().error().code, Errc::access_denied);
}

// A file that nobody writes to its end is as one of a disk that hangs.
TEST_F(Logins, DoNotWaitForADiskThatHangs) {
    guard_.emplace(LoginGuard::open(file_, clock_).value());  // with the patience of a server
    std::filesystem::remove(file_);
    ASSERT_EQ(::mkfifo(file_.c_str(), 0600), 0);
    EXPECT_EQ(right(), Role::operator_) << "as known before";
    auto shortest = std::chrono::nanoseconds::max();
    for (int i = 0; i < 5; ++i) {  // one of them is not held up by other work of the computer
        const auto before = std::chrono::steady_clock::now();
        EXPECT_EQ(guard_->roleOf("anna"), Role::operator_);
        shortest =
            std::min<std::chrono::nanoseconds>(shortest, std::chrono::steady_clock::now() - before);
    }
    EXPECT_LT(shortest, 10ms);
    const int disk = ::open(file_.c_str(), O_WRONLY);  // it works again
    ASSERT_GE(disk, 0);
    ::close(disk);
}

TEST_F(Logins, DoNotTellWhetherThereIsSuchAUser) {
    EXPECT_EQ(guard_->check("nobody", "right password", "panel").error().message,
              wrong().error().message);
}

TEST_F(Logins, LetTheRightOnesInWhateverNamesAreMadeUp) {
    for (int i = 0; i < 70; ++i) {
        EXPECT_EQ(guard_->check("user" + std::to_string(i), "a guess", "panel").error().message,
                  "unknown user or wrong password");
        EXPECT_TRUE(right()) << i;
    }
}

TEST_F(Logins, GiveAnApplicationThatTriesManyNamesOneAttemptAtEach) {
    for (int i = 0; i < 20; ++i) {
        EXPECT_FALSE(guard_->check("user" + std::to_string(i), "a guess", "panel"));
        clock_.advance(1s);
    }
    EXPECT_FALSE(wrong());
    EXPECT_THAT(right().error().message, HasSubstr("too many wrong passwords: wait 1 s"));
    EXPECT_TRUE(right("another panel"));
    clock_.advance(1s);
    EXPECT_FALSE(wrong());
    EXPECT_THAT(right().error().message, HasSubstr("wait 2 s"));
    clock_.advance(11min);
    EXPECT_TRUE(right());
    EXPECT_FALSE(wrong()) << "what was long ago is forgotten";
    EXPECT_TRUE(right());
}

TEST_F(Logins, ForgetNoGuessesAtAUserForNamesThatAreMadeUp) {
    for (int i = 0; i < 4; ++i) {
        EXPECT_FALSE(wrong());
    }
    for (int i = 0; i < 300; ++i) {
        static_cast<void>(guard_->check("user" + std::to_string(i), "", "other panel"));
    }
    EXPECT_FALSE(wrong());
    EXPECT_THAT(right().error().message, HasSubstr("too many"));
}

TEST_F(Logins, MakeWhoeverGuessesWait) {
    failFiveTimes();
    EXPECT_THAT(right().error().message, HasSubstr("too many wrong passwords: wait 1 s"));
    clock_.advance(1s);
    EXPECT_TRUE(right());
    EXPECT_FALSE(wrong());
    EXPECT_TRUE(right()) << "counted anew after the right one";
}

TEST_F(Logins, DoubleTheWaitUpToAMinute) {
    failFiveTimes();
    for (const auto pause : {1s, 2s, 4s, 8s, 16s, 32s, 60s, 60s}) {
        clock_.advance(pause - 1ms);
        EXPECT_THAT(right().error().message, HasSubstr("too many")) << pause.count();
        clock_.advance(1ms);
        EXPECT_EQ(wrong().error().message, "unknown user or wrong password") << pause.count();
    }
}

TEST_F(Logins, FromAnotherApplicationAreNotLockedOut) {
    failFiveTimes();
    EXPECT_FALSE(right());
    EXPECT_TRUE(right("another panel"));
}

TEST_F(Logins, FollowTheFileOfUsers) {
    auto table = UserTable::load(file_).value();
    ASSERT_TRUE(table.setPassword("anna", "another password"));
    ASSERT_TRUE(table.save(file_));
    std::filesystem::last_write_time(file_, std::filesystem::file_time_type::clock::now() + 1h);
    EXPECT_FALSE(right());
    EXPECT_TRUE(guard_->check("anna", "another password", "panel"));
}

TEST_F(Logins, KeepTheUsersOfBeforeIfTheFileIsWrong) {
    std::filesystem::permissions(file_, std::filesystem::perms::all);
    std::filesystem::last_write_time(file_, std::filesystem::file_time_type::clock::now() + 1h);
    EXPECT_TRUE(right());
}

TEST_F(Logins, RememberWhoIsBarredLongest) {
    failFiveTimes();
    for (int i = 0; i < 200; ++i) {
        // An application that was never seen: refused for the name, without effort.
        static_cast<void>(guard_->check("anna", "", "panel" + std::to_string(i)));
    }
    EXPECT_THAT(right().error().message, HasSubstr("too many")) << "who is barred is kept longest";
}

TEST_F(Logins, AreNobodysOnceTheFileIsGone) {
    ASSERT_EQ(guard_->roleOf("anna"), Role::operator_);
    std::filesystem::remove(file_);
    EXPECT_EQ(right().error().message, "unknown user or wrong password");
    EXPECT_EQ(guard_->roleOf("anna"), std::nullopt);
}

TEST_F(Logins, AreThoseOfAFileThatIsMadeLater) {
    std::filesystem::remove(file_);
    auto guard = LoginGuard::open(file_, clock_, 30s).value();
    EXPECT_EQ(guard.roleOf("anna"), std::nullopt);
    UserTable table;
    ASSERT_TRUE(table.add("anna", Role::engineer, "right password"));
    ASSERT_TRUE(table.save(file_));
    EXPECT_EQ(guard.check("anna", "right password", "panel"), Role::engineer);
    EXPECT_EQ(guard.roleOf("anna"), Role::engineer);
}

TEST_F(Logins, AreNoneWithAFileThatIsWrong) {
    std::ofstream(file_) << "anna Boss $y$x\n";
    const auto guard = LoginGuard::open(file_, clock_);
    ASSERT_FALSE(guard);
    EXPECT_THAT(guard.error().message, HasSubstr("users:1: "));
}

TEST_F(Logins, CountNamesThatDifferBehindTheirLongestAsOne) {
    const std::string longest(64, 'x');
    for (int i = 0; i < 5; ++i) {
        EXPECT_FALSE(guard_->check(longest + std::to_string(i), "a guess", "panel"));
    }
    EXPECT_THAT(guard_->check(longest + "9", "a guess", "panel").error().message,
                HasSubstr("too many"));
}

TEST_F(Logins, DoNotLengthenTheWaitOfWhoTriesMeanwhile) {
    failFiveTimes();
    for (int i = 0; i < 20; ++i) {
        EXPECT_THAT(wrong().error().message, HasSubstr("wait 1 s"));
    }
    clock_.advance(1s);
    EXPECT_TRUE(right());
}

TEST_F(Logins, RememberTheGuessesOfAnApplicationForTenMinutes) {
    const auto guess = [&](int i) {
        EXPECT_FALSE(guard_->check("user" + std::to_string(i), "a guess", "panel"));
    };
    for (int i = 0; i < 20; ++i) {
        guess(i);
    }
    clock_.advance(10min);
    EXPECT_FALSE(wrong());
    EXPECT_THAT(right().error().message, HasSubstr("wait 1 s")) << "not over ten minutes ago";
    clock_.advance(10min + 1ms);
    guess(20);
    guess(20);
    EXPECT_EQ(guard_->check("user20", "a guess", "panel").error().message,
              "unknown user or wrong password")
        << "five attempts again";
}

}  // namespace
}  // namespace metier::security
