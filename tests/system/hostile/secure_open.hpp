#pragma once

#include <vector>

#include "chunks.hpp"

namespace metier::hostile {

/// Certificates, in DER, that anybody can get hold of.
struct PublicCertificates {
    Bytes server;
    Bytes trusted_client;
};

/// OPN with a policy, a certificate and a thumbprint that are right or wrong: cut, changed, huge,
/// a chain, another's; its body is noise, or encrypted with the server's key and not signed.
Bytes secureOpenChunk(Random& random, Channel& channel, const PublicCertificates& certificates,
                      std::string_view body);

}  // namespace metier::hostile
