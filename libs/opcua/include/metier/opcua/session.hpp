#pragma once

#include <string>

#include "metier/opcua/node_id.hpp"
#include "metier/security/users.hpp"

namespace metier::opcua {

/// A client's session as the server knows it. All text came from the client and is unchecked,
/// except the user name and the thumbprint. The null id stands for the server itself.
struct Session {
    NodeId id;
    std::string name;
    std::string application_uri;
    std::string application_name;
    std::string user;          ///< empty: anonymous
    std::string thumbprint{};  ///< of its application's trusted certificate; empty: none
    /// Role that decides about its rights; without security everybody is an engineer.
    security::Role role = security::Role::observer;
};

/// Whether a role may change anything: write Variables and call Methods that do more than report.
constexpr bool mayCommand(security::Role role) noexcept {
    return role == security::Role::operator_ || role == security::Role::engineer;
}

/// Whether a role may read audit events, that is the actions of others.
constexpr bool mayAudit(security::Role role) noexcept {
    return role == security::Role::engineer || role == security::Role::security_admin;
}

}  // namespace metier::opcua
