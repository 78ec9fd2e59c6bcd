#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"

namespace metier::security {

/// An X.509 certificate of an OPC UA application or of an authority that signs them (OPC 10000-6,
/// 6.2). Its texts come from another party: they are printable, but not to be believed.
///
/// Threading: any thread; it never changes.
class Certificate {
public:
    /// Parses the bytes that a peer sends; of a chain the first certificate.
    /// Errors: invalid_argument (not a certificate).
    static Result<Certificate> fromDer(std::string_view der);
    /// Reads a file in DER or PEM form.
    /// Errors: not_found (the file), invalid_argument (not a certificate, or over 64 kB).
    static Result<Certificate> fromFile(const std::filesystem::path& file);

    /// The certificate in DER form, without bytes that followed it.
    const std::string& der() const noexcept { return der_; }
    /// The certificate in PEM form.
    /// Text between "BEGIN CERTIFICATE" and "END CERTIFICATE", with both lines.
    std::string pem() const;
    /// SHA-1 of the DER form, 40 hexadecimal digits: the name of a certificate in OPC UA.
    const std::string& thumbprint() const noexcept { return thumbprint_; }
    /// Names of the holder and of the signer, such as "CN=metier"; control characters are escaped.
    const std::string& subject() const noexcept { return subject_; }
    /// Name of the signer; equal to subject() does not mean self-signed, see isSelfSigned().
    const std::string& issuer() const noexcept { return issuer_; }
    /// URI in the SubjectAltName; empty if there is none, or several.
    const std::string& applicationUri() const noexcept { return application_uri_; }
    /// Begin and end of its validity, both included.
    UtcTime notBefore() const noexcept { return not_before_; }
    /// Not compared with the present time here.
    UtcTime notAfter() const noexcept { return not_after_; }
    /// Length of the public key [bit]; 0: a key of an unknown kind.
    int keyBits() const noexcept { return key_bits_; }
    /// Reports whether its signature was made with its own key; the signature is checked.
    bool isSelfSigned() const noexcept { return self_signed_; }
    /// Reports whether it may sign other certificates.
    bool isAuthority() const noexcept { return authority_; }

    /// Whether both are the same byte for byte.
    friend bool operator==(const Certificate& a, const Certificate& b) { return a.der_ == b.der_; }

private:
    Certificate() = default;

    // Everything but der_ is derived from it when it is parsed.
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

/// SHA-1 of a certificate in DER form, as 40 hexadecimal digits; the bytes need not be a
/// certificate. Threads: any; pure.
std::string thumbprintOf(std::string_view der);

/// The UTC date, such as "2027-11-22". Threads: any; pure.
std::string dateText(UtcTime time);

}  // namespace metier::security
