#include "host/announcement.hpp"

#include <fmt/format.h>

#include <chrono>

#include "metier/base/random.hpp"
#include "metier/server/user_folders.hpp"

namespace metier::server {
namespace {

/// 48411 of "opc.tcp://127.0.0.1:48411".
std::uint16_t portOf(const std::string& url) {
    return static_cast<std::uint16_t>(std::stoul(url.substr(url.rfind(':') + 1)));
}

}  // namespace

std::string announcedUrl(const cell::Discovery& discovery, const std::string& url) {
    return discovery.announce_as.empty()
               ? url
               : fmt::format("opc.tcp://{}{}", discovery.announce_as, url.substr(url.rfind(':')));
}

std::string applicationUriOf(const cell::ServerConfig& config) {
    const auto& announced = config.discovery.announce_as;
    const auto host = announced.empty() ? hostName() : announced;
    if (config.port != 0) {
        return fmt::format("urn:{}:metier:{}:{}", host, config.name, config.port);
    }
    constexpr std::size_t kDigits = 8;
    return fmt::format("urn:{}:metier:{}:{}", host, config.name, randomHex(kDigits));
}

Announcement::Announcement(const cell::ServerConfig& config, const Identity& identity,
                           const std::string& application_uri, const std::string& url) {
    const auto period = std::chrono::duration_cast<std::chrono::milliseconds>(
        std::chrono::duration<double>(config.discovery.period));
    opcua::RegistrarOptions options;
    options.server = {.application_uri = application_uri,
                      .name = config.name,
                      .discovery_urls = {announcedUrl(config.discovery, url)}};
    options.security = identity.credentials();
    options.period = period;
    options.pause = std::min(period, options.pause);
    for (const auto& server : config.discovery.servers) {
        options.discovery_url = server;
        registrars_.push_back(std::make_unique<opcua::Registrar>(options));
    }
    if (config.discovery.mdns) {
        const auto& host = config.discovery.announce_as;
        mdns_ = std::make_unique<opcua::MdnsAnnouncer>(
            opcua::MdnsService{.name = config.name,
                               .host = host.empty() ? config.address : host,
                               .port = portOf(url)});
    }
}

}  // namespace metier::server
