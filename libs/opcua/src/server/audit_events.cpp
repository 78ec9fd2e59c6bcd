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

/// As OPC 10000-5 asks for each type.
const char* sourceNameOf(AuditKind kind) {
    switch (kind) {
        case AuditKind::called:
        case AuditKind::denied:
            return "Attribute/Call";
        case AuditKind::login:
        case AuditKind::login_refused:
            return "Session/ActivateSession";
        case AuditKind::session_closed:
            return "Session/CloseSession";
        case AuditKind::peer_refused:
            return "Security/Certificate";
        case AuditKind::left_out:
        case AuditKind::acted:
            break;
    }
    return "Server";
}

enum class Shape { plain, method, session, certificate };

Shape shapeOf(const NodeId& type) {
    if (type == ids::kAuditUpdateMethodEventType) {
        return Shape::method;
    }
    if (type == ids::kAuditSessionEventType || type == ids::kAuditActivateSessionEventType) {
        return Shape::session;
    }
    return type == ids::kAuditEventType || type == ids::kAuditSecurityEventType
               ? Shape::plain
               : Shape::certificate;
}

std::vector<BrowsePath> fieldsOf(const NodeId& type) {
    std::vector<BrowsePath> fields;
    for (const auto* name :
         {"ActionTimeStamp", "Status", "ServerId", "ClientAuditEntryId", "ClientUserId"}) {
        fields.push_back({{0, name}});
    }
    switch (shapeOf(type)) {
        case Shape::method:
            fields.push_back({{0, "MethodId"}});
            fields.push_back({{0, "InputArguments"}});
            break;
        case Shape::session:
            fields.push_back({{0, "SessionId"}});
            break;
        case Shape::certificate:
            fields.push_back({{0, "Certificate"}});
            break;
        case Shape::plain:
            break;
    }
    return fields;
}

/// Values in the order of fieldsOf(). The stack does not give the AuditEntryId of a request.
std::vector<Value> valuesOf(const AuditRecord& record, Shape shape, const std::string& server) {
    std::vector<Value> values{Value::of(record.time), Value::of(!record.status.isBad()),
                              Value::of(server), Value::of(std::string()),
                              Value::of(record.session.user)};
    switch (shape) {
        case Shape::method:
            values.push_back(Value::of(record.method));
            values.push_back(Value::of(record.inputs));
            break;
        case Shape::session:
            values.push_back(Value::of(record.session.id));
            break;
        case Shape::certificate:
            values.push_back(
                Value::of(ByteString{{record.certificate.begin(), record.certificate.end()}}));
            break;
        case Shape::plain:
            break;
    }
    return values;
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

EventEmitter* AuditEvents::emitterOf(const NodeId& type) {
    if (const auto known = emitters_.find(type); known != emitters_.end()) {
        return &known->second;
    }
    auto made = EventEmitter::create(core_, type, fieldsOf(type), EventAudience::auditors);
    if (!made) {
        core_.log().error("no audit events: {}", made.error().message);
        return nullptr;
    }
    return &emitters_.emplace(type, std::move(*made)).first->second;
}

void AuditEvents::emit(const AuditRecord& record) {
    const auto type = typeOf(record);
    auto* emitter = emitterOf(type);
    if (emitter == nullptr) {
        return;
    }
    Event event;
    event.source = ids::kServer;
    event.source_name = sourceNameOf(record.kind);
    event.time = record.time;
    event.severity = record.status.isBad() ? kRefused : kDone;
    event.message = {"en", messageOf(record)};
    event.fields = valuesOf(record, shapeOf(type), core_.options().application_uri);
    if (const auto emitted = emitter->emit(event); !emitted) {
        core_.log().error("no audit event: {}", emitted.error().message);
    }
}

}  // namespace metier::opcua
