#include "server_locks.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "metier/base/stable_hash.hpp"

namespace metier::records {
namespace {

constexpr mode_t kOwnerOnly = 0600;
constexpr int kBits = 62;  // of an off_t

/// The byte of a server; the file stays empty.
struct flock rangeOf(const std::string& server, short type) {
    struct flock range {};
    range.l_type = type;
    range.l_whence = SEEK_SET;
    range.l_start = static_cast<off_t>(stableHash(server) >> (64 - kBits));
    range.l_len = 1;
    return range;
}

}  // namespace

Result<ServerLocks> ServerLocks::open(const std::filesystem::path& file) {
    ServerLocks locks(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, kOwnerOnly),
                      file.string());
    return locks.descriptor_ < 0 ? Result<ServerLocks>(locks.failed())
                                 : Result<ServerLocks>(std::move(locks));
}

ServerLocks::ServerLocks(ServerLocks&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), name_(std::move(other.name_)) {}

ServerLocks& ServerLocks::operator=(ServerLocks&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    std::swap(name_, other.name_);
    return *this;
}

ServerLocks::~ServerLocks() {
    if (descriptor_ >= 0) {
        ::close(descriptor_);
    }
}

Result<void> ServerLocks::hold(const std::string& server) const {
    auto range = rangeOf(server, F_RDLCK);
    return fcntl(descriptor_, F_OFD_SETLK, &range) == 0 ? Result<void>() : Result<void>(failed());
}

Result<bool> ServerLocks::isHeldByOthers(const std::string& server) const {
    auto range = rangeOf(server, F_WRLCK);
    return fcntl(descriptor_, F_OFD_GETLK, &range) == 0 ? Result<bool>(range.l_type != F_UNLCK)
                                                        : Result<bool>(failed());
}

tl::unexpected<Error> ServerLocks::failed() const {
    return fail(Errc::resource_unavailable,
                fmt::format("{}: {}", name_, std::generic_category().message(errno)));
}

}  // namespace metier::records
