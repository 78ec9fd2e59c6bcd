#include "metier/security/identity.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/rand.h>
#include <openssl/rsa.h>

#include <algorithm>
#include <array>
#include <functional>

#include "openssl.hpp"
#include "private_file.hpp"

namespace metier::security {
namespace {

constexpr int kLeastBits = 2048;
constexpr int kMostBits = 4096;
constexpr int kSerialBytes = 16;
constexpr std::size_t kLongestCommonName = 64;  // RFC 5280, appendix A.1
constexpr std::chrono::days kLongestLifetime{36'525};
constexpr auto kClockDifference = std::chrono::hours(1);
constexpr const char* kIdentityFile = "identity.pem";
constexpr const char* kCertificateFile = "certificate.der";

tl::unexpected<Error> libraryFailed(const char* what) {
    std::array<char, 256> text{};
    ERR_error_string_n(ERR_get_error(), text.data(), text.size());
    return fail(Errc::internal, fmt::format("{}: {}", what, text.data()));
}

bool isAddress(const std::string& host) {
    return !host.empty() && host.find_first_not_of("0123456789.") == std::string::npos;
}

/// A name of digits and points that is no address cannot be in a certificate.
bool isWrongAddress(const std::string& host) {
    in_addr address{};
    return isAddress(host) && ::inet_pton(AF_INET, host.c_str(), &address) != 1;
}

/// Alternative names in the configuration language of OpenSSL; characters that could end an element
/// are refused.
Result<std::string> alternativeNames(const IdentityOptions& options) {
    auto names = "URI:" + options.application_uri;
    for (const auto& host : options.hosts) {
        names += fmt::format(",{}:{}", isAddress(host) ? "IP" : "DNS", host);
    }
    const auto plain = [](char c) { return c > ' ' && c <= '~' && c != ',' && c != '"'; };
    const bool all_plain =
        std::all_of(options.application_uri.begin(), options.application_uri.end(), plain) &&
        std::all_of(options.hosts.begin(), options.hosts.end(), [&](const std::string& host) {
            return !host.empty() && !isWrongAddress(host) &&
                   std::all_of(host.begin(), host.end(), plain);
        });
    if (options.application_uri.empty() || !all_plain) {
        return fail(Errc::invalid_argument,
                    fmt::format("\"{}\" cannot be the names of a certificate", names));
    }
    return names;
}

bool addExtension(X509* certificate, int kind, const std::string& value) {
    X509V3_CTX context;
    X509V3_set_ctx(&context, certificate, certificate, nullptr, nullptr, 0);
    const std::unique_ptr<X509_EXTENSION, Freed<X509_EXTENSION_free>> extension(
        X509V3_EXT_conf_nid(nullptr, &context, kind, value.c_str()));
    return extension && X509_add_ext(certificate, extension.get(), -1) == 1;
}

/// Adds the extensions that OPC 10000-6, 6.2.2 demands of an application's certificate.
bool addExtensions(X509* certificate) {
    return addExtension(certificate, NID_subject_key_identifier, "hash") &&
           addExtension(certificate, NID_authority_key_identifier, "keyid:always") &&
           addExtension(certificate, NID_basic_constraints, "critical,CA:FALSE") &&
           addExtension(certificate, NID_key_usage,
                        "critical,digitalSignature,nonRepudiation,keyEncipherment,"
                        "dataEncipherment,keyCertSign") &&
           addExtension(certificate, NID_ext_key_usage, "serverAuth,clientAuth");
}

bool setSerial(X509* certificate) {
    std::array<unsigned char, kSerialBytes> bytes{};
    if (RAND_bytes(bytes.data(), kSerialBytes) != 1) {
        return false;
    }
    bytes[0] = static_cast<unsigned char>((bytes[0] & 0x7FU) | 0x40U);  // positive, and not short
    const std::unique_ptr<BIGNUM, Freed<BN_free>> number(
        BN_bin2bn(bytes.data(), kSerialBytes, nullptr));
    return number && BN_to_ASN1_INTEGER(number.get(), X509_get_serialNumber(certificate));
}

bool setName(X509* certificate, const std::string& application_name) {
    X509_NAME* name = X509_get_subject_name(certificate);
    const auto* text = reinterpret_cast<const unsigned char*>(application_name.c_str());
    return X509_NAME_add_entry_by_txt(name, "CN", MBSTRING_UTF8, text, -1, -1, 0) == 1 &&
           X509_set_issuer_name(certificate, name) == 1;
}

void setTimes(X509* certificate, std::chrono::days lifetime, UtcTime now) {
    const auto seconds = [](UtcTime time) { return std::chrono::system_clock::to_time_t(time); };
    ASN1_TIME_set(X509_getm_notBefore(certificate), seconds(now - kClockDifference));
    ASN1_TIME_set(X509_getm_notAfter(certificate), seconds(now + lifetime));
}

Result<std::string> keyDer(const EVP_PKEY* key) {
    const BioPtr out(BIO_new(BIO_s_mem()));
    if (i2d_PKCS8PrivateKey_bio(out.get(), key, nullptr, nullptr, 0, nullptr, nullptr) != 1) {
        return libraryFailed("write a key");
    }
    return textOf(out.get());
}

Result<Identity> identityOf(std::string_view certificate_der, const EVP_PKEY* key) {
    METIER_ASSIGN(auto private_key, keyDer(key));
    METIER_ASSIGN(auto certificate, Certificate::fromDer(certificate_der));
    return Identity{std::move(certificate), std::move(private_key)};
}

std::string keyPem(const std::string& der) {
    const KeyPtr key(d2i_PrivateKey_bio(reading(der).get(), nullptr));
    const BioPtr out(BIO_new(BIO_s_mem()));
    PEM_write_bio_PKCS8PrivateKey(out.get(), key.get(), nullptr, nullptr, 0, nullptr, nullptr);
    return textOf(out.get());
}

struct Strength {
    std::chrono::days lifetime;
    int key_bits;
};

Result<void> checkLifetime(std::chrono::days lifetime) {
    return lifetime.count() > 0 && lifetime <= kLongestLifetime
               ? Result<void>()
               : fail(Errc::invalid_argument,
                      fmt::format("a lifetime of {} days is not within 1 to {}", lifetime.count(),
                                  kLongestLifetime.count()));
}

Result<void> checkOptions(const IdentityOptions& options) {
    if (options.key_bits < kLeastBits || options.key_bits > kMostBits) {
        return fail(Errc::invalid_argument, fmt::format("a key of {} bit is not within {} to {}",
                                                        options.key_bits, kLeastBits, kMostBits));
    }
    const auto& name = options.application_name;
    if (name.empty() || name.size() > kLongestCommonName || name.find('\0') != std::string::npos) {
        return fail(Errc::invalid_argument,
                    fmt::format("an application's name has 1 to {} bytes, not {}",
                                kLongestCommonName, name.size()));
    }
    return checkLifetime(options.lifetime);
}

/// \param name sets subject, issuer and SubjectAltName
Result<Identity> makeFor(const std::function<bool(X509*)>& name, const Strength& strength,
                         UtcTime now) {
    const KeyPtr key(EVP_RSA_gen(static_cast<unsigned int>(strength.key_bits)));
    const X509Ptr certificate(X509_new());
    if (!key || !certificate) {
        return libraryFailed("make a key");
    }
    setTimes(certificate.get(), strength.lifetime, now);
    const bool made =
        X509_set_version(certificate.get(), X509_VERSION_3) == 1 && setSerial(certificate.get()) &&
        X509_set_pubkey(certificate.get(), key.get()) == 1 && addExtensions(certificate.get()) &&
        name(certificate.get()) && X509_sign(certificate.get(), key.get(), EVP_sha256()) > 0;
    const auto der = made ? derOf(certificate.get()) : std::string();
    if (der.empty()) {
        return libraryFailed("make a certificate");
    }
    return identityOf(der, key.get());
}

}  // namespace

Result<Identity> makeIdentity(const IdentityOptions& options, UtcTime now) {
    METIER_TRY(checkOptions(options));
    METIER_ASSIGN(const auto names, alternativeNames(options));
    return makeFor(
        [&](X509* certificate) {
            return setName(certificate, options.application_name) &&
                   addExtension(certificate, NID_subject_alt_name, names);
        },
        {options.lifetime, options.key_bits}, now);
}

Result<Identity> makeSuccessor(const Identity& former, std::chrono::days lifetime, UtcTime now) {
    METIER_TRY(checkLifetime(lifetime));
    const auto parsed = parseDer(former.certificate.der());
    if (!parsed) {
        return libraryFailed("read a certificate");
    }
    return makeFor(
        [&](X509* certificate) {
            const auto* name = X509_get_subject_name(parsed.get());
            const int at = X509_get_ext_by_NID(parsed.get(), NID_subject_alt_name, -1);
            return X509_set_subject_name(certificate, name) == 1 &&
                   X509_set_issuer_name(certificate, name) == 1 &&
                   (at < 0 || X509_add_ext(certificate, X509_get_ext(parsed.get(), at), -1) == 1);
        },
        {lifetime, former.certificate.keyBits()}, now);
}

Result<Identity> loadIdentity(const std::filesystem::path& folder) {
    const auto file = folder / kIdentityFile;
    METIER_ASSIGN(const auto text, readPrivate(file));
    const KeyPtr key(PEM_read_bio_PrivateKey(reading(text).get(), nullptr, nullptr, nullptr));
    const auto parsed = parsePemOrDer(text);
    if (!key || !parsed || X509_check_private_key(parsed.get(), key.get()) != 1) {
        ERR_clear_error();
        return fail(Errc::invalid_argument,
                    fmt::format("{} does not hold a certificate and its key", file.string()));
    }
    return identityOf(derOf(parsed.get()), key.get());
}

Result<void> saveIdentity(const std::filesystem::path& folder, const Identity& identity) {
    const auto both = keyPem(identity.private_key) + identity.certificate.pem();
    METIER_TRY(writeWhole(folder / kIdentityFile, both, Readers::owner));
    return writeWhole(folder / kCertificateFile, identity.certificate.der(), Readers::everybody);
}

}  // namespace metier::security
