#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <vector>

#include "metier/security/trust_store.hpp"
#include "openssl.hpp"

namespace metier::security {

// The folders of a TrustStore.
constexpr const char* kTrusted = "trusted/certs";
constexpr const char* kTrustedLists = "trusted/crl";
constexpr const char* kIssuers = "issuers/certs";
constexpr const char* kIssuersLists = "issuers/crl";
constexpr const char* kRejected = "rejected";

/// The first thousand, by name.
std::vector<std::filesystem::path> filesIn(const std::filesystem::path& folder);
/// Removes the oldest files of a folder, so that another one makes at most `most`.
void makeRoom(const std::filesystem::path& folder, std::size_t most);
/// Certificates among the files of a folder, recognised by their content.
std::vector<Certificate> certificatesIn(const std::filesystem::path& folder);

/// Content of the folders at one moment.
struct TrustStore::Holdings {
    explicit Holdings(const std::filesystem::path& where);

    /// Reports whether no file was added, renamed or removed since.
    bool isCurrent() const;
    bool trusts(const Certificate& certificate) const;
    bool trustsOneOf(const STACK_OF(X509) * chain) const;
    template <typename Use>
    void forEach(Use use) const {
        std::for_each(trusted.begin(), trusted.end(), use);
        std::for_each(issuers.begin(), issuers.end(), use);
    }

    std::filesystem::path folder;
    std::array<std::filesystem::file_time_type, 4> changed{};
    std::filesystem::file_time_type looked{};
    std::vector<Certificate> trusted;
    std::vector<Certificate> issuers;
    std::vector<CrlPtr> lists;
};

/// Checks that a certificate is trusted, strong enough, meant for this use and valid at this time.
tl::expected<void, CertificateRefusal> checkCertificate(const Certificate& certificate,
                                                        const TrustStore::Holdings& holdings,
                                                        UtcTime now);

}  // namespace metier::security
