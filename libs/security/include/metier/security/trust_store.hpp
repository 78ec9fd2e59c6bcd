#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/background_read.hpp"
#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/security/certificate.hpp"

namespace metier::security {

/// Why a certificate is refused; each has a StatusCode of its own (OPC 10000-4, 6.1.3).
enum class RefusalKind {
    malformed,
    untrusted,
    expired,
    not_yet_valid,
    revoked,
    revocation_unknown,  ///< of an authority without a revocation list here
    weak,                ///< a key under 2048 bit, or SHA-1
    wrong_use,           ///< its KeyUsage does not allow what OPC UA does with it
};
std::string_view toString(RefusalKind kind) noexcept;

struct CertificateRefusal {
    RefusalKind kind = RefusalKind::malformed;
    std::string message;  ///< with subject and thumbprint
};

/// Whom an application trusts, in folders that any tool may fill (as OPC 10000-12, 7.8.2.8):
/// trusted/certs, trusted/crl, issuers/certs, issuers/crl, and rejected for those to decide on.
///
/// A certificate is trusted if it is in trusted/certs itself, or was signed by an authority there
/// whose chain up to its root is known and whose revocation lists are. What is changed in the
/// folders (files that are added, renamed or removed) holds from the next connection on.
/// Threading: any thread, one at a time.
class TrustStore {
public:
    /// Makes the folders that are missing. Errors: resource_unavailable.
    static Result<TrustStore> open(std::filesystem::path folder);
    ~TrustStore();
    TrustStore(TrustStore&& other) noexcept;
    TrustStore& operator=(TrustStore&& other) noexcept;

    /// Whether to talk to whoever presents this, in DER, perhaps with its chain. Does not wait for
    /// a disk that hangs: what the folders held before is what counts then.
    tl::expected<Certificate, CertificateRefusal> check(std::string_view der, UtcTime now);
    /// Keeps one that was refused, for somebody to decide on; the latest 100. Writes a file.
    void keepRejected(const Certificate& certificate) const;

    /// Certificates by what is decided on them; files that are none are left out.
    std::vector<Certificate> trusted() const;
    std::vector<Certificate> rejected() const;

    /// Trusts one from now on. Errors: resource_unavailable.
    Result<void> trust(const Certificate& certificate);
    /// Trusts it no longer; it is kept in `rejected`.
    /// \param name thumbprint, or its beginning, of a trusted one
    /// Errors: not_found; invalid_argument (several begin so).
    Result<Certificate> distrust(std::string_view name);
    /// Trusts one of the rejected. As distrust().
    Result<Certificate> trustRejected(std::string_view name);
    /// Takes a revocation list, DER or PEM, of an authority that is known.
    /// Errors: not_found (file or authority), invalid_argument (its signature).
    Result<void> addRevocationList(const std::filesystem::path& file);

    const std::filesystem::path& folder() const noexcept { return folder_; }

    struct Holdings;  ///< what the folders hold

private:
    explicit TrustStore(std::filesystem::path folder);
    std::shared_ptr<const Holdings> holdings();

    std::filesystem::path folder_;
    std::unique_ptr<BackgroundRead<Holdings>> holdings_;  // from the first check on
};

}  // namespace metier::security
