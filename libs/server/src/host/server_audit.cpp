#include "host/server_audit.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <utility>

#include "metier/opcua_skill/namespaces.hpp"
#include "metier/security/users.hpp"
#include "metier/server/audit_anchor.hpp"

namespace metier::server {
namespace {

security::Entry entryOf(const opcua::AuditRecord& record) {
    security::Entry entry{record.time, record.event, {}};
    const auto add = [&](const char* name, const std::string& value) {
        if (!value.empty()) {
            entry.fields.emplace_back(name, value);
        }
    };
    const auto& session = record.session;
    const bool of_client = !session.id.isNull();
    add("user", session.user);
    add("role", of_client ? std::string(security::toString(session.role)) : "");
    add("application", session.application_name);
    add("application_uri", session.application_uri);
    add("thumbprint", session.thumbprint);
    add("session", of_client ? session.id.toString() : session.name);
    add("object", record.object_name);
    add("object_id", record.object.isNull() ? "" : record.object.toString());
    add("method", record.method_name == record.event ? "" : record.method_name);
    add("inputs", fmt::format("{}", fmt::join(record.inputs, "; ")));
    add("status", record.status.name());
    add("text", record.text);
    return entry;
}

}  // namespace

Result<std::unique_ptr<ServerAudit>> ServerAudit::open(const cell::ServerConfig& config,
                                                       opcua::ServerOptions& options) {
    if (config.state_folder.empty()) {
        const auto level = options.security ? spdlog::level::warn : spdlog::level::info;
        spdlog::log(level, "{}: no state folder, so no audit log", config.name);
        return nullptr;
    }
    std::unique_ptr<ServerAudit> audit(new ServerAudit(config.name));
    METIER_ASSIGN(
        audit->log_,
        security::AuditLog::open(
            {.file = config.state_folder / "audit" /
                     fmt::format("{}-{}-{}.log", config.name, config.address, config.port),
             .on_write_state = [&audit = *audit](security::WriteState state,
                                                 const std::string& why) {
                 audit.tell(state, why);
             }}));
    options.on_audit = [&log = *audit->log_,
                        before = std::move(options.on_audit)](const opcua::AuditRecord& record) {
        log.append(entryOf(record));
        if (before) {
            before(record);
        }
    };
    return audit;
}

Result<void> ServerAudit::follow(opcua::Server& server, std::shared_ptr<skill::Executor> executor) {
    METIER_TRY(publishAnchor(server.nodes()));
    return alarm_.follow(server, std::move(executor));
}

Result<void> ServerAudit::publishAnchor(opcua::AddressSpace& nodes) {
    METIER_ASSIGN(const auto metier, nodes.namespaceIndex(opcua_skill::kMetierUri));
    METIER_ASSIGN(
        const auto variable,
        nodes.addVariable(
            {.node = {.id = {},
                      .parent = opcua::ids::kServer,
                      .browse_name = {metier, kAuditAnchor},
                      .description = {"en", "Chain value of the newest line of the audit log"}},
             .data_type = opcua::ids::kString,
             .value = opcua::Value::of(log_->anchor())}));
    return nodes.setDataSource(
        variable, {.read =
                       [&log = *log_](const opcua::Session& /*session*/) {
                           return opcua::DataValue{opcua::Value::of(log.anchor()), {}, {}, {}};
                       },
                   .write = {}});
}

void ServerAudit::tell(security::WriteState state, const std::string& why) {
    if (state == security::WriteState::failing) {
        alarm_.tell(
            ServerAlarm::Kind::begins,
            fmt::format("the audit log cannot be written: {}; up to 10000 entries wait", why));
    } else {
        alarm_.tell(ServerAlarm::Kind::over, "the audit log is written again");
    }
}

}  // namespace metier::server
