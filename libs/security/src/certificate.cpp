#include "metier/security/certificate.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <openssl/pem.h>

#include <algorithm>
#include <ctime>

#include "openssl.hpp"

namespace metier::security {
namespace {

constexpr long kPrintable = ASN1_STRFLGS_ESC_CTRL | ASN1_STRFLGS_ESC_MSB | XN_FLAG_SEP_CPLUS_SPC;

std::string nameText(const X509_NAME* name) {
    const BioPtr out(BIO_new(BIO_s_mem()));
    X509_NAME_print_ex(out.get(), name, 0, static_cast<unsigned long>(kPrintable));
    return textOf(out.get());
}

UtcTime timeOf(const ASN1_TIME* time) {
    std::tm parts{};
    if (ASN1_TIME_to_tm(time, &parts) != 1) {
        return {};
    }
    // Certificates may be of the year 9999; our clock ends in 2262.
    using std::chrono::floor;
    using std::chrono::seconds;
    const seconds since_1970{timegm(&parts)};
    return UtcTime(std::clamp(since_1970,
                              floor<seconds>(UtcTime::min().time_since_epoch()) + seconds(1),
                              floor<seconds>(UtcTime::max().time_since_epoch())));
}

/// The one URI of the SubjectAltName, if it is printable and there is no other.
std::string uriOf(const X509* certificate) {
    const std::unique_ptr<GENERAL_NAMES, Freed<GENERAL_NAMES_free>> names(
        static_cast<GENERAL_NAMES*>(
            X509_get_ext_d2i(certificate, NID_subject_alt_name, nullptr, nullptr)));
    std::string uri;
    for (int i = 0; names && i < sk_GENERAL_NAME_num(names.get()); ++i) {
        const auto* name = sk_GENERAL_NAME_value(names.get(), i);
        if (name->type != GEN_URI) {
            continue;
        }
        const auto* text = name->d.uniformResourceIdentifier;
        const auto* bytes = ASN1_STRING_get0_data(text);
        const std::string one(bytes, bytes + ASN1_STRING_length(text));
        const bool printable =
            std::all_of(one.begin(), one.end(), [](char c) { return c > ' ' && c <= '~'; });
        if (!uri.empty() || !printable) {
            return {};
        }
        uri = one;
    }
    return uri;
}

}  // namespace

std::string thumbprintOf(std::string_view der) {
    return digestOf(der, EVP_sha1());
}

std::string dateText(UtcTime time) {
    return fmt::format("{:%F}", fmt::gmtime(std::chrono::system_clock::to_time_t(time)));
}

Result<Certificate> Certificate::fromDer(std::string_view der) {
    const auto parsed = parseDer(der);
    if (parsed == nullptr) {
        return fail(Errc::invalid_argument,
                    fmt::format("{} byte that are no X.509 certificate", der.size()));
    }
    const EVP_PKEY* key = X509_get0_pubkey(parsed.get());
    Certificate certificate;
    certificate.der_ = derOf(parsed.get());
    if (!der.starts_with(certificate.der_)) {  // it would have other thumbprints elsewhere
        return fail(Errc::invalid_argument, "a certificate that is encoded, but not by DER");
    }
    certificate.thumbprint_ = thumbprintOf(certificate.der_);
    certificate.subject_ = nameText(X509_get_subject_name(parsed.get()));
    certificate.issuer_ = nameText(X509_get_issuer_name(parsed.get()));
    certificate.application_uri_ = uriOf(parsed.get());
    certificate.not_before_ = timeOf(X509_get0_notBefore(parsed.get()));
    certificate.not_after_ = timeOf(X509_get0_notAfter(parsed.get()));
    certificate.key_bits_ = key == nullptr ? 0 : EVP_PKEY_get_bits(key);
    certificate.self_signed_ = X509_self_signed(parsed.get(), 1) == 1;
    certificate.authority_ = X509_check_ca(parsed.get()) == 1;
    return certificate;
}

Result<Certificate> Certificate::fromFile(const std::filesystem::path& file) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) {
        return fail(Errc::not_found, fmt::format("no such file: {}", file.string()));
    }
    const auto parsed = parsePemOrDer(readFile(file.string()));
    if (parsed == nullptr) {
        return fail(Errc::invalid_argument,
                    fmt::format("{} is no X.509 certificate in DER or PEM", file.string()));
    }
    return fromDer(derOf(parsed.get()));
}

std::string Certificate::pem() const {
    const auto parsed = parseDer(der_);
    const BioPtr out(BIO_new(BIO_s_mem()));
    PEM_write_bio_X509(out.get(), parsed.get());
    return textOf(out.get());
}

}  // namespace metier::security
