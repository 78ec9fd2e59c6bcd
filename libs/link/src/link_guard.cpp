#include "metier/link/link_guard.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>  // NOLINT(modernize-deprecated-headers): kill() is POSIX, not in <csignal>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <new>
#include <utility>

namespace metier::link {

namespace {

// The guard looks so often within its limit. It counts looks, not time: when the whole computer
// stood still its owner has as many looks to go on.
constexpr int kLooks = 8;

using Beats = std::atomic<std::uint32_t>;
static_assert(Beats::is_always_lock_free, "two processes share it");

/// Room for one descriptor beside a message.
struct alignas(cmsghdr) DescriptorRoom {
    std::array<char, CMSG_SPACE(sizeof(int))> bytes{};
};

/// One message: with a descriptor, guard that; without, guard nothing.
bool sendDescriptor(int channel, int descriptor) noexcept {
    char byte = 0;
    iovec data{&byte, 1};
    DescriptorRoom room;
    msghdr message{};
    message.msg_iov = &data;
    message.msg_iovlen = 1;
    if (descriptor >= 0) {
        message.msg_control = room.bytes.data();
        message.msg_controllen = room.bytes.size();
        auto* header = CMSG_FIRSTHDR(&message);
        header->cmsg_level = SOL_SOCKET;
        header->cmsg_type = SCM_RIGHTS;
        header->cmsg_len = CMSG_LEN(sizeof(int));
        std::memcpy(CMSG_DATA(header), &descriptor, sizeof descriptor);
    }
    return sendmsg(channel, &message, MSG_NOSIGNAL | MSG_DONTWAIT) == 1;
}

// ---- in the guard's process: only async-signal-safe calls ---------------------------------------

/// \return whether the owner still lives
bool receiveDescriptor(int channel, int& descriptor) noexcept {
    char byte = 0;
    iovec data{&byte, 1};
    DescriptorRoom room;
    msghdr message{};
    message.msg_iov = &data;
    message.msg_iovlen = 1;
    message.msg_control = room.bytes.data();
    message.msg_controllen = room.bytes.size();
    const auto received = recvmsg(channel, &message, MSG_CMSG_CLOEXEC);
    if (received <= 0) {
        return received < 0 && errno == EINTR;
    }
    if (descriptor >= 0) {
        close(descriptor);
        descriptor = -1;
    }
    if (const auto* header = CMSG_FIRSTHDR(&message)) {
        std::memcpy(&descriptor, CMSG_DATA(header), sizeof descriptor);
    }
    return true;
}

void endLink(int& descriptor) noexcept {
    if (descriptor >= 0) {
        shutdown(descriptor, SHUT_RDWR);
        close(descriptor);
        descriptor = -1;
    }
}

[[noreturn]] void keepGuard(int channel, const Beats& beats, int period_ms) noexcept {
    int guarded = -1;
    int idle_looks = 0;
    auto seen = beats.load();
    for (;;) {
        pollfd request{channel, POLLIN, 0};
        const int ready = poll(&request, 1, guarded >= 0 ? period_ms : -1);
        if (ready > 0) {
            if (!receiveDescriptor(channel, guarded)) {
                endLink(guarded);
                _exit(0);
            }
            idle_looks = 0;
        } else if (const auto now = beats.load(); now != seen) {
            seen = now;
            idle_looks = 0;
        } else if (++idle_looks >= kLooks) {
            endLink(guarded);
        }
    }
}

/// Lets go of all that the owner has open: it must end with the owner, not with the guard.
[[noreturn]] void becomeGuard(int channel, const Beats& beats, int period_ms) noexcept {
    setsid();  // signals of a terminal to its programs must not reach the guard
    prctl(PR_SET_NAME, "metier-guard");
    constexpr int kChannel = 0;
    dup2(channel, kChannel);
    close_range(kChannel + 1, ~0U, 0);
    keepGuard(kChannel, beats, period_ms);
}

}  // namespace

Result<LinkGuard> LinkGuard::start(std::chrono::milliseconds limit) {
    std::array<int, 2> ends{};
    void* memory =
        mmap(nullptr, sizeof(Beats), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) {
        return fail(Errc::resource_unavailable, fmt::format("mmap: {}", std::strerror(errno)));
    }
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) {
        munmap(memory, sizeof(Beats));
        return fail(Errc::resource_unavailable,
                    fmt::format("socketpair: {}", std::strerror(errno)));
    }
    auto* beats = new (memory) Beats(0);
    const int period_ms = std::max(1, static_cast<int>(limit.count()) / kLooks);
    const pid_t pid = fork();
    if (pid == 0) {
        becomeGuard(ends[1], *beats, period_ms);
    }
    close(ends[1]);
    LinkGuard guard(pid, ends[0], beats);
    if (pid < 0) {
        return fail(Errc::resource_unavailable, fmt::format("fork: {}", std::strerror(errno)));
    }
    return guard;
}

LinkGuard::LinkGuard(LinkGuard&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)),
      channel_(std::exchange(other.channel_, -1)),
      beats_(std::exchange(other.beats_, nullptr)) {}

LinkGuard& LinkGuard::operator=(LinkGuard&& other) noexcept {
    if (this != &other) {
        end();
        pid_ = std::exchange(other.pid_, -1);
        channel_ = std::exchange(other.channel_, -1);
        beats_ = std::exchange(other.beats_, nullptr);
    }
    return *this;
}

LinkGuard::~LinkGuard() {
    end();
}

void LinkGuard::end() noexcept {
    if (pid_ > 0) {
        kill(pid_, SIGKILL);  // its copy of the link is closed, not shut down
        waitpid(pid_, nullptr, 0);
    }
    if (channel_ >= 0) {
        close(channel_);
    }
    if (beats_ != nullptr) {
        munmap(beats_, sizeof(Beats));
    }
}

Result<void> LinkGuard::guard(TcpLink& link) {
    alive();
    if (!sendDescriptor(channel_, link.descriptor())) {
        return fail(Errc::resource_unavailable,
                    fmt::format("{}: no guard: {}", link.peer(), std::strerror(errno)));
    }
    return {};
}

void LinkGuard::release() noexcept {
    sendDescriptor(channel_, -1);
}

}  // namespace metier::link
