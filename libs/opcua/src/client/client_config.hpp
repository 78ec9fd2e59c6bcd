#pragma once

#include <open62541/client.h>

#include <string>

#include "common/peer_check.hpp"
#include "metier/opcua/client.hpp"

namespace metier::opcua {

/// Keeps the last thing the stack complained about, to explain a failed connection.
///
/// Threading: one thread.
class ClientComplaints {
public:
    ClientComplaints() noexcept;
    ClientComplaints(const ClientComplaints&) = delete;
    ClientComplaints& operator=(const ClientComplaints&) = delete;

    UA_Logger* logger() noexcept { return &logger_; }
    /// The last warning or error, printable; empty if there was none.
    const std::string& last() const noexcept { return last_; }

private:
    static void log(void* context, UA_LogLevel level, UA_LogCategory category, const char* format,
                    va_list arguments);

    UA_Logger logger_;
    std::string last_;
};

/// Purpose of a connection.
enum class ConnectionKind {
    session,    ///< everything a Client offers
    discovery,  ///< services that need no session
};

struct ClientPlugins {
    UA_EventLoop* loop = nullptr;
    UA_Logger* logger = nullptr;
    PeerCheck* peers = nullptr;  ///< for a connection with security
    std::string url{};           ///< address to connect to
};

/// The stack's configuration for one client. Who calls owns it, until it is handed to
/// UA_Client_newWithConfig().
/// Errors: invalid_argument (the own certificate).
Result<UA_ClientConfig> makeClientConfig(const ClientOptions& options, ConnectionKind kind,
                                         const ClientPlugins& plugins);

}  // namespace metier::opcua
