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
    /// Certificate that others see.
    Certificate certificate;
    /// Private key, PKCS #8 in DER; never log it.
    std::string private_key;
};

/// Content of a new certificate.
struct IdentityOptions {
    /// Common name (CN) of the certificate, 1 to 64 bytes.
    std::string application_name = "metier";
    /// URI in its SubjectAltName, which must be the ApplicationUri of the application.
    std::string application_uri = "urn:metier";
    /// Host names and IPv4 addresses at which the application is reached.
    std::vector<std::string> hosts{"localhost"};
    /// Time from now to the end of the certificate's validity, 1 to 36,525 days.
    std::chrono::days lifetime{730};
    /// Length of the RSA key [bit], 2048 to 4096.
    int key_bits = 2048;
};

/// Makes a new key and a self-signed certificate for it, valid from an hour before `now`.
/// Errors: invalid_argument (an option), internal (the library).
/// Threads: any; takes up to a second.
Result<Identity> makeIdentity(const IdentityOptions& options, UtcTime now);

/// Makes a new key and a certificate with the names of the former identity.
/// \param lifetime time from `now` to the end of its validity
/// Errors: invalid_argument (the lifetime), internal (the library).
/// Threads: any; takes up to a second.
Result<Identity> makeSuccessor(const Identity& former, std::chrono::days lifetime, UtcTime now);

/// Loads the identity in `folder` from identity.pem, a file that only its owner may read. Waits for
/// the disk.
/// Errors: not_found (none there), access_denied (others may read it), invalid_argument (its
///         content).
Result<Identity> loadIdentity(const std::filesystem::path& folder);

/// Saves the identity as `folder`/identity.pem, and the certificate alone as certificate.der, which
/// others copy to trust it. Makes a missing folder; replaces a former identity.
/// Errors: resource_unavailable (the folder).
Result<void> saveIdentity(const std::filesystem::path& folder, const Identity& identity);

}  // namespace metier::security
