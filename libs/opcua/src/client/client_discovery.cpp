// Services that a server offers before there is a session.

#include <memory>
#include <optional>
#include <utility>

#include "client/client_core.hpp"
#include "common/native.hpp"
#include "metier/opcua/discovery.hpp"

namespace metier::opcua {

namespace {

EndpointDescription described(const UA_EndpointDescription& native) {
    EndpointDescription endpoint;
    endpoint.url = textFrom(native.endpointUrl);
    endpoint.security_mode = static_cast<EndpointDescription::SecurityMode>(native.securityMode);
    endpoint.security_policy_uri = textFrom(native.securityPolicyUri);
    endpoint.security_level = native.securityLevel;
    for (std::size_t i = 0; i < native.userIdentityTokensSize; ++i) {
        endpoint.tokens.push_back(
            static_cast<EndpointDescription::TokenType>(native.userIdentityTokens[i].tokenType));
    }
    return endpoint;
}

ServerDescription described(const UA_ApplicationDescription& native) {
    return {textFrom(native.applicationUri), textFrom(native.productUri),
            fromNative(native.applicationName),
            static_cast<ApplicationType>(native.applicationType),
            vectorFrom<std::string>(native.discoveryUrls, native.discoveryUrlsSize)};
}

ClientOptions optionsFor(std::chrono::milliseconds timeout) {
    ClientOptions options;
    options.connect_timeout = timeout;
    return options;
}

/// One question that needs no session, on a connection of its own.
template <typename Request, typename T>
class Question {
public:
    using Response = typename Service<Request>::Response;
    using Fill = std::function<void(Request&)>;
    using Convert = std::function<Answer<T>(const Response&)>;

    Question(std::string url, ClientOptions options, Fill fill, Convert convert)
        : url_(std::move(url)),
          deadline_(Deadline::in(options.connect_timeout)),
          fill_(std::move(fill)),
          convert_(std::move(convert)),
          core_(std::move(options), ConnectionKind::discovery) {}

    Answer<T> ask() {
        core_.whenOpen([this] { send(); });
        const auto connected = core_.connect(url_);
        core_.close();
        return connected ? std::move(*answer_) : Answer<T>(tl::unexpected(connected.error()));
    }

private:
    void send() {
        Owned<Request> request(UA_TYPES[Service<Request>::kRequest]);
        fill_(*request);
        core_.send(*request, {"asking " + url_, deadline_},
                   [this](Answer<Response*> response) { take(std::move(response)); });
    }

    void take(Answer<Response*> response) {
        if (response) {
            answer_ = convert_(**response);
        } else if (response.error().code == Errc::connection_lost) {
            return;  // the stack opens another connection, or says why it does not
        } else {
            answer_ = tl::unexpected(std::move(response.error()));
        }
        core_.settle({});
    }

    const std::string url_;
    const Deadline deadline_;
    const Fill fill_;
    const Convert convert_;
    std::optional<Answer<T>> answer_;  // the client's thread, until connect() has returned
    ClientCore core_;
};

template <typename T, typename Native>
std::vector<T> listFrom(const Native* first, std::size_t count) {
    std::vector<T> list;
    for (std::size_t i = 0; i < count; ++i) {
        list.push_back(described(first[i]));
    }
    return list;
}

void fill(const ServerRegistration& registration, UA_RegisteredServer& target) {
    toNative(registration.application_uri, target.serverUri);
    toNative(registration.product_uri, target.productUri);
    toNative(std::vector{LocalizedText{"", registration.name}}, target.serverNames,
             target.serverNamesSize);
    target.serverType = UA_APPLICATIONTYPE_SERVER;
    toNative(registration.discovery_urls, target.discoveryUrls, target.discoveryUrlsSize);
    target.isOnline = registration.presence == ServerRegistration::Presence::online;
}

void fillMdns(const ServerRegistration& registration, UA_RegisterServer2Request& request) {
    request.discoveryConfiguration = checkAllocated(UA_ExtensionObject_new());
    request.discoveryConfigurationSize = 1;
    auto* mdns = checkAllocated(UA_MdnsDiscoveryConfiguration_new());
    UA_ExtensionObject_setValue(request.discoveryConfiguration, mdns,
                                &UA_TYPES[UA_TYPES_MDNSDISCOVERYCONFIGURATION]);
    toNative(registration.name, mdns->mdnsServerName);
    toNative(registration.capabilities, mdns->serverCapabilities, mdns->serverCapabilitiesSize);
}

/// Registers it by one of the two services, which both answer no more than that it went well.
template <typename Request>
Answer<> tell(const std::string& url, const ClientOptions& options,
              std::function<void(Request&)> prepare) {
    Question<Request, void> question(url, options, std::move(prepare),
                                     [](const auto& /*response*/) { return Answer<>(); });
    return question.ask();
}

}  // namespace

Answer<std::vector<EndpointDescription>> getEndpoints(const std::string& url,
                                                      std::chrono::milliseconds timeout) {
    using List = std::vector<EndpointDescription>;
    Question<UA_GetEndpointsRequest, List> question(
        url, optionsFor(timeout), [&url](auto& request) { toNative(url, request.endpointUrl); },
        [](const UA_GetEndpointsResponse& response) {
            return listFrom<EndpointDescription>(response.endpoints, response.endpointsSize);
        });
    return question.ask();
}

Answer<std::vector<ServerDescription>> findServers(const std::string& url,
                                                   std::chrono::milliseconds timeout) {
    using List = std::vector<ServerDescription>;
    // No EndpointUrl: a discovery server on open62541 1.4 would return it as the address of all
    // servers that registered there.
    Question<UA_FindServersRequest, List> question(
        url, optionsFor(timeout), [](auto& /*request*/) {},
        [](const UA_FindServersResponse& response) {
            return listFrom<ServerDescription>(response.servers, response.serversSize);
        });
    return question.ask();
}

Answer<> registerServer(const std::string& url, const ServerRegistration& registration,
                        std::chrono::milliseconds timeout,
                        const std::optional<Credentials>& security) {
    auto options = optionsFor(timeout);
    options.security = security;
    auto told = tell<UA_RegisterServer2Request>(url, options, [&](auto& request) {
        fill(registration, request.server);
        fillMdns(registration, request);
    });
    if (told || told.error().status != status::kBadServiceUnsupported) {
        return told;
    }
    return tell<UA_RegisterServerRequest>(
        url, options, [&](auto& request) { fill(registration, request.server); });
}

}  // namespace metier::opcua
