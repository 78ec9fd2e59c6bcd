#include "metier/security/trust_store.hpp"

#include <fmt/format.h>
#include <openssl/err.h>

#include <utility>

#include "holdings.hpp"
#include "openssl.hpp"
#include "private_file.hpp"

namespace metier::security {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostRejected = 100;

fs::path fileOf(const fs::path& folder, const Certificate& certificate) {
    return folder / (certificate.thumbprint() + ".der");
}

/// The one whose thumbprint begins so.
Result<Certificate> find(std::string_view name, const std::vector<Certificate>& among,
                         std::string_view what) {
    const Certificate* found = nullptr;
    for (const auto& certificate : among) {
        if (name.empty() || !certificate.thumbprint().starts_with(name)) {
            continue;
        }
        if (found != nullptr && !(*found == certificate)) {
            return fail(Errc::invalid_argument,
                        fmt::format("several {} certificates begin with \"{}\"", what, name));
        }
        found = &certificate;
    }
    return found != nullptr
               ? Result<Certificate>(*found)
               : fail(Errc::not_found, fmt::format("no {} certificate \"{}\"", what, name));
}

/// Whatever the files are called.
void removeFrom(const fs::path& folder, const Certificate& certificate) {
    for (const auto& file : filesIn(folder)) {
        const auto held = Certificate::fromFile(file);
        if (held && *held == certificate) {
            std::error_code error;
            fs::remove(file, error);
        }
    }
}

}  // namespace

TrustStore::TrustStore(fs::path folder, std::chrono::milliseconds patience)
    : folder_(std::move(folder)),
      patience_(patience),
      opened_with_(std::make_shared<Holdings>(folder_)) {}
TrustStore::~TrustStore() = default;
TrustStore::TrustStore(TrustStore&& other) noexcept = default;
TrustStore& TrustStore::operator=(TrustStore&& other) noexcept = default;

Result<TrustStore> TrustStore::open(fs::path folder, std::chrono::milliseconds patience) {
    for (const auto* part : {kTrusted, kTrustedLists, kIssuers, kIssuersLists, kRejected}) {
        std::error_code error;
        fs::create_directories(folder / part, error);
        if (error) {
            return failed(folder / part, error.value());
        }
    }
    return TrustStore(std::move(folder), patience);
}

tl::expected<Certificate, CertificateRefusal> TrustStore::check(std::string_view der, UtcTime now) {
    auto certificate = Certificate::fromDer(der);
    if (!certificate) {
        return tl::unexpected(
            CertificateRefusal{RefusalKind::malformed, certificate.error().message});
    }
    METIER_TRY(checkCertificate(*certificate, *holdings(), now));
    return std::move(*certificate);
}

std::shared_ptr<const TrustStore::Holdings> TrustStore::holdings() {
    using Kept = std::shared_ptr<const Holdings>;
    if (holdings_ == nullptr) {
        holdings_ = std::make_unique<BackgroundRead<Holdings>>(
            std::exchange(opened_with_, nullptr),
            [folder = folder_](const Kept& last) -> Kept {
                return last->isCurrent() ? last : std::make_shared<Holdings>(folder);
            },
            patience_);
    }
    return holdings_->get();
}

void TrustStore::keepRejected(const Certificate& certificate) const {
    const auto file = fileOf(folder_ / kRejected, certificate);
    std::error_code error;
    if (fs::exists(file, error)) {
        return;
    }
    makeRoom(folder_ / kRejected, kMostRejected);
    // The certificate is refused also if the folder cannot be written; the log reports the refusal.
    static_cast<void>(writeWhole(file, certificate.der(), Readers::everybody));
}

std::vector<Certificate> TrustStore::trusted() const {
    return certificatesIn(folder_ / kTrusted);
}

std::vector<Certificate> TrustStore::rejected() const {
    return certificatesIn(folder_ / kRejected);
}

Result<void> TrustStore::trust(const Certificate& certificate) {
    METIER_TRY(
        writeWhole(fileOf(folder_ / kTrusted, certificate), certificate.der(), Readers::everybody));
    removeFrom(folder_ / kRejected, certificate);
    return {};
}

Result<Certificate> TrustStore::distrust(std::string_view name) {
    METIER_ASSIGN(auto certificate, find(name, trusted(), "trusted"));
    keepRejected(certificate);
    removeFrom(folder_ / kTrusted, certificate);
    return certificate;
}

Result<Certificate> TrustStore::trustRejected(std::string_view name) {
    METIER_ASSIGN(auto certificate, find(name, rejected(), "rejected"));
    METIER_TRY(trust(certificate));
    return certificate;
}

Result<void> TrustStore::addRevocationList(const fs::path& file) {
    std::error_code error;
    if (!fs::is_regular_file(file, error)) {
        return fail(Errc::not_found, fmt::format("no such file: {}", file.string()));
    }
    const auto text = readFile(file.string());
    const auto list = parseCrlPemOrDer(text);
    if (list == nullptr) {
        return fail(Errc::invalid_argument,
                    fmt::format("{} is no revocation list in DER or PEM", file.string()));
    }
    for (const auto* place : {kTrusted, kIssuers}) {
        for (const auto& authority : certificatesIn(folder_ / place)) {
            const auto parsed = parseDer(authority.der());
            if (X509_CRL_verify(list.get(), X509_get0_pubkey(parsed.get())) == 1) {
                const auto* lists = place == kTrusted ? kTrustedLists : kIssuersLists;
                return writeWhole(folder_ / lists / (authority.thumbprint() + ".crl"), text,
                                  Readers::everybody);
            }
        }
    }
    ERR_clear_error();
    return fail(Errc::not_found,
                fmt::format("{} is of no authority that is known here", file.string()));
}

}  // namespace metier::security
