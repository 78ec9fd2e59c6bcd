// Services that a server offers before there is a session.

#include <memory>
#include <optional>
#include <utility>

#include "client_core.hpp"
#include "convert.hpp"

namespace metier::opcua {

namespace {

EndpointDescription fromNative(const UA_EndpointDescription& native) {
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

ServerDescription fromNative(const UA_ApplicationDescription& native) {
    using opcua::fromNative;
    ServerDescription server{textFrom(native.applicationUri),
                             textFrom(native.productUri),
                             fromNative(native.applicationName),
                             {}};
    for (std::size_t i = 0; i < native.discoveryUrlsSize; ++i) {
        server.discovery_urls.push_back(textFrom(native.discoveryUrls[i]));
    }
    return server;
}

/// One question that needs no session, on a connection of its own.
template <typename Request, typename T>
class Question {
public:
    using Response = typename Service<Request>::Response;
    using Convert = std::function<T(const Response&)>;

    Question(std::string url, std::chrono::milliseconds timeout, Convert convert)
        : url_(std::move(url)),
          deadline_(Deadline::in(timeout)),
          convert_(std::move(convert)),
          core_(optionsFor(timeout), ClientPurpose::discovery) {}

    Answer<T> ask() {
        core_.whenOpen([this] { send(); });
        const auto connected = core_.connect(url_);
        core_.close();
        return connected ? std::move(*answer_) : Answer<T>(tl::unexpected(connected.error()));
    }

private:
    static ClientOptions optionsFor(std::chrono::milliseconds timeout) {
        ClientOptions options;
        options.connect_timeout = timeout;
        return options;
    }

    void send() {
        Request request{};
        const std::string_view url = url_;
        request.endpointUrl = viewOf(url);
        core_.send(request, {"asking " + url_, deadline_},
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
    const Convert convert_;
    std::optional<Answer<T>> answer_;  // the client's thread, until connect() has returned
    ClientCore core_;
};

template <typename T, typename Native>
std::vector<T> listFrom(const Native* first, std::size_t count) {
    std::vector<T> list;
    for (std::size_t i = 0; i < count; ++i) {
        list.push_back(fromNative(first[i]));
    }
    return list;
}

}  // namespace

Answer<std::vector<EndpointDescription>> getEndpoints(const std::string& url,
                                                      std::chrono::milliseconds timeout) {
    using List = std::vector<EndpointDescription>;
    Question<UA_GetEndpointsRequest, List> question(
        url, timeout, [](const UA_GetEndpointsResponse& response) {
            return listFrom<EndpointDescription>(response.endpoints, response.endpointsSize);
        });
    return question.ask();
}

Answer<std::vector<ServerDescription>> findServers(const std::string& url,
                                                   std::chrono::milliseconds timeout) {
    using List = std::vector<ServerDescription>;
    Question<UA_FindServersRequest, List> question(
        url, timeout, [](const UA_FindServersResponse& response) {
            return listFrom<ServerDescription>(response.servers, response.serversSize);
        });
    return question.ask();
}

}  // namespace metier::opcua
