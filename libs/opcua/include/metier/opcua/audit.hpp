#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/opcua/node_id.hpp"
#include "metier/opcua/session.hpp"
#include "metier/opcua/status_code.hpp"

namespace metier::opcua {

/// Kind of an audit record. A peer can cause many records of the kinds marked `limited`; beyond a
/// limit these are only counted, see `left_out`.
enum class AuditKind {
    /// A call of a Method that commands, with any outcome.
    called,
    /// An action of the server itself.
    acted,
    /// Limited: the role of the session does not allow the Method.
    denied,
    /// Limited: a session was activated, for the first time or again.
    login,
    /// Limited: a session was not activated, such as for a wrong password.
    login_refused,
    /// Limited: a session was closed by its client, by time-out or at the server's end.
    session_closed,
    /// Limited: a certificate was refused.
    peer_refused,
    /// Number of records of one kind that were only counted, in `text`.
    left_out,
};

/// An action at a server, or an attempt that was refused. All text is printable and at most a few
/// hundred bytes long, whatever a peer sent.
struct AuditRecord {
    /// Kind of the action or attempt.
    AuditKind kind = AuditKind::called;
    /// Server's wall clock.
    UtcTime time;
    /// Name of the called Method, "Start"; or "Denied", "Login", "LoginRefused", "SessionClosed",
    /// "PeerRefused", "LeftOut"; for an action of the server, a word of its own.
    std::string event;
    /// Session that acted; for a refused login with the user name that the client claimed. The null
    /// id stands for the server.
    Session session;
    /// Object of the Method or action; null if there is none.
    NodeId object;
    /// BrowseName of the Object, without its namespace.
    std::string object_name;
    /// Called Method; null if there is none.
    NodeId method;
    /// BrowseName of the Method, without its namespace.
    std::string method_name;
    /// Arguments of a Method; a long one is given by its type, `Double[1000]`
    std::vector<std::string> inputs;
    /// Code that the client got.
    StatusCode status;
    /// Reason, for a person; may be empty.
    std::string text;
    /// Certificate of a refused peer, in DER; empty if it is very long.
    std::string certificate;
};

/// An action of the server itself.
struct OwnAct {
    /// Object on which the server acted.
    NodeId object;
    /// Word for the action: "ControlLost", "Halted".
    std::string event;
    /// Reason, for a person.
    std::string text;
};

}  // namespace metier::opcua
