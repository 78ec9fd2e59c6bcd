#pragma once

#include <chrono>
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

/// Reasons to refuse a certificate; each has a StatusCode of its own (OPC 10000-4, 6.1.3).
enum class RefusalKind {
    /// The bytes are no certificate.
    malformed,
    /// Neither it nor its authority is trusted.
    untrusted,
    /// The end of its validity is over.
    expired,
    /// The begin of its validity is to come; often a clock that is wrong.
    not_yet_valid,
    /// Its authority has revoked it.
    revoked,
    /// The store has no revocation list of its authority.
    revocation_unknown,
    /// A key under 2048 bit, or SHA-1.
    weak,
    /// Its KeyUsage does not allow what OPC UA does with it.
    wrong_use,
};

/// Reason of a refusal, for the program and for a person.
struct CertificateRefusal {
    /// Kind of the refusal.
    RefusalKind kind = RefusalKind::malformed;
    /// Text for a person, with subject and thumbprint.
    std::string message;
};

/// Certificates that an application trusts, in folders that any tool may fill (as OPC 10000-12,
/// 7.8.2.8): trusted/certs, trusted/crl, issuers/certs, issuers/crl, and rejected for certificates
/// that a person has to decide on.
///
///     auto store = TrustStore::open(folder.trustFolder());
///     if (auto peer = store->check(der, now); !peer) { ... peer.error().message ... }
///
/// A certificate is trusted if it is in trusted/certs itself, or was signed by an authority in
/// trusted/certs whose chain up to its root and whose revocation lists are known. Changes in the
/// folders (files added, renamed or removed) take effect at the next connection.
/// Threading: any thread, one at a time.
class TrustStore {
public:
    /// Makes the folders that are missing and reads their content; waits for the disk.
    /// \param patience longest time that check() waits for a change of the content
    /// Errors: resource_unavailable.
    static Result<TrustStore> open(std::filesystem::path folder,
                                   std::chrono::milliseconds patience = kReadPatience);
    ~TrustStore();
    TrustStore(TrustStore&& other) noexcept;
    TrustStore& operator=(TrustStore&& other) noexcept;

    /// Decides whether the peer that presents this certificate is trusted. Does not wait for a disk
    /// that hangs: the last known content of the folders counts then.
    /// \param der certificate in DER form, perhaps followed by its chain
    tl::expected<Certificate, CertificateRefusal> check(std::string_view der, UtcTime now);
    /// Keeps a refused certificate for a person to decide on; the latest 100 are kept. Writes a
    /// file.
    void keepRejected(const Certificate& certificate) const;

    /// Certificates in trusted/certs; files that are no certificates are left out. Waits for the
    /// disk, as do all functions below.
    std::vector<Certificate> trusted() const;
    /// Certificates in `rejected`, which a person has to decide on.
    std::vector<Certificate> rejected() const;

    /// Trusts a certificate from now on; it is removed from `rejected`.
    /// Errors: resource_unavailable.
    Result<void> trust(const Certificate& certificate);
    /// Ends the trust in a certificate; it is kept in `rejected`.
    /// \param name thumbprint of a trusted certificate, or the beginning of it
    /// Errors: not_found; invalid_argument (several begin so).
    Result<Certificate> distrust(std::string_view name);
    /// Trusts one of the rejected certificates. Name and errors as for distrust().
    Result<Certificate> trustRejected(std::string_view name);
    /// Adds a revocation list, DER or PEM, of a known authority.
    /// Errors: not_found (file or authority), invalid_argument (its signature).
    Result<void> addRevocationList(const std::filesystem::path& file);

    const std::filesystem::path& folder() const noexcept { return folder_; }

    struct Holdings;  ///< content of the folders

private:
    TrustStore(std::filesystem::path folder, std::chrono::milliseconds patience);
    std::shared_ptr<const Holdings> holdings();

    std::filesystem::path folder_;
    std::chrono::milliseconds patience_;
    std::shared_ptr<const Holdings> opened_with_;         // shared with the first read
    std::unique_ptr<BackgroundRead<Holdings>> holdings_;  // made by the first check
};

}  // namespace metier::security
