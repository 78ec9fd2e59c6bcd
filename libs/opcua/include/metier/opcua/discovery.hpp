#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "metier/opcua/answer.hpp"
#include "metier/opcua/security.hpp"
#include "metier/opcua/types.hpp"

namespace metier::opcua {

// Services that need no session (OPC 10000-4, 5.5). Each opens a connection of its own, without
// security unless credentials are given. Threads: any; waits, at most `timeout` and about a second
// for closing. Text is returned as the peer sent it: sanitise() it before it is shown.

/// One way to reach a server (OPC 10000-4, 7.14).
struct EndpointDescription {
    /// Protection of messages (MessageSecurityMode of OPC 10000-4).
    enum class SecurityMode { invalid = 0, none = 1, sign = 2, sign_and_encrypt = 3 };
    /// Way in which a user proves who it is (UserTokenType of OPC 10000-4).
    enum class TokenType { anonymous = 0, user_name = 1, certificate = 2, issued_token = 3 };

    /// Address for this endpoint: "opc.tcp://host:port".
    std::string url;
    /// Protection of its messages.
    SecurityMode security_mode = SecurityMode::invalid;
    /// URI of the SecurityPolicy (OPC 10000-7).
    std::string security_policy_uri;
    /// Ways in which a user may log in.
    std::vector<TokenType> tokens;
    /// Rank that the server gives to it, 0: not recommended.
    std::uint8_t security_level = 0;
};

/// Kind of an application (OPC 10000-4, 7.4).
enum class ApplicationType { server = 0, client = 1, client_and_server = 2, discovery_server = 3 };

/// A server that the asked server knows, itself included (OPC 10000-4, 7.2).
struct ServerDescription {
    /// Unique name of the running server.
    std::string application_uri;
    /// Name of the product.
    std::string product_uri;
    /// Name for people.
    LocalizedText application_name;
    /// Kind of the application.
    ApplicationType type = ApplicationType::server;
    /// Addresses at which it can be asked for its endpoints; may be empty.
    std::vector<std::string> discovery_urls;
};

/// Asks a server for its endpoints.
/// Errors: as Client::connect().
Answer<std::vector<EndpointDescription>> getEndpoints(
    const std::string& url, std::chrono::milliseconds timeout = std::chrono::seconds(5));
/// Asks a server, or a discovery server, which servers it knows.
/// Errors: as Client::connect().
Answer<std::vector<ServerDescription>> findServers(
    const std::string& url, std::chrono::milliseconds timeout = std::chrono::seconds(5));

/// Registration of a server at a discovery server (OPC 10000-4, 7.32).
struct ServerRegistration {
    enum class Presence {
        /// The server is there; renew the registration within the discovery server's time, often
        /// some minutes.
        online,
        /// The registration is to be removed.
        offline,
    };
    /// ApplicationUri: key of the server at the discovery server.
    std::string application_uri;
    /// Name of the product.
    std::string product_uri = "urn:metier";
    /// Name for people.
    std::string name;
    /// Addresses for clients, at least one.
    std::vector<std::string> discovery_urls;
    /// For RegisterServer2 (OPC 10000-12, annex D): "DA", "NA".
    std::vector<std::string> capabilities{"NA"};
    /// Whether this registers or removes.
    Presence presence = Presence::online;
};

/// Registers a server, or removes its registration, by RegisterServer2; by RegisterServer where the
/// discovery server does not know RegisterServer2.
/// \param security certificate of this application and the discovery servers that it trusts; none:
///                 a connection without security
/// Errors: as Client::connect(); the discovery server's, such as invalid_argument.
Answer<> registerServer(const std::string& url, const ServerRegistration& registration,
                        std::chrono::milliseconds timeout = std::chrono::seconds(5),
                        const std::optional<Credentials>& security = std::nullopt);

}  // namespace metier::opcua
