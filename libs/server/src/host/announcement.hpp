#pragma once

#include <memory>
#include <string>
#include <vector>

#include "metier/cell/cell.hpp"
#include "metier/opcua/mdns.hpp"
#include "metier/opcua/registrar.hpp"
#include "metier/server/identity.hpp"

namespace metier::server {

/// ApplicationUri of a server, which stays the same: urn:HOST:metier:NAME:PORT. One on any free
/// port is another one each time.
std::string applicationUriOf(const cell::ServerConfig& config);

/// As others reach a server. \param url where it listens: "opc.tcp://127.0.0.1:48411"
std::string announcedUrl(const cell::Discovery& discovery, const std::string& url);

/// Announces a server for as long as it lives, as its cell file says.
///
/// A discovery server or Avahi that does not answer never holds up the server.
/// Threading: one thread; the destructor waits a few seconds at most.
class Announcement {
public:
    /// \param url where the server listens: "opc.tcp://127.0.0.1:48411"
    Announcement(const cell::ServerConfig& config, const Identity& identity,
                 const std::string& application_uri, const std::string& url);

private:
    std::vector<std::unique_ptr<opcua::Registrar>> registrars_;
    std::unique_ptr<opcua::MdnsAnnouncer> mdns_;  // null: not wanted
};

}  // namespace metier::server
