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

// Services that need no session (OPC 10000-4, 5.5). Each opens a connection for itself, without
// security if nothing else is said. Threads: any; waits, at most `timeout` and about a second for
// closing. What a peer says is text as it came: sanitise() it before it is shown.

/// One way to reach a server (OPC 10000-4, 7.14).
struct EndpointDescription {
    enum class SecurityMode { invalid = 0, none = 1, sign = 2, sign_and_encrypt = 3 };
    enum class TokenType { anonymous = 0, user_name = 1, certificate = 2, issued_token = 3 };

    std::string url;
    SecurityMode security_mode = SecurityMode::invalid;
    std::string security_policy_uri;
    std::vector<TokenType> tokens;  ///< how a user may identify
    std::uint8_t security_level = 0;
};

/// What an application is to others (OPC 10000-4, 7.4).
enum class ApplicationType { server = 0, client = 1, client_and_server = 2, discovery_server = 3 };

/// A server that a server knows of, itself included (OPC 10000-4, 7.2).
struct ServerDescription {
    std::string application_uri;
    std::string product_uri;
    LocalizedText application_name;
    ApplicationType type = ApplicationType::server;
    std::vector<std::string> discovery_urls;
};

/// Asks a server how it may be reached.
/// Errors: as Client::connect().
Answer<std::vector<EndpointDescription>> getEndpoints(
    const std::string& url, std::chrono::milliseconds timeout = std::chrono::seconds(5));
/// Asks a server, or a discovery server, which servers it knows.
/// Errors: as Client::connect().
Answer<std::vector<ServerDescription>> findServers(
    const std::string& url, std::chrono::milliseconds timeout = std::chrono::seconds(5));

/// What a server tells a discovery server about itself (OPC 10000-4, 7.32).
struct ServerRegistration {
    enum class Presence {
        online,
        offline,  ///< it is to be forgotten
    };
    std::string application_uri;  ///< by which the discovery server tells servers apart
    std::string product_uri = "urn:metier";
    std::string name;
    std::vector<std::string> discovery_urls;  ///< where clients reach it, at least one
    /// For RegisterServer2 (OPC 10000-12, annex D): "DA", "NA".
    std::vector<std::string> capabilities{"NA"};
    Presence presence = Presence::online;
};

/// Registers a server, or takes it out, by RegisterServer2, and by RegisterServer where the
/// discovery server does not know the former.
/// \param security whom the discovery server is to trust; none: a connection without security
/// Errors: as Client::connect(); the discovery server's, such as invalid_argument.
Answer<> registerServer(const std::string& url, const ServerRegistration& registration,
                        std::chrono::milliseconds timeout = std::chrono::seconds(5),
                        const std::optional<Credentials>& security = std::nullopt);

}  // namespace metier::opcua
