#include "client/client_config.hpp"

#include <open62541/client_config_default.h>

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>

#include "common/convert.hpp"
#include "common/security_config.hpp"
#include "metier/opcua/text.hpp"

namespace metier::opcua {

namespace {

constexpr std::string_view kNoSecurity = "http://opcfoundation.org/UA/SecurityPolicy#None";
constexpr int kChecksPerSessionTimeout = 3;
constexpr std::chrono::milliseconds kLongestSilence{2'000};

void setUser(const UserName& user, UA_ClientConfig& config) {
    auto* token = checkAllocated(UA_UserNameIdentityToken_new());
    UA_ExtensionObject_setValue(&config.userIdentityToken, token,
                                &UA_TYPES[UA_TYPES_USERNAMEIDENTITYTOKEN]);
    toNative(user.name, token->userName);
    toNative(user.password, token->password);
}

void setTimes(const ClientOptions& options, UA_ClientConfig& config) {
    const auto check = options.session_timeout / kChecksPerSessionTimeout;
    config.requestedSessionTimeout = static_cast<UA_UInt32>(options.session_timeout.count());
    config.connectivityCheckInterval =
        static_cast<UA_UInt32>(std::min(check, kLongestSilence).count());
    config.timeout = static_cast<UA_UInt32>(std::min(options.connect_timeout, check).count());
}

/// Sets an Endpoint for discovery, so that the stack does not look for one: a closed server has
/// none without security.
void setDiscoveryEndpoint(const std::string& url, UA_ClientConfig& config) {
    auto& endpoint = config.endpoint;
    toNative(url, endpoint.endpointUrl);
    toNative(kNoSecurity, endpoint.securityPolicyUri);
    endpoint.securityMode = UA_MESSAGESECURITYMODE_NONE;
    config.userTokenPolicy.tokenType = UA_USERTOKENTYPE_ANONYMOUS;
    toNative("anonymous", config.userTokenPolicy.policyId);
}

}  // namespace

ClientComplaints::ClientComplaints() noexcept : logger_{&log, this, nullptr} {}

void ClientComplaints::log(void* context, UA_LogLevel level, UA_LogCategory /*category*/,
                           const char* format, va_list arguments) {
    if (level < UA_LOGLEVEL_WARNING) {
        return;
    }
    std::array<char, 512> text{};
    std::vsnprintf(text.data(), text.size(), format, arguments);
    static_cast<ClientComplaints*>(context)->last_ = sanitise(text.data());
}

Result<UA_ClientConfig> makeClientConfig(const ClientOptions& options, ConnectionKind kind,
                                         const ClientPlugins& plugins) {
    UA_ClientConfig config{};
    config.eventLoop = plugins.loop;
    config.externalEventLoop = false;
    config.logging = plugins.logger;
    const auto& uri = plugins.peers != nullptr
                          ? options.security->identity.certificate.applicationUri()
                          : options.application_uri;
    toNative(uri, config.clientDescription.applicationUri);
    toNative(options.application_name, config.clientDescription.applicationName.text);
    toNative(options.application_name, config.sessionName);
    config.noSession = kind == ConnectionKind::discovery;
    config.noNewSession = true;
    setTimes(options, config);
    if (options.user) {
        setUser(*options.user, config);
    }
    if (plugins.peers != nullptr) {
        if (auto secured = addSecurity(*options.security, *plugins.peers, config); !secured) {
            UA_ClientConfig_clear(&config);
            return fail(secured.error());
        }
        return config;
    }
    toNative(kNoSecurity, config.securityPolicyUri);
    config.securityMode = UA_MESSAGESECURITYMODE_NONE;
    if (kind == ConnectionKind::discovery) {
        setDiscoveryEndpoint(plugins.url, config);
    }
    checkAllocated(UA_ClientConfig_setDefault(&config));
    return config;
}

}  // namespace metier::opcua
