#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/security/certificate.hpp"

namespace metier::security {

/// Who an application is: its certificate, and the key that proves it.
struct Identity {
    Certificate certificate;
    std::string private_key;  ///< PKCS #8, DER
};

struct IdentityOptions {
    std::string application_name = "metier";
    std::string application_uri = "urn:metier";
    std::vector<std::string> hosts{"localhost"};  ///< names and IPv4 addresses it is reached by
    std::chrono::days lifetime{730};
    int key_bits = 2048;  ///< 2048 to 4096
};

/// A new key and a self-signed certificate for it, valid from an hour before `now`.
/// Errors: invalid_argument (an option), internal (the library).
/// Threads: any; takes up to a second.
Result<Identity> makeIdentity(const IdentityOptions& options, UtcTime now);

/// A new key and a certificate for the same names as the former.
/// Errors: internal (the library).
/// Threads: any; takes up to a second.
Result<Identity> makeSuccessor(const Identity& former, std::chrono::days lifetime, UtcTime now);

/// The identity in `folder`: identity.pem, which its owner alone may read.
/// Errors: not_found (none there), access_denied (others may read it), invalid_argument (what it
///         holds).
Result<Identity> loadIdentity(const std::filesystem::path& folder);

/// Writes it there whole, and the certificate alone to certificate.der, for others to trust.
/// Errors: resource_unavailable (the folder).
Result<void> saveIdentity(const std::filesystem::path& folder, const Identity& identity);

/// The identity in `folder`; a new one, which is saved there, if there is none.
Result<Identity> ensureIdentity(const std::filesystem::path& folder, const IdentityOptions& options,
                                UtcTime now);

}  // namespace metier::security
