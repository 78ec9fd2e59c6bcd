#pragma once

#include <filesystem>
#include <string>

#include "metier/base/error.hpp"

namespace metier::security {

/// Addresses at which servers proved who they are, so that an open server is not believed there
/// later: anybody may listen at the port of a server that is not running.
///
/// A file for each address, in a folder beside the trust store, so that several processes may use
/// one folder. Beyond 1000 addresses the one noted longest ago is forgotten.
/// `localhost`, 127.0.0.1 and [::1] are one host; a missing port is 4840; what follows it is not
/// looked at.
/// Threading: any thread, one at a time; waits for the disk.
class KnownServers {
public:
    /// \param folder need not be there
    explicit KnownServers(std::filesystem::path folder) : folder_(std::move(folder)) {}

    /// \param url "opc.tcp://host:port"
    bool isClosed(const std::string& url) const;
    /// A server with a trusted certificate answered there. Errors: resource_unavailable.
    Result<void> noteClosed(const std::string& url) const;
    /// The server there may be open from now on. \return whether it was known
    /// Errors: resource_unavailable.
    Result<bool> forget(const std::string& url) const;

private:
    std::filesystem::path fileOf(const std::string& url) const;
    void forgetOldest() const;

    std::filesystem::path folder_;
};

}  // namespace metier::security
