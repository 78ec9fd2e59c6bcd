#include "server/server_config.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <open62541/server_config_default.h>

#include <algorithm>
#include <limits>
#include <string_view>

#include "common/convert.hpp"
#include "common/security_config.hpp"
#include "server/nodesets.hpp"

namespace metier::opcua {

namespace {

constexpr std::uint8_t kLoopbackByte = 127;

bool isLoopback(const std::string& address) {
    in6_addr six{};
    if (inet_pton(AF_INET6, address.c_str(), &six) == 1) {
        return IN6_IS_ADDR_LOOPBACK(&six) != 0;
    }
    in_addr four{};
    return address == "localhost" || (inet_pton(AF_INET, address.c_str(), &four) == 1 &&
                                      ntohl(four.s_addr) >> 24U == kLoopbackByte);
}

void replace(UA_String& target, std::string_view text) {
    UA_String_clear(&target);
    toNative(text, target);
}

void setDescription(const ServerOptions& options, UA_ServerConfig& config) {
    auto& description = config.applicationDescription;
    replace(description.applicationUri, options.application_uri);
    replace(description.productUri, "urn:metier");
    UA_LocalizedText_clear(&description.applicationName);
    toNative(LocalizedText{"", options.application_name}, description.applicationName);
    replace(config.buildInfo.productUri, "urn:metier");
    replace(config.buildInfo.manufacturerName, "metier");
    replace(config.buildInfo.productName, "metier");
    replace(config.buildInfo.softwareVersion, METIER_VERSION);
    replace(config.buildInfo.buildNumber, METIER_VERSION);
    config.buildInfo.buildDate = 0;  // the stack's is the time of the server's start
}

void setDiscovery(const DiscoveryService& discovery, UA_ServerConfig& config) {
    config.applicationDescription.applicationType = UA_APPLICATIONTYPE_DISCOVERYSERVER;
    config.discoveryCleanupTimeout = static_cast<UA_UInt32>(discovery.forget_after.count());
}

void setAddresses(const ServerOptions& options, UA_ServerConfig& config) {
    UA_Array_delete(config.serverUrls, config.serverUrlsSize, &UA_TYPES[UA_TYPES_STRING]);
    config.serverUrls = nullptr;
    config.serverUrlsSize = 0;
    for (const auto& address : options.bind_addresses) {
        const std::string url = endpointUrlOf(address, options.port);
        const UA_String view = viewOf(url);
        checkAllocated(UA_Array_appendCopy(reinterpret_cast<void**>(&config.serverUrls),
                                           &config.serverUrlsSize, &view,
                                           &UA_TYPES[UA_TYPES_STRING]));
    }
    config.tcpReuseAddr = false;  // two servers on one port would share its clients
}

UA_DurationRange durations(std::chrono::milliseconds low, std::chrono::milliseconds high) {
    return {static_cast<double>(low.count()), static_cast<double>(high.count())};
}

void setSessionLimits(const ServerLimits& limits, UA_ServerConfig& config) {
    // The event loop counts them, and knows better whose place is needed. The stack frees a closed
    // one a little later.
    config.maxSecureChannels = static_cast<UA_UInt16>(
        std::min<unsigned>(limits.secure_channels * 2U, std::numeric_limits<UA_UInt16>::max()));
    config.maxSessions = limits.sessions;
    config.maxSessionTimeout = static_cast<double>(limits.session_timeout.count());
    config.tcpMaxMsgSize = limits.message_size;
    config.tcpMaxChunks = limits.chunks_per_message;
    config.maxNodesPerRead = limits.nodes_per_read;
    config.maxNodesPerWrite = limits.nodes_per_write;
    config.maxNodesPerMethodCall = limits.nodes_per_call;
    config.maxNodesPerBrowse = limits.nodes_per_browse;
    config.maxReferencesPerNode = limits.references_per_node;
    config.maxNodesPerRegisterNodes = limits.nodes_per_read;
    config.maxNodesPerTranslateBrowsePathsToNodeIds = limits.nodes_per_browse;
    config.maxMonitoredItemsPerCall = limits.monitored_items_per_subscription;
}

void setSubscriptionLimits(const ServerLimits& limits, UA_ServerConfig& config) {
    constexpr std::chrono::hours kLongestSampling{1};
    constexpr std::uint32_t kKeepAlivesPerLifetime = 3;  // at least, by OPC 10000-4
    config.maxSubscriptions = limits.subscriptions;
    config.maxSubscriptionsPerSession = limits.subscriptions_per_session;
    config.maxMonitoredItems = limits.monitored_items;
    config.maxMonitoredItemsPerSubscription = limits.monitored_items_per_subscription;
    config.publishingIntervalLimits =
        durations(limits.min_publishing_interval, limits.max_publishing_interval);
    config.samplingIntervalLimits = durations(limits.min_sampling_interval, kLongestSampling);
    config.lifeTimeCountLimits = {kKeepAlivesPerLifetime, limits.lifetime_count};
    config.keepAliveCountLimits = {1, limits.lifetime_count / kKeepAlivesPerLifetime};
    config.queueSizeLimits = {1, limits.event_queue};
    config.maxPublishReqPerSession = limits.publish_requests_per_session;
    config.maxRetransmissionQueueSize = limits.retransmission_queue;
}

Result<> checkSecurity(const ServerOptions& options) {
    if (!options.security) {
        return {};
    }
    const auto& certificate = options.security->credentials.identity.certificate;
    if (certificate.applicationUri() != options.application_uri) {
        return fail(
            Errc::invalid_argument,
            fmt::format("the certificate {} is of \"{}\", not of \"{}\"", certificate.thumbprint(),
                        certificate.applicationUri(), options.application_uri));
    }
    return options.security->authenticate
               ? Result<>()
               : fail(Errc::invalid_argument, "a closed server needs to know its users");
}

}  // namespace

std::string endpointUrlOf(const std::string& address, std::uint16_t port) {
    const bool six = address.find(':') != std::string::npos;
    return fmt::format("opc.tcp://{}{}{}:{}", six ? "[" : "", address, six ? "]" : "", port);
}

std::vector<std::string> profilesOf(const ServerOptions& options) {
    return {options.security ? "http://opcfoundation.org/UA-Profile/Server/EmbeddedUA2017"
                             : "http://opcfoundation.org/UA-Profile/Server/MicroEmbeddedDevice2017",
            "http://opcfoundation.org/UA-Profile/Server/Methods",
            "http://opcfoundation.org/UA-Profile/Server/StandardEventSubscription"};
}

Result<> checkOptions(const ServerOptions& options) {
    if (options.bind_addresses.empty()) {
        return fail(Errc::invalid_argument, "no address to bind to");
    }
    for (const auto& address : options.bind_addresses) {
        if (!options.security && !isLoopback(address)) {
            return fail(Errc::invalid_argument,
                        fmt::format("'{}' is not a loopback address; a server without security "
                                    "is not offered to a network",
                                    address));
        }
    }
    if (options.port == 0 && options.bind_addresses.size() > 1) {
        return fail(Errc::invalid_argument,
                    "a free port (0) can be taken on one address only, not on several");
    }
    if (options.discovery && options.discovery->forget_after.count() < 1) {
        return fail(Errc::invalid_argument, "registrations of less than 1 s");
    }
    METIER_TRY(checkSecurity(options));
    const auto& limits = options.limits;
    if (limits.sessions == 0 || limits.secure_channels < limits.sessions) {
        return fail(Errc::invalid_argument,
                    fmt::format("{} sessions need 1 or more, and as many secure channels, not {}",
                                limits.sessions, limits.secure_channels));
    }
    return checkNodesets(options.nodesets);
}

Result<> applyOptions(const ServerOptions& options, PeerCheck* peers, UA_ServerConfig& config) {
    const auto code = UA_ServerConfig_setBasics_withPort(&config, options.port);
    if (code != UA_STATUSCODE_GOOD) {
        return fail(errorFrom(StatusCode(code), "configure the server"));
    }
    METIER_TRY(options.security ? addSecurity(options.security->credentials, *peers, config)
                                : addNoSecurity(config));
    setDescription(options, config);
    if (options.discovery) {
        setDiscovery(*options.discovery, config);
    }
    setAddresses(options, config);
    setSessionLimits(options.limits, config);
    setSubscriptionLimits(options.limits, config);
    config.modellingRulesOnInstances = false;
    return {};
}

}  // namespace metier::opcua
