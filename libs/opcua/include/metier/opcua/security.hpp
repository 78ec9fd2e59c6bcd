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

/// Who an application is, and whom it trusts.
struct Credentials {
    /// Its certificate names the ApplicationUri.
    security::Identity identity;
    /// Of a security::TrustStore, which is read again after changes.
    std::filesystem::path trust_folder;
    /// Where the identity is kept, see security::loadIdentity(): each new connection of a client takes
    /// the present one. Empty: `identity` for ever.
    std::filesystem::path identity_folder{};
};

/// Somebody who wants to log in, over a connection that is encrypted or signed.
struct Login {
    std::string user;  ///< empty: it is the application itself
    std::string password;
    std::string thumbprint;   ///< of the application's certificate, which is trusted
    std::string certificate;  ///< in DER
};

/// As whom somebody was let in.
struct Admission {
    std::string user;
    security::Role role = security::Role::observer;
};

/// Something that a session wanted to do and may not in its role.
struct Denial {
    Session session;
    NodeId object;
    NodeId method;
};

/// A peer whose certificate was refused. All text came from the peer, printable.
struct RefusedPeer {
    std::string der;
    security::CertificateRefusal refusal;
};

/// What makes a server closed: it serves over Basic256Sha256, Aes128_Sha256_RsaOaep and
/// Aes256_Sha256_RsaPss, signed or signed and encrypted, and to users that it knows. Without
/// security it answers FindServers and GetEndpoints only.
struct ServerSecurity {
    Credentials credentials;
    /// As whom somebody may log in. This and the others on the server's thread: they must not wait.
    std::function<Result<Admission>(const Login&)> authenticate;
    /// Told of each peer that is refused; may be empty.
    std::function<void(const RefusedPeer&)> on_refused{};
    /// Told of each Method that a session may not call; may be empty.
    std::function<void(const Denial&)> on_denied{};
};

}  // namespace metier::opcua
