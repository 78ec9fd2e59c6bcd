#pragma once

#include <string>

namespace metier::skill {

/// Client session that calls a method or writes a value; all text as the client sent it, but the
/// user and the thumbprint, which were checked.
struct Caller {
    /// Id of its OPC UA session, as text; unique while the session lasts.
    std::string session_id{};
    /// Application name that the client gave; nobody checked it. Shown in refusals and records.
    std::string client_name{};
    /// Name of the user whose password or certificate the server has checked; empty: anonymous.
    std::string user_name{};
    /// SHA-1 of its application's certificate, hexadecimal; empty: a connection without
    /// certificate.
    std::string thumbprint{};
    /// A skill of this server that runs others. Its rights were checked at its own Start, so they
    /// are not checked again.
    bool of_this_server = false;
};

}  // namespace metier::skill
