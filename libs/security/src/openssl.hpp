#pragma once

#include <openssl/bio.h>
#include <openssl/evp.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include <memory>
#include <string>
#include <string_view>

namespace metier::security {

template <auto Free>
struct Freed {
    template <typename T>
    void operator()(T* pointer) const noexcept {
        Free(pointer);
    }
};
using X509Ptr = std::unique_ptr<X509, Freed<X509_free>>;
using CrlPtr = std::unique_ptr<X509_CRL, Freed<X509_CRL_free>>;
using KeyPtr = std::unique_ptr<EVP_PKEY, Freed<EVP_PKEY_free>>;
using BioPtr = std::unique_ptr<BIO, Freed<BIO_free_all>>;

/// The first certificate in DER; null if there is none.
X509Ptr parseDer(std::string_view der);
/// Null if it is neither.
X509Ptr parsePemOrDer(std::string_view text);
CrlPtr parseCrlPemOrDer(std::string_view text);

std::string derOf(X509* certificate);

/// A BIO that reads `text`, which must outlive it.
BioPtr reading(std::string_view text);
/// Bytes that were written to a memory BIO.
std::string textOf(BIO* bio);

/// Digest of the text in hexadecimal digits.
std::string digestOf(std::string_view text, const EVP_MD* kind);

constexpr std::size_t kLargestFile = 64U * 1024U;
/// The file, up to kLargestFile; empty if there is none, or a larger one.
std::string readFile(const std::string& path);

}  // namespace metier::security
