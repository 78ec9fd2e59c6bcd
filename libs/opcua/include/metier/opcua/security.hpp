#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "metier/base/error.hpp"
#include "metier/opcua/session.hpp"
#include "metier/security/identity.hpp"
#include "metier/security/trust_store.hpp"
#include "metier/security/users.hpp"

namespace metier::opcua {

/// Certificate of an application, and the certificates that it trusts.
struct Credentials {
    /// Own certificate with its key; the certificate names the ApplicationUri.
    security::Identity identity;
    /// Folder of a security::TrustStore; it is read again after changes.
    std::filesystem::path trust_folder;
    /// Folder of the identity, see security::loadIdentity(): each new connection of a client takes
    /// the present one. Empty: `identity` is used for ever.
    std::filesystem::path identity_folder{};
};

/// A request to log in, over a connection that is signed or signed and encrypted.
struct Login {
    /// Name of the user; empty: the application itself logs in, by its certificate.
    std::string user;
    /// Password as the client sent it, decrypted.
    std::string password;
    /// SHA-1 of the application's certificate, which is trusted; hexadecimal.
    std::string thumbprint;
    /// Certificate of the application, in DER.
    std::string certificate;
};

/// User and role of a session that was accepted.
struct Admission {
    /// Name for records and refusals.
    std::string user;
    /// Role that decides about the session's rights.
    security::Role role = security::Role::observer;
};

/// A peer whose certificate was refused. All text came from the peer and was made printable.
struct RefusedPeer {
    /// Its certificate, in DER.
    std::string der;
    /// Reason of the refusal.
    security::CertificateRefusal refusal;
};

/// Security of a closed server. It serves over Basic256Sha256, Aes128_Sha256_RsaOaep and
/// Aes256_Sha256_RsaPss, signed or signed and encrypted, and only users that it knows. Without
/// security it answers only FindServers and GetEndpoints.
struct ServerSecurity {
    /// Certificate of the server and those that it trusts.
    Credentials credentials;
    /// Decides about a login; an error refuses it, and its text goes to the audit record. Called on
    /// the server's thread, as the next one: they must not wait.
    std::function<Result<Admission>(const Login&)> authenticate;
    /// Called for each peer whose certificate was refused; may be empty.
    std::function<void(const RefusedPeer&)> on_refused{};
};

}  // namespace metier::opcua
