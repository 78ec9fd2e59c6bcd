#include "server/audit_events.hpp"

#include <fmt/format.h>

#include "server/server_core.hpp"

namespace metier::opcua {

namespace {

constexpr std::uint16_t kDone = 100;
constexpr std::uint16_t kRefused = 500;

NodeId certificateTypeOf(StatusCode status) {
    switch (status.value()) {
        case UA_STATUSCODE_BADCERTIFICATEUNTRUSTED:
            return ids::kAuditCertificateUntrustedEventType;
        case UA_STATUSCODE_BADCERTIFICATETIMEINVALID:
            return ids::kAuditCertificateExpiredEventType;
        case UA_STATUSCODE_BADCERTIFICATEREVOKED:
            return ids::kAuditCertificateRevokedEventType;
        case UA_STATUSCODE_BADCERTIFICATEUSENOTALLOWED:
            return ids::kAuditCertificateMismatchEventType;
        default:
            return ids::kAuditCertificateInvalidEventType;
    }
}

NodeId typeOf(const AuditRecord& record) {
    switch (record.kind) {
        case AuditKind::called:
        case AuditKind::denied:
            return ids::kAuditUpdateMethodEventType;
        case AuditKind::login:
        case AuditKind::login_refused:
            return ids::kAuditActivateSessionEventType;
        case AuditKind::session_closed:
            return ids::kAuditSessionEventType;
        case AuditKind::peer_refused:
            return certificateTypeOf(record.status);
        case AuditKind::left_out:
            return ids::kAuditSecurityEventType;
        case AuditKind::acted:
            break;
    }
    return ids::kAuditEventType;
}

/// Content of an event that depends on the kind of its record.
struct Details {
    const char* source_name = "Server";  ///< as OPC 10000-5 asks for each type
    std::vector<std::pair<const char*, Value>> fields{};
};

Details detailsOf(const AuditRecord& record) {
    switch (record.kind) {
        case AuditKind::called:
        case AuditKind::denied:
            return {"Attribute/Call",
                    {{"MethodId", Value::of(record.method)},
                     {"InputArguments", Value::of(record.inputs)}}};
        case AuditKind::login:
        case AuditKind::login_refused:
            return {"Session/ActivateSession", {{"SessionId", Value::of(record.session.id)}}};
        case AuditKind::session_closed:
            return {"Session/CloseSession", {{"SessionId", Value::of(record.session.id)}}};
        case AuditKind::peer_refused:
            return {
                "Security/Certificate",
                {{"Certificate",
                  Value::of(ByteString{{record.certificate.begin(), record.certificate.end()}})}}};
        case AuditKind::left_out:
        case AuditKind::acted:
            break;
    }
    return {};
}

std::string whoIs(const Session& session) {
    return fmt::format("{} ({}) of \"{}\", certificate {}",
                       session.user.empty() ? "somebody" : session.user,
                       security::toString(session.role), session.application_name,
                       session.thumbprint.empty() ? "none" : session.thumbprint);
}

std::string messageOf(const AuditRecord& record) {
    const auto why = record.text.empty() ? "" : ": " + record.text;
    switch (record.kind) {
        case AuditKind::called:
        case AuditKind::denied:
            return fmt::format("{} of {} ({}) by {}: {}{}", record.method_name, record.object_name,
                               record.object.toString(), whoIs(record.session),
                               record.status.name(), why);
        case AuditKind::login:
        case AuditKind::login_refused:
        case AuditKind::session_closed:
        case AuditKind::peer_refused:
            return fmt::format("{}: {}: {}{}", record.event, whoIs(record.session),
                               record.status.name(), why);
        case AuditKind::acted:
            return fmt::format("{} of {} ({}) by the server{}", record.event, record.object_name,
                               record.object.toString(), why);
        case AuditKind::left_out:
            break;
    }
    return fmt::format("{}{}", record.event, why);
}

}  // namespace

EventEmitter* AuditEvents::emitterOf(const NodeId& type, const std::vector<BrowsePath>& fields) {
    if (const auto known = emitters_.find(type); known != emitters_.end()) {
        return &known->second;
    }
    auto made = EventEmitter::create(core_, type, fields, EventAudience::auditors);
    if (!made) {
        core_.log().error("no audit events: {}", made.error().message);
        return nullptr;
    }
    return &emitters_.emplace(type, std::move(*made)).first->second;
}

void AuditEvents::emit(const AuditRecord& record) {
    auto [source_name, fields] = detailsOf(record);
    // The stack does not give the AuditEntryId of a request.
    fields.insert(fields.begin(), {{"ActionTimeStamp", Value::of(record.time)},
                                   {"Status", Value::of(!record.status.isBad())},
                                   {"ServerId", Value::of(core_.options().application_uri)},
                                   {"ClientAuditEntryId", Value::of(std::string())},
                                   {"ClientUserId", Value::of(record.session.user)}});
    std::vector<BrowsePath> paths;
    Event event;
    for (auto& [name, value] : fields) {
        paths.push_back({{0, name}});
        event.fields.push_back(std::move(value));
    }
    auto* emitter = emitterOf(typeOf(record), paths);
    if (emitter == nullptr) {
        return;
    }
    event.source = ids::kServer;
    event.source_name = source_name;
    event.time = record.time;
    event.severity = record.status.isBad() ? kRefused : kDone;
    event.message = {"en", messageOf(record)};
    if (const auto emitted = emitter->emit(event); !emitted) {
        core_.log().error("no audit event: {}", emitted.error().message);
    }
}

}  // namespace metier::opcua
