#include "common/security_config.hpp"

#include <fmt/format.h>
#include <open62541/client_config_default.h>
#include <open62541/server_config_default.h>

#include <array>
#include <string_view>

#include "common/convert.hpp"
#include "metier/opcua/text.hpp"

namespace metier::opcua {

namespace {

constexpr std::string_view kNone = "http://opcfoundation.org/UA/SecurityPolicy#None";
constexpr std::string_view kStrongest =
    "http://opcfoundation.org/UA/SecurityPolicy#Aes256_Sha256_RsaPss";

using AddPolicy = UA_StatusCode (*)(UA_ServerConfig*, const UA_ByteString*, const UA_ByteString*);
struct Policy {
    std::string_view uri;
    AddPolicy add;
};
constexpr std::array kPolicies{
    Policy{"http://opcfoundation.org/UA/SecurityPolicy#Basic256Sha256",
           UA_ServerConfig_addSecurityPolicyBasic256Sha256},
    Policy{"http://opcfoundation.org/UA/SecurityPolicy#Aes128_Sha256_RsaOaep",
           UA_ServerConfig_addSecurityPolicyAes128Sha256RsaOaep},
    Policy{kStrongest, UA_ServerConfig_addSecurityPolicyAes256Sha256RsaPss},
};

UA_StatusCode addPolicy(const Policy& policy, const Credentials& credentials,
                        UA_ServerConfig& config) {
    const auto certificate = viewOf(credentials.identity.certificate.der());
    const auto key = viewOf(credentials.identity.private_key);
    auto code = policy.add(&config, &certificate, &key);
    for (const auto mode : {UA_MESSAGESECURITYMODE_SIGN, UA_MESSAGESECURITYMODE_SIGNANDENCRYPT}) {
        code = code != UA_STATUSCODE_GOOD
                   ? code
                   : UA_ServerConfig_addEndpoint(&config, viewOf(policy.uri), mode);
    }
    return code;
}

Result<> outcome(UA_StatusCode code, const security::Identity& identity) {
    return code == UA_STATUSCODE_GOOD
               ? Result<>()
               : fail(errorFrom(StatusCode(code), fmt::format("use the certificate {}",
                                                              identity.certificate.thumbprint())));
}

}  // namespace

Result<> addSecurity(const Credentials& credentials, PeerCheck& peers, UA_ServerConfig& config) {
    peers.install(config.secureChannelPKI);
    peers.installForSessions(config.sessionPKI);
    const auto certificate = viewOf(credentials.identity.certificate.der());
    auto code = UA_ServerConfig_addSecurityPolicyNone(&config, &certificate);
    for (const auto& policy : kPolicies) {
        code = code != UA_STATUSCODE_GOOD ? code : addPolicy(policy, credentials, config);
    }
    config.securityPolicyNoneDiscoveryOnly = true;
    return outcome(code, credentials.identity);
}

Result<> replaceIdentity(const security::Identity& identity, UA_ServerConfig& config) {
    const auto certificate = viewOf(identity.certificate.der());
    const auto key = viewOf(identity.private_key);
    UA_StatusCode code = UA_STATUSCODE_GOOD;
    for (std::size_t i = 0; i < config.securityPoliciesSize; ++i) {
        auto& policy = config.securityPolicies[i];
        const auto replaced = policy.updateCertificateAndPrivateKey(&policy, certificate, key);
        code = code != UA_STATUSCODE_GOOD ? code : replaced;
    }
    return outcome(code, identity);
}

Result<> addNoSecurity(UA_ServerConfig& config) {
    auto code = UA_ServerConfig_addSecurityPolicyNone(&config, nullptr);
    if (code == UA_STATUSCODE_GOOD) {
        code = UA_ServerConfig_addEndpoint(&config, viewOf(kNone), UA_MESSAGESECURITYMODE_NONE);
    }
    return code == UA_STATUSCODE_GOOD ? Result<>()
                                      : fail(errorFrom(StatusCode(code), "configure the server"));
}

Result<> addSecurity(const Credentials& credentials, PeerCheck& peers, UA_ClientConfig& config) {
    const auto certificate = viewOf(credentials.identity.certificate.der());
    const auto key = viewOf(credentials.identity.private_key);
    const auto code =
        UA_ClientConfig_setDefaultEncryption(&config, certificate, key, nullptr, 0, nullptr, 0);
    if (code != UA_STATUSCODE_GOOD) {
        return outcome(code, credentials.identity);
    }
    peers.install(config.certificateVerification);
    config.securityMode = UA_MESSAGESECURITYMODE_SIGNANDENCRYPT;
    UA_String_clear(&config.securityPolicyUri);
    toNative(kStrongest, config.securityPolicyUri);
    return {};
}

}  // namespace metier::opcua
