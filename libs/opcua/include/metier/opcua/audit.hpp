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
    called,          ///< a call of a Method that commands, with any outcome
    acted,           ///< an action of the server itself
    denied,          ///< limited: the role of the session does not allow the Method
    login,           ///< limited: a session was activated, for the first time or again
    login_refused,   ///< limited
    session_closed,  ///< limited: by its client, by time-out or at the server's end
    peer_refused,    ///< limited: a certificate was refused
    left_out,        ///< number of records of one kind that were only counted, in `text`
};

/// An action at a server, or an attempt that was refused. All text is printable and at most a few
/// hundred bytes long, whatever a peer sent.
struct AuditRecord {
    AuditKind kind = AuditKind::called;
    UtcTime time;
    /// Name of the called Method, "Start"; or "Denied", "Login", "LoginRefused", "SessionClosed",
    /// "PeerRefused", "LeftOut"; for an action of the server, a word of its own.
    std::string event;
    /// Session that acted; for a refused login with the user name that the client claimed. The null
    /// id stands for the server.
    Session session;
    NodeId object;
    std::string object_name;  ///< BrowseName, without its namespace
    NodeId method;
    std::string method_name;
    /// Arguments of a Method; a long one is given by its type, `Double[1000]`
    std::vector<std::string> inputs;
    StatusCode status;        ///< code that the client got
    std::string text;         ///< reason, for a person; may be empty
    std::string certificate;  ///< DER of a refused peer; empty if it is very long
};

/// An action of the server itself.
struct OwnAct {
    NodeId object;
    std::string event;  ///< "ControlLost", "Halted"
    std::string text;   ///< reason, for a person
};

}  // namespace metier::opcua
