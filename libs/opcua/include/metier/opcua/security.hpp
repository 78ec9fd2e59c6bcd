#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "metier/base/error.hpp"
#include "metier/trust/identity.hpp"
#include "metier/trust/trust_store.hpp"

namespace metier::opcua {

/// Who an application is, and whom it trusts.
struct Credentials {
    /// Its certificate names the ApplicationUri.
    trust::Identity identity;
    /// Of a trust::TrustStore, which is read again after changes.
    std::filesystem::path trust_folder;
};

/// Somebody who wants to log in, over a connection that is encrypted or signed.
struct Login {
    std::string user;
    std::string password;
    std::string thumbprint;  ///< of the application's certificate, which is trusted
};

/// A peer whose certificate was refused. All text came from the peer, printable.
struct RefusedPeer {
    std::string der;
    trust::CertificateRefusal refusal;
};

/// What makes a server closed: it serves over Basic256Sha256, Aes128_Sha256_RsaOaep and
/// Aes256_Sha256_RsaPss, signed or signed and encrypted, and to users that it knows. Without
/// security it answers FindServers and GetEndpoints only.
struct ServerSecurity {
    Credentials credentials;
    /// Whether a user may log in; the server's thread, so it must not wait.
    std::function<Result<void>(const Login&)> authenticate;
    /// Told of each refusal on the server's thread; may be empty.
    std::function<void(const RefusedPeer&)> on_refused;
};

}  // namespace metier::opcua
