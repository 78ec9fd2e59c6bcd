#include "server_locks.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "metier/base/stable_hash.hpp"

namespace metier::records {
namespace {

constexpr mode_t kLockMode = 0600;
constexpr int kBits = 62;  // number of bits used of an off_t

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

Result<std::shared_ptr<ServerLocks>> ServerLocks::open(const std::string& file) {
    const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, kLockMode);
    std::shared_ptr<ServerLocks> locks(new ServerLocks(descriptor, file));
    return descriptor < 0 ? Result<std::shared_ptr<ServerLocks>>(locks->failed()) : locks;
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
