#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"

namespace metier::security {

/// An X.509 certificate of an OPC UA application or of whoever signs them (OPC 10000-6, 6.2).
/// Its text came from somebody else: it is printable, but nothing else is known of it.
class Certificate {
public:
    /// The first certificate of what a peer sends, which may be a chain.
    /// Errors: invalid_argument (not a certificate).
    static Result<Certificate> fromDer(std::string_view der);
    /// DER or PEM.
    /// Errors: not_found (the file), invalid_argument (not a certificate, or over 64 kB).
    static Result<Certificate> fromFile(const std::filesystem::path& file);

    /// Without what may have followed it.
    const std::string& der() const noexcept { return der_; }
    std::string pem() const;
    /// SHA-1 of the DER form, 40 hexadecimal digits: how OPC UA names a certificate.
    const std::string& thumbprint() const noexcept { return thumbprint_; }
    const std::string& subject() const noexcept { return subject_; }
    const std::string& issuer() const noexcept { return issuer_; }
    /// Of the SubjectAltName; empty if there is none, or several.
    const std::string& applicationUri() const noexcept { return application_uri_; }
    UtcTime notBefore() const noexcept { return not_before_; }
    UtcTime notAfter() const noexcept { return not_after_; }
    int keyBits() const noexcept { return key_bits_; }
    bool isSelfSigned() const noexcept { return self_signed_; }
    /// Whether it may sign other certificates.
    bool isAuthority() const noexcept { return authority_; }

    friend bool operator==(const Certificate& a, const Certificate& b) { return a.der_ == b.der_; }

private:
    Certificate() = default;

    std::string der_;
    std::string thumbprint_;
    std::string subject_;
    std::string issuer_;
    std::string application_uri_;
    UtcTime not_before_;
    UtcTime not_after_;
    int key_bits_ = 0;
    bool self_signed_ = false;
    bool authority_ = false;
};

/// SHA-1, as 40 hexadecimal digits.
std::string thumbprintOf(std::string_view der);

/// As "2027-11-22".
std::string dateText(UtcTime time);

}  // namespace metier::security
