#pragma once

#include <string>

#include "metier/opcua/node_id.hpp"
#include "metier/security/users.hpp"

namespace metier::opcua {

/// A client's session as the server knows it. All text came from the client and is unchecked,
/// but the user name and the thumbprint, which were. The null id stands for the server itself.
struct Session {
    NodeId id;
    std::string name;
    std::string application_uri;
    std::string application_name;
    std::string user;          ///< empty: anonymous
    std::string thumbprint{};  ///< of the trusted certificate of its application; empty: none
    /// What it may do; in a lab everybody is an engineer.
    security::Role role = security::Role::observer;
};

/// Whether a role may change anything: write Variables and call Methods that do more than tell.
constexpr bool mayCommand(security::Role role) noexcept {
    return role == security::Role::operator_ || role == security::Role::engineer;
}

/// Whether a role may read what others did: the content of audit events.
constexpr bool mayAudit(security::Role role) noexcept {
    return role == security::Role::engineer || role == security::Role::security_admin;
}

}  // namespace metier::opcua
