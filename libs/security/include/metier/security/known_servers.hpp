#pragma once

#include <filesystem>
#include <string>

#include "metier/base/error.hpp"

namespace metier::security {

/// Addresses at which a server has proved its identity. A client does not accept a server without
/// security at such an address later: any program may listen at the port of a server that is not
/// running.
///
/// There is a file for each address, in a folder beside the trust store, so several processes may
/// use one folder. Beyond 1000 addresses the one noted longest ago is forgotten. `localhost`,
/// 127.0.0.1 and [::1] are one host; a missing port is 4840; the path after the port is ignored.
/// Threading: any thread, one at a time; waits for the disk.
class KnownServers {
public:
    /// \param folder need not exist
    explicit KnownServers(std::filesystem::path folder) : folder_(std::move(folder)) {}

    /// Reports whether a server at this address has proved its identity.
    /// \param url "opc.tcp://host:port"
    bool isClosed(const std::string& url) const;
    /// Notes that a server with a trusted certificate answered there.
    /// Errors: resource_unavailable.
    Result<void> noteClosed(const std::string& url) const;
    /// Forgets an address: the server there may be without security from now on.
    /// \return whether it was known
    /// Errors: resource_unavailable.
    Result<bool> forget(const std::string& url) const;

private:
    std::filesystem::path fileOf(const std::string& url) const;

    std::filesystem::path folder_;
};

}  // namespace metier::security
