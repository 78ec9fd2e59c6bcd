#include <fmt/format.h>
#include <openssl/err.h>
#include <openssl/x509_vfy.h>

#include <algorithm>

#include "holdings.hpp"
#include "openssl.hpp"

namespace metier::security {
namespace {

constexpr int kLeastKeyBits = 2048;

using StorePtr = std::unique_ptr<X509_STORE, Freed<X509_STORE_free>>;
using StoreContextPtr = std::unique_ptr<X509_STORE_CTX, Freed<X509_STORE_CTX_free>>;
using StackPtr =
    std::unique_ptr<STACK_OF(X509),
                    Freed<[](STACK_OF(X509) * stack) { sk_X509_pop_free(stack, X509_free); }>>;

tl::unexpected<CertificateRefusal> refuse(RefusalKind kind, const Certificate& certificate,
                                          std::string_view why) {
    return tl::unexpected(
        CertificateRefusal{kind, fmt::format("the certificate of {} ({}) {}", certificate.subject(),
                                             certificate.thumbprint(), why)});
}

using Verdict = tl::expected<void, CertificateRefusal>;

Verdict checkTime(const Certificate& certificate, UtcTime now) {
    if (now < certificate.notBefore()) {
        return refuse(RefusalKind::not_yet_valid, certificate,
                      "is valid from " + dateText(certificate.notBefore()) + " on");
    }
    if (now > certificate.notAfter()) {
        return refuse(RefusalKind::expired, certificate,
                      "was valid until " + dateText(certificate.notAfter()));
    }
    return {};
}

Verdict checkStrength(const Certificate& certificate, const X509* parsed) {
    if (certificate.keyBits() < kLeastKeyBits) {
        return refuse(
            RefusalKind::weak, certificate,
            fmt::format("has a key of {} bit, under {}", certificate.keyBits(), kLeastKeyBits));
    }
    int digest = NID_undef;
    X509_get_signature_info(const_cast<X509*>(parsed),  // NOLINT(*-const-cast): reads only
                            &digest, nullptr, nullptr, nullptr);
    if (digest == NID_sha1 || digest == NID_md5) {
        return refuse(RefusalKind::weak, certificate,
                      fmt::format("is signed with {}", OBJ_nid2sn(digest)));
    }
    return {};
}

Verdict checkUse(const Certificate& certificate, X509* parsed) {
    constexpr std::uint32_t kNeeded = KU_DIGITAL_SIGNATURE | KU_KEY_ENCIPHERMENT;
    const auto use = X509_get_key_usage(parsed);  // all bits if it does not say
    return (use & kNeeded) == kNeeded
               ? Verdict()
               : refuse(RefusalKind::wrong_use, certificate,
                        "is not for digital signatures and key encipherment");
}

/// Reports whether a stored revocation list, signed by the known issuer, names the certificate.
bool isRevoked(X509* parsed, const TrustStore::Holdings& holdings) {
    bool revoked = false;
    holdings.forEach([&](const Certificate& one) {
        const auto issuer = parseDer(one.der());
        if (X509_check_issued(issuer.get(), parsed) != X509_V_OK) {
            return;
        }
        for (const auto& list : holdings.lists) {
            X509_REVOKED* entry = nullptr;
            revoked =
                revoked || (X509_CRL_verify(list.get(), X509_get0_pubkey(issuer.get())) == 1 &&
                            X509_CRL_get0_by_cert(list.get(), &entry, parsed) == 1);
        }
    });
    return revoked;
}

RefusalKind kindOf(int code) {
    switch (code) {
        case X509_V_ERR_CERT_HAS_EXPIRED:
            return RefusalKind::expired;
        case X509_V_ERR_CERT_NOT_YET_VALID:
            return RefusalKind::not_yet_valid;
        case X509_V_ERR_CERT_REVOKED:
            return RefusalKind::revoked;
        case X509_V_ERR_UNABLE_TO_GET_CRL:
        case X509_V_ERR_CRL_HAS_EXPIRED:
        case X509_V_ERR_CRL_NOT_YET_VALID:
            return RefusalKind::revocation_unknown;
        case X509_V_ERR_EE_KEY_TOO_SMALL:
        case X509_V_ERR_CA_KEY_TOO_SMALL:
        case X509_V_ERR_CA_MD_TOO_WEAK:
            return RefusalKind::weak;
        default:
            return RefusalKind::untrusted;
    }
}

/// Roots end a chain; everything else that is known here may be part of it.
StorePtr storeOf(const TrustStore::Holdings& holdings, STACK_OF(X509) * between) {
    StorePtr store(X509_STORE_new());
    holdings.forEach([&](const Certificate& certificate) {
        auto parsed = parseDer(certificate.der());
        if (certificate.isSelfSigned() && certificate.isAuthority()) {
            X509_STORE_add_cert(store.get(), parsed.get());
        } else if (certificate.isAuthority()) {
            sk_X509_push(between, parsed.release());
        }
    });
    for (const auto& list : holdings.lists) {
        X509_STORE_add_crl(store.get(), list.get());
    }
    return store;
}

/// Through authorities up to a root, with a revocation list of each; one of them is trusted.
Verdict checkChain(const Certificate& certificate, X509* parsed,
                   const TrustStore::Holdings& holdings, UtcTime now) {
    constexpr int kAuthLevel = 2;  // 112 bit: RSA of 2048, SHA-256
    const StackPtr between(sk_X509_new_null());
    const auto store = storeOf(holdings, between.get());
    const StoreContextPtr context(X509_STORE_CTX_new());
    X509_STORE_CTX_init(context.get(), store.get(), parsed, between.get());
    auto* parameters = X509_STORE_CTX_get0_param(context.get());
    X509_VERIFY_PARAM_set_flags(parameters, X509_V_FLAG_CRL_CHECK | X509_V_FLAG_CRL_CHECK_ALL);
    X509_VERIFY_PARAM_set_time(parameters, std::chrono::system_clock::to_time_t(now));
    X509_VERIFY_PARAM_set_auth_level(parameters, kAuthLevel);
    if (X509_verify_cert(context.get()) != 1) {
        const int code = X509_STORE_CTX_get_error(context.get());
        ERR_clear_error();
        return refuse(kindOf(code), certificate,
                      fmt::format("is refused: {}", X509_verify_cert_error_string(code)));
    }
    return holdings.trustsOneOf(X509_STORE_CTX_get0_chain(context.get()))
               ? Verdict()
               : refuse(RefusalKind::untrusted, certificate, "is of nobody who is trusted");
}

Verdict checkTrust(const Certificate& certificate, X509* parsed,
                   const TrustStore::Holdings& holdings, UtcTime now) {
    if (holdings.trusts(certificate)) {
        return isRevoked(parsed, holdings)
                   ? refuse(RefusalKind::revoked, certificate, "was revoked by its issuer")
                   : Verdict();
    }
    if (certificate.isSelfSigned()) {
        return refuse(RefusalKind::untrusted, certificate, "is not trusted");
    }
    return checkChain(certificate, parsed, holdings, now);
}

}  // namespace

tl::expected<void, CertificateRefusal> checkCertificate(const Certificate& certificate,
                                                        const TrustStore::Holdings& holdings,
                                                        UtcTime now) {
    const auto parsed = parseDer(certificate.der());
    return checkTrust(certificate, parsed.get(), holdings, now)
        .and_then([&] { return checkStrength(certificate, parsed.get()); })
        .and_then([&] { return checkUse(certificate, parsed.get()); })
        .and_then([&] { return checkTime(certificate, now); });
}

}  // namespace metier::security
