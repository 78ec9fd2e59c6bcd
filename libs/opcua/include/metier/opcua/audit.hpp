#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/opcua/node_id.hpp"
#include "metier/opcua/session.hpp"
#include "metier/opcua/status_code.hpp"

namespace metier::opcua {

/// What an audit notes. Of those that `limited` marks a peer may cause many: then they are counted
/// instead, see AuditRecord::event.
enum class AuditKind {
    called,          ///< a Method that commands, whatever came of it
    acted,           ///< the server, by itself
    denied,          ///< limited: a Method that the role of the session does not allow
    login,           ///< limited: a session was activated, at first or again
    login_refused,   ///< limited
    session_closed,  ///< limited: by its client, by time-out or at the server's end
    peer_refused,    ///< limited: a certificate
    left_out,        ///< how many of one kind were not noted one by one, in `text`
};

/// What somebody did at a server, or was not let do. All text is printable and at most a few
/// hundred bytes long, whatever a peer sent.
struct AuditRecord {
    AuditKind kind = AuditKind::called;
    UtcTime time;
    /// The name of the Method that was called, "Start"; "Denied", "Login", "LoginRefused",
    /// "SessionClosed", "PeerRefused", "LeftOut"; of what the server did, its own word.
    std::string event;
    /// Who; the user of a refused login is the one that was claimed. The null id: the server.
    Session session;
    NodeId object;
    std::string object_name;  ///< BrowseName, without its namespace
    NodeId method;
    std::string method_name;
    std::vector<std::string> inputs;  ///< of a Method; a long one by its type, `Double[1000]`
    StatusCode status;                ///< what the client was answered
    std::string text;                 ///< why, for a person; may be empty
    std::string certificate;          ///< DER of a refused peer; empty if it is very long
};

/// What a server did by itself.
struct OwnAct {
    NodeId object;
    std::string event;  ///< "ControlLost", "Halted"
    std::string text;   ///< why, for a person
};

}  // namespace metier::opcua
