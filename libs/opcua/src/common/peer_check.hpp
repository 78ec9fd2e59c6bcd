#pragma once

#include <open62541/plugin/pki.h>

#include <functional>
#include <memory>
#include <string>

#include "metier/opcua/security.hpp"
#include "metier/opcua/status_code.hpp"

namespace metier::opcua {

/// Checks the certificates of peers for the stack.
///
/// Threading: that of the server or client that it is installed in.
class PeerCheck {
public:
    using OnRefused = std::function<void(const RefusedPeer&)>;

    /// Errors: resource_unavailable (the trust folder).
    static Result<std::unique_ptr<PeerCheck>> create(const std::filesystem::path& trust_folder,
                                                     OnRefused on_refused);
    PeerCheck(const PeerCheck&) = delete;
    PeerCheck& operator=(const PeerCheck&) = delete;

    /// In place of what is there. This must outlive whatever is made with the configuration.
    void install(UA_CertificateVerification& plugin);
    /// For the sessions of a server: whose ApplicationUri it is, but no users by certificate.
    void installForSessions(UA_CertificateVerification& plugin);
    /// \param why text of the peer may be in it, printable
    using OnRefusal =
        std::function<void(std::string_view der, StatusCode status, const std::string& why)>;
    /// Called for every refusal, also of a certificate that is in order but not the application's.
    void onRefusal(OnRefusal handler) { on_refusal_ = std::move(handler); }
    /// Called whenever a peer's certificate is trusted.
    void onTrusted(std::function<void()> handler) { on_trusted_ = std::move(handler); }
    /// Asked whether an application may create a Session.
    /// \param may_create gets the certificate's thumbprint and the ApplicationUri
    void onSession(std::function<bool(const std::string&, const std::string&)> may_create) {
        may_create_ = std::move(may_create);
    }
    /// Why the last peer was refused; empty if it was not.
    const std::string& lastRefusal() const noexcept { return last_refusal_; }
    /// Stores each certificate that is not trusted for a later decision of a person, besides
    /// reporting it.
    void keepUntrusted() noexcept { keeps_untrusted_ = true; }

private:
    struct Callbacks;
    PeerCheck(security::TrustStore store, OnRefused on_refused);
    StatusCode refuse(std::string_view der, StatusCode status) const;
    StatusCode check(std::string_view der);
    StatusCode checkUri(std::string_view der, std::string_view application_uri);

    security::TrustStore store_;
    OnRefused on_refused_;
    OnRefusal on_refusal_;
    std::function<void()> on_trusted_;
    std::function<bool(const std::string&, const std::string&)> may_create_;
    std::string last_refusal_;
    bool keeps_untrusted_ = false;
};

}  // namespace metier::opcua
