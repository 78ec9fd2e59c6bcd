#include "host/port_lock.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/wait.h>

#include <csignal>

namespace metier::server {
namespace {

using ::testing::HasSubstr;

/// A port of loopback with a listener, or with a listener that has ended.
class Port {
public:
    Port() : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t size = sizeof address;
        auto* generic = reinterpret_cast<sockaddr*>(&address);
        EXPECT_EQ(bind(socket_, generic, size), 0);
        EXPECT_EQ(listen(socket_, 1), 0);
        EXPECT_EQ(getsockname(socket_, generic, &size), 0);
        number_ = ntohs(address.sin_port);
    }
    ~Port() { free(); }
    Port(const Port&) = delete;
    Port& operator=(const Port&) = delete;

    std::uint16_t number() const { return number_; }
    void free() {
        if (socket_ >= 0) {
            close(socket_);
            socket_ = -1;
        }
    }

private:
    int socket_;
    std::uint16_t number_ = 0;
};

/// A process of another user that has the name of a port, and not the port.
class Squatter {
public:
    explicit Squatter(Port& port) {
        int ready[2];
        EXPECT_EQ(pipe(ready), 0);
        pid_ = fork();
        if (pid_ == 0) {
            port.free();  // the child's copy
            constexpr uid_t kNobody = 65534;
            const bool is_other = geteuid() != 0 || seteuid(kNobody) == 0;
            const auto name = fmt::format("port {} of 127.0.0.1", port.number());
            const auto lock = link::NameLock::take(name, "a port");
            const char taken = lock && is_other ? 'y' : 'n';
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
    ~Squatter() {
        kill(pid_, SIGKILL);
        waitpid(pid_, nullptr, 0);
    }
    Squatter(const Squatter&) = delete;
    Squatter& operator=(const Squatter&) = delete;

    /// Another user than the squatter's, to take the port as.
    static uid_t other() { return geteuid() == 0 ? 0 : geteuid() + 1; }

private:
    pid_t pid_ = -1;
};

cell::ServerConfig serverAt(std::uint16_t port) {
    cell::ServerConfig config;
    config.name = "iiwa";
    config.address = "127.0.0.1";
    config.port = port;
    return config;
}

TEST(PortLock, NamesTheProcessThatHasIt) {
    Port port;
    port.free();
    const auto first = lockPort(serverAt(port.number()));
    ASSERT_TRUE(first && *first);
    const auto second = lockPort(serverAt(port.number()));
    ASSERT_FALSE(second);
    EXPECT_THAT(second.error().message,
                HasSubstr("is in use by process " + std::to_string(getpid())));
    EXPECT_TRUE(lockPort(serverAt(0))) << "a free port is nobody's";
}

TEST(PortLock, IsNotKeptByAnotherUserWhoHasTheNameAlone) {
    Port port;
    const Squatter squatter(port);
    const auto taken = lockPort(serverAt(port.number()), Squatter::other());
    ASSERT_FALSE(taken) << "somebody listens there";
    EXPECT_THAT(taken.error().message, HasSubstr("of the user"));
    port.free();
    const auto squatted = lockPort(serverAt(port.number()), Squatter::other());
    ASSERT_TRUE(squatted) << squatted.error().message;
    EXPECT_FALSE(*squatted);
}

}  // namespace
}  // namespace metier::server
