#pragma once

#include <open62541/server.h>

#include <functional>
#include <memory>
#include <unordered_map>
#include <vector>

#include "metier/opcua/server.hpp"
#include "server/application_sessions.hpp"
#include "server/unused_sessions.hpp"

namespace metier::opcua {

/// The logged-in sessions, and the decision about logins. Installed as the stack's access control.
///
/// Clients may read and browse; those whose role commands may also write and call. Only the server
/// itself changes nodes and references.
/// Threading: the server's thread.
class Sessions {
public:
    using Handler = std::function<void(const Session&)>;

    /// \param options must outlive this
    explicit Sessions(const ServerOptions& options);
    Sessions(const Sessions&) = delete;
    Sessions& operator=(const Sessions&) = delete;

    /// This object must outlive the server made with the configuration.
    void install(UA_ServerConfig& config);
    /// The session behind the context that the stack hands to callbacks; without one the server.
    const Session& of(const void* context) const noexcept;
    /// Calls whenever a session is activated: at first, and again on another connection.
    void onActivated(Handler handler) { activated_ = std::move(handler); }
    using RefusedHandler = std::function<void(const Session&, StatusCode, const std::string& why)>;
    /// Calls whenever a session is not activated; its user is the one that was claimed.
    void onRefused(RefusedHandler handler) { refused_ = std::move(handler); }
    void onClosed(Handler handler) { closed_.push_back(std::move(handler)); }
    std::size_t count() const noexcept { return sessions_.size(); }
    /// Whether an application may create one more, which it is then about to do.
    bool mayCreate(const ApplicationSessions::Application& application);
    /// The stack has made a session, which is not activated yet. Some other such one is closed soon
    /// if there are too many.
    void created(UA_Server* server, const NodeId& id, std::uintptr_t connection);
    void closeIf(UA_Server* server, const std::function<bool(const Session&)>& which);

private:
    struct Callbacks;

    /// Data that a client presents to log in.
    struct Presented {
        const UA_ExtensionObject& token;
        std::string thumbprint;   ///< empty without security
        std::string certificate;  ///< in DER
    };
    StatusCode activate(UA_Server* server, const UA_NodeId& id, const Presented& presented,
                        void** context);
    void close(UA_Server* server, const UA_NodeId& id);
    void makeRoom(UA_Server* server);
    void limitStack(UA_ServerConfig& config) const;
    void closeUnused(UA_Server* server, const NodeId& id) const;
    void tellRefusal(UA_Server* server, const NodeId& id, const Presented& presented,
                     const Error& error);
    Result<Admission> admit(const Presented& presented) const;

    const ServerOptions& options_;
    std::unordered_map<NodeId, std::unique_ptr<Session>> sessions_;
    UnusedSessions unused_;
    ApplicationSessions by_application_;
    Session server_session_{{}, "server", {}, {}, {}};
    Handler activated_;
    RefusedHandler refused_;
    std::vector<Handler> closed_;
};

}  // namespace metier::opcua
