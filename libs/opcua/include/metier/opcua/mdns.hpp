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

/// A server as mDNS tells of it (OPC 10000-12, annex C): service type `_opcua-tcp._tcp`.
struct MdnsService {
    std::string name;  ///< of the instance, cut to 63 bytes; another one of that name gets a number
    std::string host;  ///< where it is reached: an IPv4 address, or the name of a host
    std::uint16_t port = 0;
    std::string path = "/";   ///< of the endpoint, the TXT record `path`
    std::string caps = "NA";  ///< the TXT record `caps`
};

/// Announces a server by the Avahi daemon of this machine, as soon as and as long as there is one.
///
/// A server on a loopback address is announced on the loopback interface alone. Without Avahi
/// nothing happens but a line in the log.
/// Threading: a thread of its own talks to Avahi; the destructor waits for it, a fraction of a
/// second unless D-Bus hangs.
class MdnsAnnouncer {
public:
    explicit MdnsAnnouncer(MdnsService service);
    ~MdnsAnnouncer();
    MdnsAnnouncer(const MdnsAnnouncer&) = delete;
    MdnsAnnouncer& operator=(const MdnsAnnouncer&) = delete;

private:
    const MdnsService service_;
    std::jthread thread_;
};

/// Servers that mDNS tells of, by Avahi.
/// Threads: any; waits, until Avahi has told all that it knows and at most `longest`.
/// Errors: not_found (no Avahi daemon).
Result<std::vector<FoundServer>> browseMdns(
    std::chrono::milliseconds longest = std::chrono::milliseconds(1'500));

}  // namespace metier::opcua
