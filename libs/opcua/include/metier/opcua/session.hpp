#pragma once

#include <string>

#include "metier/opcua/node_id.hpp"
#include "metier/security/users.hpp"

namespace metier::opcua {

/// A client's session as the server knows it. All text came from the client and is unchecked,
/// except the user name and the thumbprint. The null id stands for the server itself.
/// A value: a copy does not change when the session does.
struct Session {
    /// Id of the session; unique while it lasts.
    NodeId id;
    /// Name that the client gave to the session.
    std::string name;
    /// ApplicationUri that the client gave.
    std::string application_uri;
    /// Name of the client for people.
    std::string application_name;
    /// Name of the user that was accepted; empty: anonymous.
    std::string user;
    /// SHA-1 of its application's trusted certificate, hexadecimal; empty: none.
    std::string thumbprint{};
    /// Role that decides about its rights; without security everybody is an engineer.
    security::Role role = security::Role::observer;
};

/// Whether a role may change anything: write Variables and call Methods that do more than report.
/// Threads: any; pure.
constexpr bool mayCommand(security::Role role) noexcept {
    return role == security::Role::operator_ || role == security::Role::engineer;
}

/// Whether a role may read audit events, that is the actions of others.
/// Threads: any; pure.
constexpr bool mayAudit(security::Role role) noexcept {
    return role == security::Role::engineer || role == security::Role::security_admin;
}

}  // namespace metier::opcua
