#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "metier/base/error.hpp"

namespace metier::opcua {

/// A server that a discovery server or mDNS has listed. Nobody has connected to it yet: it may be
/// gone.
struct FoundServer {
    /// Address that this client can use: "opc.tcp://host:port".
    std::string url;
    /// Application name, printable; may be empty.
    std::string name;
    /// Source: address of a discovery server, or "mDNS".
    std::string reported_by;
};

/// Result of a search.
struct Sighting {
    /// Servers, each address once, sorted by name and address.
    std::vector<FoundServer> servers;
    /// Errors, one for each discovery server that did not answer, with its address.
    std::vector<Error> problems;
};

/// Adds the servers whose address is not in the list yet; keeps the order by name and address.
void merge(std::vector<FoundServer>& servers, std::vector<FoundServer> more);

/// Asks discovery servers, all at the same time, for the servers that they know. Entries of
/// discovery servers are left out; at most 1000 entries of each answer are used.
/// Threads: any; waits, at most `timeout` and about a second.
Sighting askDiscoveryServers(const std::vector<std::string>& urls,
                             std::chrono::milliseconds timeout = std::chrono::seconds(2));

/// Whether a search asks mDNS, too.
enum class Mdns { left_out, asked };

/// Asks discovery servers and, if wanted, mDNS at the same time. A missing Avahi daemon is not
/// reported as a problem.
/// Threads: any; waits about 3 s at most.
Sighting searchServers(const std::vector<std::string>& discovery_urls, Mdns mdns);

}  // namespace metier::opcua
