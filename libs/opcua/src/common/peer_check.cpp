#include "common/peer_check.hpp"

#include <fmt/format.h>

#include <chrono>
#include <utility>

#include "common/convert.hpp"
#include "common/guard.hpp"
#include "metier/opcua/text.hpp"

namespace metier::opcua {

namespace {

StatusCode statusOf(security::RefusalKind kind) noexcept {
    using security::RefusalKind;
    switch (kind) {
        case RefusalKind::malformed:
            return StatusCode(UA_STATUSCODE_BADCERTIFICATEINVALID);
        case RefusalKind::untrusted:
            return StatusCode(UA_STATUSCODE_BADCERTIFICATEUNTRUSTED);
        case RefusalKind::expired:
        case RefusalKind::not_yet_valid:
            return StatusCode(UA_STATUSCODE_BADCERTIFICATETIMEINVALID);
        case RefusalKind::revoked:
            return StatusCode(UA_STATUSCODE_BADCERTIFICATEREVOKED);
        case RefusalKind::revocation_unknown:
            return StatusCode(UA_STATUSCODE_BADCERTIFICATEREVOCATIONUNKNOWN);
        case RefusalKind::weak:
            return StatusCode(UA_STATUSCODE_BADCERTIFICATEPOLICYCHECKFAILED);
        case RefusalKind::wrong_use:
            return StatusCode(UA_STATUSCODE_BADCERTIFICATEUSENOTALLOWED);
    }
    return StatusCode(UA_STATUSCODE_BADCERTIFICATEINVALID);
}

/// Runs `work` with the certificate that the stack asks about.
template <typename Work>
UA_StatusCode withCertificate(const UA_ByteString& der, const Work& work) noexcept {
    return guarded([&]() -> UA_StatusCode {
        const auto certificate = security::Certificate::fromDer(bytesOf(der));
        if (!certificate) {
            return UA_STATUSCODE_BADCERTIFICATEINVALID;
        }
        work(*certificate);
        return UA_STATUSCODE_GOOD;
    });
}

UA_StatusCode expiryOf(UA_DateTime* expiry, UA_ByteString* der) noexcept {
    return withCertificate(*der, [&](const security::Certificate& certificate) {
        *expiry =
            UA_DateTime_fromUnixTime(std::chrono::system_clock::to_time_t(certificate.notAfter()));
    });
}

UA_StatusCode subjectOf(UA_String* subject, UA_ByteString* der) noexcept {
    return withCertificate(*der, [&](const security::Certificate& certificate) {
        toNative(certificate.subject(), *subject);
    });
}

}  // namespace

struct PeerCheck::Callbacks {
    static UA_StatusCode check(const UA_CertificateVerification* plugin,
                               const UA_ByteString* der) noexcept {
        return guarded(
            [&] { return static_cast<PeerCheck*>(plugin->context)->check(bytesOf(*der)).value(); });
    }
    static UA_StatusCode checkUri(const UA_CertificateVerification* plugin,
                                  const UA_ByteString* der, const UA_String* uri) noexcept {
        return guarded([&] {
            return static_cast<PeerCheck*>(plugin->context)
                ->checkUri(bytesOf(*der), bytesOf(*uri))
                .value();
        });
    }
};

Result<std::unique_ptr<PeerCheck>> PeerCheck::create(const std::filesystem::path& trust_folder,
                                                     OnRefused on_refused) {
    METIER_ASSIGN(auto store, security::TrustStore::open(trust_folder));
    return std::unique_ptr<PeerCheck>(new PeerCheck(std::move(store), std::move(on_refused)));
}

PeerCheck::PeerCheck(security::TrustStore store, OnRefused on_refused)
    : store_(std::move(store)), on_refused_(std::move(on_refused)) {}

void PeerCheck::install(UA_CertificateVerification& plugin) {
    if (plugin.clear != nullptr) {
        plugin.clear(&plugin);
    }
    plugin.context = this;
    plugin.verifyCertificate = Callbacks::check;
    plugin.verifyApplicationURI = Callbacks::checkUri;
    plugin.getExpirationDate = expiryOf;
    plugin.getSubjectName = subjectOf;
    plugin.clear = nullptr;
}

void PeerCheck::installForSessions(UA_CertificateVerification& plugin) {
    install(plugin);
    plugin.verifyCertificate = [](const UA_CertificateVerification*,
                                  const UA_ByteString*) -> UA_StatusCode {
        return UA_STATUSCODE_BADIDENTITYTOKENREJECTED;
    };
}

StatusCode PeerCheck::check(std::string_view der) {
    const auto checked = store_.check(der, std::chrono::system_clock::now());
    if (checked) {
        last_refusal_.clear();
        if (on_trusted_) {
            on_trusted_();
        }
        return status::kGood;
    }
    last_refusal_ = checked.error().message;
    if (keeps_untrusted_ && checked.error().kind == security::RefusalKind::untrusted) {
        if (const auto certificate = security::Certificate::fromDer(der)) {
            store_.keepRejected(*certificate);
        }
    }
    if (on_refused_) {
        on_refused_({std::string(der), checked.error()});
    }
    return refuse(der, statusOf(checked.error().kind));
}

StatusCode PeerCheck::refuse(std::string_view der, StatusCode status) const {
    if (on_refusal_) {
        on_refusal_(der, status, last_refusal_);
    }
    return status;
}

/// Compares the whole URI; the stack's own plugin compares only a part of it. The stack calls this
/// when a Session is to be created, and sends the result to the client.
StatusCode PeerCheck::checkUri(std::string_view der, std::string_view application_uri) {
    const auto certificate = security::Certificate::fromDer(der);
    if (certificate && !application_uri.empty() &&
        certificate->applicationUri() == application_uri) {
        const bool may_create =
            !may_create_ || may_create_(certificate->thumbprint(), certificate->applicationUri());
        return may_create ? status::kGood : status::kBadTooManySessions;
    }
    last_refusal_ =
        fmt::format("the certificate is of \"{}\", not of \"{}\"",
                    certificate ? certificate->applicationUri() : "", sanitise(application_uri));
    return refuse(der, StatusCode(UA_STATUSCODE_BADCERTIFICATEURIINVALID));
}

}  // namespace metier::opcua
