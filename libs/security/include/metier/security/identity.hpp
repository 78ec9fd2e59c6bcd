#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/security/certificate.hpp"

namespace metier::security {

/// Identity of an application: its certificate, and the private key that proves it.
struct Identity {
    Certificate certificate;
    std::string private_key;  ///< PKCS #8, DER
};

struct IdentityOptions {
    std::string application_name = "metier";
    std::string application_uri = "urn:metier";
    std::vector<std::string> hosts{"localhost"};  ///< host names and IPv4 addresses at which it is
                                                  ///< reached
    std::chrono::days lifetime{730};
    int key_bits = 2048;  ///< length of the RSA key, 2048 to 4096
};

/// Makes a new key and a self-signed certificate for it, valid from an hour before `now`.
/// Errors: invalid_argument (an option), internal (the library).
/// Threads: any; takes up to a second.
Result<Identity> makeIdentity(const IdentityOptions& options, UtcTime now);

/// Makes a new key and a certificate with the names of the former identity.
/// Errors: internal (the library).
/// Threads: any; takes up to a second.
Result<Identity> makeSuccessor(const Identity& former, std::chrono::days lifetime, UtcTime now);

/// Loads the identity in `folder` from identity.pem, a file that only its owner may read.
/// Errors: not_found (none there), access_denied (others may read it), invalid_argument (its
///         content).
Result<Identity> loadIdentity(const std::filesystem::path& folder);

/// Saves the identity as `folder`/identity.pem, and the certificate alone as certificate.der, which
/// others copy to trust it.
/// Errors: resource_unavailable (the folder).
Result<void> saveIdentity(const std::filesystem::path& folder, const Identity& identity);

}  // namespace metier::security
