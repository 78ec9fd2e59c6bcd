#include "metier/link/name_lock.hpp"

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <optional>
#include <utility>

#include "metier/base/stable_hash.hpp"

namespace metier::link {

namespace {

constexpr std::size_t kReadable = 80;
// Each refused process takes one place, since no connection is accepted. If all are taken, the
// error does not name the holder.
constexpr int kQueue = 4096;

struct Address {
    sockaddr_un socket{};
    socklen_t size = 0;

    const sockaddr* get() const noexcept { return reinterpret_cast<const sockaddr*>(&socket); }
};

Address addressOf(const std::string& name) {
    const auto text =
        name.size() <= kReadable
            ? "metier:" + name
            : fmt::format("metier:{}~{:016x}", name.substr(0, kReadable), stableHash(name));
    Address address;
    address.socket.sun_family = AF_UNIX;
    std::copy(text.begin(), text.end(), &address.socket.sun_path[1]);  // [0] is 0: abstract
    address.size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + text.size());
    return address;
}

int newSocket() {
    return socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
}

/// The process that listens there, from the kernel; nothing if that is not known.
std::optional<ucred> holderOf(const Address& address) {
    const int asking = newSocket();
    ucred peer{};
    socklen_t size = sizeof peer;
    const bool told = asking >= 0 && connect(asking, address.get(), address.size) == 0 &&
                      getsockopt(asking, SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0;
    if (asking >= 0) {
        close(asking);
    }
    return told && peer.pid > 0 ? std::optional(peer) : std::nullopt;
}

Error heldError(const Address& address, const std::string& what, uid_t own) {
    const auto holder = holderOf(address);
    if (!holder) {
        return {Errc::already_exists, fmt::format("{} is in use by another process", what)};
    }
    if (holder->uid == own || holder->uid == 0) {
        return {Errc::already_exists, fmt::format("{} is in use by process {}", what, holder->pid)};
    }
    return {Errc::access_denied, fmt::format("{} is in use by process {} of the user {}", what,
                                             holder->pid, holder->uid)};
}

}  // namespace

Result<NameLock> NameLock::take(const std::string& name, const std::string& what, uid_t own) {
    const auto address = addressOf(name);
    NameLock lock(newSocket());
    if (lock.socket_ >= 0 && bind(lock.socket_, address.get(), address.size) == 0 &&
        listen(lock.socket_, kQueue) == 0) {
        return lock;
    }
    if (errno == EADDRINUSE) {
        return fail(heldError(address, what, own));
    }
    return fail(Errc::resource_unavailable,
                fmt::format("{}: no lock: {}", what, std::strerror(errno)));
}

NameLock::NameLock(NameLock&& other) noexcept : socket_(std::exchange(other.socket_, -1)) {}

NameLock& NameLock::operator=(NameLock&& other) noexcept {
    std::swap(socket_, other.socket_);
    return *this;
}

NameLock::~NameLock() {
    if (socket_ >= 0) {
        close(socket_);
    }
}

}  // namespace metier::link
