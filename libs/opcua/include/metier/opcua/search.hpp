#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "metier/base/error.hpp"

namespace metier::opcua {

/// A server that somebody told of. Nobody has asked it yet: it may be gone.
struct FoundServer {
    std::string url;      ///< "opc.tcp://host:port"
    std::string name;     ///< of the application, printable; may be empty
    std::string reported_by;  ///< address of a discovery server, or "mDNS"
};

struct Sighting {
    std::vector<FoundServer> servers;  ///< each address once, by name and address
    std::vector<Error> problems;       ///< whoever did not answer, and why
};

/// Adds what is not known yet by its address, in order of name and address.
void merge(std::vector<FoundServer>& servers, std::vector<FoundServer> more);

/// Asks discovery servers, all at the same time, which servers they know. Discovery servers are
/// left out, and of what one of them tells all but the first 1000.
/// Threads: any; waits, at most `timeout` and about a second.
Sighting askDiscoveryServers(const std::vector<std::string>& urls,
                             std::chrono::milliseconds timeout = std::chrono::seconds(2));

enum class Mdns { left_out, asked };

/// The same, and mDNS at the same time if it is to be asked; that there is no Avahi daemon is no
/// problem.
Sighting searchServers(const std::vector<std::string>& discovery_urls, Mdns mdns);

}  // namespace metier::opcua
