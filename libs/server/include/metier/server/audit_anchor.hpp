#pragma once

namespace metier::server {

/// BrowseName of the Variable of the Server object, in metier's namespace, that publishes the
/// newest chain value of a server's audit log.
constexpr const char* kAuditAnchor = "AuditAnchor";

}  // namespace metier::server
