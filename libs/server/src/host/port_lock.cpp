#include "host/port_lock.hpp"

#include <fmt/format.h>
#include <netdb.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>

#include <memory>
#include <string>
#include <utility>

namespace metier::server {
namespace {

/// Whether a server could listen there now.
bool isFree(const std::string& address, std::uint16_t port) {
    addrinfo wanted{};
    wanted.ai_socktype = SOCK_STREAM;
    wanted.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
    addrinfo* found = nullptr;
    if (getaddrinfo(address.c_str(), std::to_string(port).c_str(), &wanted, &found) != 0) {
        return false;
    }
    const std::unique_ptr<addrinfo, void (*)(addrinfo*)> owned(found, freeaddrinfo);
    const int probe = socket(found->ai_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (probe < 0) {
        return false;
    }
    const int on = 1;
    setsockopt(probe, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    const bool free = bind(probe, found->ai_addr, found->ai_addrlen) == 0 && listen(probe, 1) == 0;
    close(probe);
    return free;
}

}  // namespace

Result<std::optional<link::NameLock>> lockPort(const cell::ServerConfig& config, uid_t own) {
    if (config.port == 0) {
        return std::optional<link::NameLock>();
    }
    const auto port = fmt::format("port {} of {}", config.port, config.address);
    auto lock = link::NameLock::take(port, config.name + ": " + port, own);
    if (lock) {
        return std::optional(std::move(*lock));
    }
    const bool by_another_user = lock.error().code == Errc::access_denied;
    if (by_another_user && isFree(config.address, config.port)) {
        spdlog::warn("{}, who does not serve there: it is served all the same",
                     lock.error().message);
        return std::optional<link::NameLock>();
    }
    return fail(lock.error());
}

}  // namespace metier::server
