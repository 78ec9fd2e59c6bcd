#include "metier/link/name_lock.hpp"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <string>

namespace metier::link {
namespace {

using ::testing::HasSubstr;

/// Name used by this test alone, on a machine that runs other tests, too.
std::string nameOf(const std::string& test) {
    return test + " " + std::to_string(getpid());
}

/// A process that has a name until it is killed, and nothing else.
class Holder {
public:
    explicit Holder(const std::string& name, uid_t user = geteuid()) {
        std::array<int, 2> ready{};
        EXPECT_EQ(pipe(ready.data()), 0);
        pid_ = fork();
        if (pid_ == 0) {
            const bool is_user = user == geteuid() || seteuid(user) == 0;
            const auto lock = NameLock::take(name, "a robot");
            const char taken = lock && is_user ? 'y' : 'n';
            [[maybe_unused]] const auto told = write(ready[1], &taken, 1);
            for (;;) {
                pause();
            }
        }
        char taken = 'n';
        EXPECT_EQ(read(ready[0], &taken, 1), 1);
        EXPECT_EQ(taken, 'y');
        close(ready[0]);
        close(ready[1]);
    }
    ~Holder() { kill(SIGKILL); }
    Holder(const Holder&) = delete;
    Holder& operator=(const Holder&) = delete;

    pid_t pid() const { return pid_; }
    void kill(int signal) {
        if (pid_ > 0) {
            ::kill(pid_, signal);
            waitpid(pid_, nullptr, signal == SIGSTOP ? WUNTRACED : 0);
            pid_ = signal == SIGSTOP ? pid_ : -1;
        }
    }

private:
    pid_t pid_ = -1;
};

TEST(NameLock, IsOnesUntilItIsGivenBack) {
    const auto name = nameOf("once");
    {
        const auto first = NameLock::take(name, "a robot");
        ASSERT_TRUE(first) << first.error().message;
        const auto second = NameLock::take(name, "a robot");
        ASSERT_FALSE(second);
        EXPECT_EQ(second.error().code, Errc::already_exists);
        EXPECT_TRUE(NameLock::take(nameOf("another"), "another robot"));
    }
    EXPECT_TRUE(NameLock::take(name, "a robot"));
}

TEST(NameLock, NamesTheProcessThatHasItEachTime) {
    const auto name = nameOf("pid");
    const Holder holder(name);
    for (int i = 0; i < 5; ++i) {
        const auto refused = NameLock::take(name, "the arm at 10.0.0.5");
        ASSERT_FALSE(refused);
        EXPECT_THAT(refused.error().message, HasSubstr("the arm at 10.0.0.5 is in use by process " +
                                                       std::to_string(holder.pid())));
    }
}

TEST(NameLock, SaysThatAnotherUserHasIt) {
    constexpr uid_t kNobody = 65534;
    const auto name = nameOf("squatted");
    const bool is_root = geteuid() == 0;  // which everybody believes
    const Holder holder(name, is_root ? kNobody : geteuid());
    const auto refused = NameLock::take(name, "a robot", is_root ? geteuid() : geteuid() + 1);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::access_denied);
    EXPECT_THAT(refused.error().message, HasSubstr(std::to_string(holder.pid()) + " of the user " +
                                                   std::to_string(is_root ? kNobody : geteuid())));
}

TEST(NameLock, StaysWithAProcessThatIsStopped) {
    const auto name = nameOf("stopped");
    Holder holder(name);
    holder.kill(SIGSTOP);
    const auto refused = NameLock::take(name, "a robot");
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr(std::to_string(holder.pid())));
}

TEST(NameLock, IsFreeOnceItsProcessIsKilled) {
    const auto name = nameOf("killed");
    Holder holder(name);
    holder.kill(SIGKILL);
    EXPECT_TRUE(NameLock::take(name, "a robot"));
}

TEST(NameLock, TellsLongNamesApart) {
    const std::string start(500, 'x');
    const auto one = NameLock::take(nameOf(start) + "1", "one");
    ASSERT_TRUE(one) << one.error().message;
    EXPECT_TRUE(NameLock::take(nameOf(start) + "2", "two"));
    EXPECT_FALSE(NameLock::take(nameOf(start) + "1", "one"));
}

TEST(NameLock, MovesWithItsOwner) {
    const auto name = nameOf("moved");
    auto first = NameLock::take(name, "a robot");
    ASSERT_TRUE(first);
    const auto second = std::move(*first);
    EXPECT_FALSE(NameLock::take(name, "a robot"));
}

}  // namespace
}  // namespace metier::link
