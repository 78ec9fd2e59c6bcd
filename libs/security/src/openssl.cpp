#include "openssl.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openssl/err.h>
#include <openssl/pem.h>

#include <array>
#include <fstream>
#include <limits>

namespace metier::security {
namespace {

const unsigned char* bytesOf(std::string_view text) noexcept {
    return reinterpret_cast<const unsigned char*>(text.data());
}

bool isPem(std::string_view text) noexcept {
    return text.find("-----BEGIN") != std::string_view::npos;
}

}  // namespace

X509Ptr parseDer(std::string_view der) {
    if (der.size() > kLargestFile) {
        return nullptr;
    }
    const auto* bytes = bytesOf(der);
    X509Ptr certificate(d2i_X509(nullptr, &bytes, static_cast<long>(der.size())));
    ERR_clear_error();
    return certificate;
}

X509Ptr parsePemOrDer(std::string_view text) {
    if (!isPem(text)) {
        return parseDer(text);
    }
    X509Ptr certificate(PEM_read_bio_X509(reading(text).get(), nullptr, nullptr, nullptr));
    ERR_clear_error();
    return certificate;
}

CrlPtr parseCrlPemOrDer(std::string_view text) {
    const auto* bytes = bytesOf(text);
    CrlPtr crl(isPem(text) ? PEM_read_bio_X509_CRL(reading(text).get(), nullptr, nullptr, nullptr)
                           : d2i_X509_CRL(nullptr, &bytes, static_cast<long>(text.size())));
    ERR_clear_error();
    return crl;
}

std::string derOf(X509* certificate) {
    unsigned char* bytes = nullptr;
    const int size = i2d_X509(certificate, &bytes);
    const std::unique_ptr<unsigned char, Freed<[](unsigned char* p) { OPENSSL_free(p); }>> owner(
        bytes);
    return size > 0 ? std::string(bytes, bytes + size) : std::string();
}

BioPtr reading(std::string_view text) {
    return BioPtr(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
}

std::string textOf(BIO* bio) {
    char* data = nullptr;
    const long size = BIO_get_mem_data(bio, &data);
    return size > 0 ? std::string(data, static_cast<std::size_t>(size)) : std::string();
}

std::string digestOf(std::string_view text, const EVP_MD* kind) {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned int size = 0;
    EVP_Digest(text.data(), text.size(), digest.data(), &size, kind, nullptr);
    return fmt::format("{:02x}", fmt::join(digest.begin(), digest.begin() + size, ""));
}

std::string readFile(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::string text(kLargestFile + 1, '\0');
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(file.gcount()));
    return text.size() > kLargestFile ? std::string() : text;
}

}  // namespace metier::security
