#include "secure_open.hpp"

#include <openssl/evp.h>
#include <openssl/rsa.h>
#include <openssl/x509.h>

#include <array>
#include <memory>

#include "metier/security/certificate.hpp"

namespace metier::hostile {

namespace {

constexpr std::string_view kPolicies = "http://opcfoundation.org/UA/SecurityPolicy#";
constexpr std::size_t kBlock = 256;  // [byte] of a key of 2048 bit
constexpr std::size_t kMostInBlock = 190;

const unsigned char* octets(std::string_view bytes) {
    return reinterpret_cast<const unsigned char*>(bytes.data());
}

/// With RSA-OAEP and SHA-1, block by block; empty if the certificate is none.
Bytes encrypted(std::string_view plain, std::string_view der) {
    const auto* begin = octets(der);
    const std::unique_ptr<X509, decltype(&X509_free)> certificate(
        d2i_X509(nullptr, &begin, static_cast<long>(der.size())), X509_free);
    if (!certificate) {
        return {};
    }
    const std::unique_ptr<EVP_PKEY_CTX, decltype(&EVP_PKEY_CTX_free)> context(
        EVP_PKEY_CTX_new(X509_get0_pubkey(certificate.get()), nullptr), EVP_PKEY_CTX_free);
    EVP_PKEY_encrypt_init(context.get());
    EVP_PKEY_CTX_set_rsa_padding(context.get(), RSA_PKCS1_OAEP_PADDING);
    Bytes all;
    while (!plain.empty()) {
        const auto part = plain.substr(0, kMostInBlock);
        std::array<unsigned char, 2 * kBlock> block{};
        std::size_t size = block.size();
        if (EVP_PKEY_encrypt(context.get(), block.data(), &size, octets(part), part.size()) != 1) {
            break;
        }
        all.append(block.begin(), block.begin() + size);
        plain.remove_prefix(part.size());
    }
    return all;
}

Bytes thumbprint(std::string_view der) {
    constexpr int hexadecimal = 16;
    const auto hex = security::thumbprintOf(der);
    Bytes bytes;
    for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
        bytes.push_back(static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, hexadecimal)));
    }
    return bytes;
}

Bytes anyCertificate(Random& random, const PublicCertificates& certificates) {
    constexpr std::size_t huge = 60'000;
    auto trusted = certificates.trusted_client;
    switch (random.below(8)) {
        case 0:
            return {};
        case 1:
            return Bytes(random.below(huge), '\x30');
        case 2:
            return certificates.server;
        case 3:  // a chain, of what does not belong together
            return trusted + certificates.server + trusted;
        case 4:
        case 5:
            damage(random, trusted);
            return trusted;
        default:
            return trusted;
    }
}

void put(Bytes& content, std::uint32_t value) {
    for (unsigned shift = 0; shift < 32; shift += 8) {
        content.push_back(static_cast<char>(value >> shift));
    }
}

void putText(Bytes& content, std::string_view text) {
    put(content, static_cast<std::uint32_t>(text.size()));
    content.append(text);
}

}  // namespace

Bytes secureOpenChunk(Random& random, Channel& channel, const PublicCertificates& certificates,
                      std::string_view body) {
    constexpr std::array<std::string_view, 7> names{"Basic256Sha256",
                                                    "Basic256Sha256",
                                                    "Aes128_Sha256_RsaOaep",
                                                    "Aes256_Sha256_RsaPss",
                                                    "Basic128Rsa15",
                                                    "None",
                                                    "Unknown"};
    Bytes plain;
    put(plain, ++channel.sequence);
    put(plain, ++channel.request);
    plain.append(body);
    plain.append(kBlock, '\x5a');  // in place of the signature

    Bytes content;
    put(content, 0);
    putText(content, Bytes(kPolicies) + Bytes(random.pick(names)));
    putText(content, anyCertificate(random, certificates));
    putText(content,
            random.oneIn(5) ? Bytes(random.below(40), 't') : thumbprint(certificates.server));
    content += random.oneIn(3) ? Bytes(kBlock * random.below(4) + random.below(2), 'n')
                               : encrypted(plain, certificates.server);
    Bytes chunk("OPNF");
    put(chunk, static_cast<std::uint32_t>(content.size() + chunk.size() + sizeof(std::uint32_t)));
    return chunk += content;
}

}  // namespace metier::hostile
