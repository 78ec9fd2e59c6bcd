#include "authority.hpp"

#include <openssl/rsa.h>

#include <map>
#include <stdexcept>

#include "openssl.hpp"

namespace metier::security {
namespace {

void must(bool done) {
    if (!done) {
        throw std::runtime_error("OpenSSL refuses to make a certificate");
    }
}

/// Keys take long to make: one of each size for all tests.
EVP_PKEY* keyOf(int bits) {
    static std::map<int, KeyPtr> keys;
    auto& key = keys[bits];
    if (!key) {
        key.reset(EVP_RSA_gen(static_cast<unsigned>(bits)));
    }
    must(key != nullptr);
    return key.get();
}

void setName(X509_NAME* name, const std::string& text) {
    must(X509_NAME_add_entry_by_txt(name, "CN", MBSTRING_UTF8,
                                    reinterpret_cast<const unsigned char*>(text.c_str()), -1, -1,
                                    0) == 1);
}

void extend(X509* certificate, X509* issuer, int kind, const std::string& value) {
    X509V3_CTX context;
    X509V3_set_ctx(&context, issuer, certificate, nullptr, nullptr, 0);
    const std::unique_ptr<X509_EXTENSION, Freed<X509_EXTENSION_free>> extension(
        X509V3_EXT_conf_nid(nullptr, &context, kind, value.c_str()));
    must(extension && X509_add_ext(certificate, extension.get(), -1) == 1);
}

std::time_t seconds(UtcTime time) {
    return std::chrono::system_clock::to_time_t(time);
}

X509Ptr begin(const Wanted& wanted) {
    static long serial = 1000;
    X509Ptr certificate(X509_new());
    must(certificate && X509_set_version(certificate.get(), X509_VERSION_3) == 1);
    ASN1_INTEGER_set(X509_get_serialNumber(certificate.get()), ++serial);
    setName(X509_get_subject_name(certificate.get()), wanted.name);
    ASN1_TIME_set(X509_getm_notBefore(certificate.get()), seconds(wanted.not_before));
    ASN1_TIME_set(X509_getm_notAfter(certificate.get()), seconds(wanted.not_after));
    return certificate;
}

void addUse(X509* certificate, X509* issuer, const Wanted& wanted) {
    extend(certificate, issuer, NID_basic_constraints, "critical,CA:FALSE");
    extend(certificate, issuer, NID_key_usage, wanted.key_usage);
    if (!wanted.uri.empty()) {
        extend(certificate, issuer, NID_subject_alt_name, wanted.uri);
    }
}

Certificate finish(X509* certificate, EVP_PKEY* signer, bool sha1) {
    must(X509_sign(certificate, signer, sha1 ? EVP_sha1() : EVP_sha256()) > 0);
    return Certificate::fromDer(derOf(certificate)).value();
}

Wanted withUri(Wanted wanted) {
    wanted.uri = wanted.uri.empty() ? "" : "URI:" + wanted.uri;
    return wanted;
}

}  // namespace

struct Authority::Impl {
    KeyPtr key;
    X509Ptr certificate;
};

Authority::Authority(const std::string& name, const Authority* signer)
    : impl_(std::make_unique<Impl>()) {
    Wanted wanted;
    wanted.name = name;
    impl_->key.reset(EVP_RSA_gen(2048));
    impl_->certificate = begin(wanted);
    auto* own = impl_->certificate.get();
    auto* issuer = signer == nullptr ? own : signer->impl_->certificate.get();
    must(X509_set_pubkey(own, impl_->key.get()) == 1 &&
         X509_set_issuer_name(own, X509_get_subject_name(issuer)) == 1);
    extend(own, issuer, NID_basic_constraints, "critical,CA:TRUE");
    extend(own, issuer, NID_key_usage, "critical,keyCertSign,cRLSign");
    extend(own, issuer, NID_subject_key_identifier, "hash");
    certificate_ =
        finish(own, signer == nullptr ? impl_->key.get() : signer->impl_->key.get(), false);
}

Authority::~Authority() = default;

Certificate Authority::sign(const Wanted& wanted) const {
    const auto certificate = begin(wanted);
    must(X509_set_pubkey(certificate.get(), keyOf(wanted.key_bits)) == 1 &&
         X509_set_issuer_name(certificate.get(), X509_get_subject_name(impl_->certificate.get())) ==
             1);
    addUse(certificate.get(), impl_->certificate.get(), withUri(wanted));
    return finish(certificate.get(), impl_->key.get(), wanted.sha1);
}

std::string Authority::revocationList(const std::optional<Certificate>& revoked,
                                      UtcTime until) const {
    const CrlPtr list(X509_CRL_new());
    const auto now = seconds(std::chrono::system_clock::now() - std::chrono::hours(1));
    const std::unique_ptr<ASN1_TIME, Freed<ASN1_TIME_free>> since(ASN1_TIME_set(nullptr, now));
    const std::unique_ptr<ASN1_TIME, Freed<ASN1_TIME_free>> next(
        ASN1_TIME_set(nullptr, seconds(until)));
    must(X509_CRL_set_version(list.get(), 1) == 1 &&
         X509_CRL_set_issuer_name(list.get(), X509_get_subject_name(impl_->certificate.get())) ==
             1 &&
         X509_CRL_set1_lastUpdate(list.get(), since.get()) == 1 &&
         X509_CRL_set1_nextUpdate(list.get(), next.get()) == 1);
    if (revoked) {
        const auto parsed = parseDer(revoked->der());
        X509_REVOKED* entry = X509_REVOKED_new();
        must(X509_REVOKED_set_serialNumber(entry, X509_get_serialNumber(parsed.get())) == 1 &&
             X509_REVOKED_set_revocationDate(entry, since.get()) == 1 &&
             X509_CRL_add0_revoked(list.get(), entry) == 1);
    }
    must(X509_CRL_sign(list.get(), impl_->key.get(), EVP_sha256()) > 0);
    const BioPtr out(BIO_new(BIO_s_mem()));
    must(i2d_X509_CRL_bio(out.get(), list.get()) == 1);
    return textOf(out.get());
}

Certificate selfSigned(const Wanted& wanted) {
    const auto certificate = begin(wanted);
    must(X509_set_pubkey(certificate.get(), keyOf(wanted.key_bits)) == 1 &&
         X509_set_issuer_name(certificate.get(), X509_get_subject_name(certificate.get())) == 1);
    addUse(certificate.get(), certificate.get(), withUri(wanted));
    return finish(certificate.get(), keyOf(wanted.key_bits), wanted.sha1);
}

}  // namespace metier::security
