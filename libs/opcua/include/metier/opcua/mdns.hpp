#pragma once

#include <chrono>
#include <cstdint>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/opcua/search.hpp"

namespace metier::opcua {

/// A server as announced by mDNS (OPC 10000-12, annex C): service type `_opcua-tcp._tcp`.
struct MdnsService {
    /// Instance name, cut to 63 bytes; a second one of that name gets a number.
    std::string name;
    /// IPv4 address or host name of the server.
    std::string host;
    /// TCP port of the endpoint.
    std::uint16_t port = 0;
    /// Path of the endpoint: the TXT record `path`.
    std::string path = "/";
    /// Capabilities, separated by commas: the TXT record `caps`.
    std::string caps = "NA";
};

/// Announces a server through the Avahi daemon of this machine, whenever that is running.
///
/// A server on a loopback address is announced on the loopback interface only. Without Avahi only a
/// line is logged.
/// Threading: a thread of its own talks to Avahi. The destructor waits for it, a fraction of a
/// second unless D-Bus hangs.
///
///     MdnsAnnouncer announcer({.name = "metier arm", .host = "192.168.1.5", .port = 4840});
class MdnsAnnouncer {
public:
    /// Begins to announce; does not wait, and nothing can fail.
    explicit MdnsAnnouncer(MdnsService service);
    /// Withdraws the announcement.
    ~MdnsAnnouncer();
    MdnsAnnouncer(const MdnsAnnouncer&) = delete;
    MdnsAnnouncer& operator=(const MdnsAnnouncer&) = delete;

private:
    const MdnsService service_;
    std::jthread thread_;
};

/// Lists the servers that are announced by mDNS, through Avahi.
/// Threads: any; waits until Avahi has reported all that it knows, at most `longest`.
/// Errors: not_found (no Avahi daemon).
Result<std::vector<FoundServer>> browseMdns(
    std::chrono::milliseconds longest = std::chrono::milliseconds(1'500));

}  // namespace metier::opcua
