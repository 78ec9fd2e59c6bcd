#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "host/server_alarm.hpp"
#include "metier/base/error.hpp"
#include "metier/cell/cell.hpp"
#include "metier/opcua/server.hpp"
#include "metier/security/audit_log.hpp"
#include "metier/skill/executor.hpp"

namespace metier::server {

/// Keeps the audit log of a server, `<state folder>/audit/<name>-<address>-<port>.log`, and says
/// when it cannot be written: in the program's log, and by an event of the Server object.
///
/// Threading: made, followed and ended as its server; ends before it, and after its last client.
class ServerAudit {
public:
    /// Makes the audit log of a server, and sets it in the server's options; before the server is
    /// made.
    /// \return null without a state folder; the program's log says so
    /// Errors: resource_unavailable (the file); invalid_argument (it is no audit log).
    static Result<std::unique_ptr<ServerAudit>> open(const cell::ServerConfig& config,
                                                     opcua::ServerOptions& options);
    ServerAudit(const ServerAudit&) = delete;
    ServerAudit& operator=(const ServerAudit&) = delete;

    /// Raises the events at that server, and publishes the newest chain value in the file, as
    /// Variable AuditAnchor of the Server object. Before its start.
    Result<void> follow(opcua::Server& server, std::shared_ptr<skill::Executor> executor);
    /// Entries that are not in the file yet. Any thread.
    std::size_t waiting() const { return log_->waiting(); }

private:
    explicit ServerAudit(const std::string& name) : alarm_(name, "AuditLog") {}
    Result<void> publishAnchor(opcua::AddressSpace& nodes);
    /// On the log's thread.
    void tell(security::WriteState state, const std::string& why);

    ServerAlarm alarm_;
    std::unique_ptr<security::AuditLog> log_;  // ends first, and its thread
};

}  // namespace metier::server
