#include "server/audit_trail.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "common/convert.hpp"
#include "metier/opcua/text.hpp"
#include "metier/security/certificate.hpp"
#include "server/server_core.hpp"

namespace metier::opcua {

namespace {

constexpr std::chrono::seconds kTellLeftOut{10};
constexpr std::size_t kLongestText = 400;           // [byte]
constexpr std::size_t kLongestInput = 1'000;        // [byte] encoded; beyond: its type alone
constexpr std::size_t kMostInputs = 10;             // far more than any Method of ours has
constexpr std::size_t kLongestCertificate = 8'192;  // [byte]

constexpr unsigned kUtf8Mask = 0xC0;
constexpr unsigned kUtf8Continuation = 0x80;

/// Printable, and cut where a character ends.
std::string shortText(std::string_view text) {
    if (text.size() <= kLongestText) {
        return sanitise(text);
    }
    auto end = kLongestText;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & kUtf8Mask) == kUtf8Continuation) {
        --end;
    }
    return sanitise(text.substr(0, end)) + "...";
}

std::string shortText(const Value& value) {
    const auto& native = ValueAccess::native(value);
    return UA_calcSizeBinary(&native, &UA_TYPES[UA_TYPES_VARIANT]) > kLongestInput
               ? value.typeName()
               : shortText(value.toString());
}

Session shortened(const Session& session) {
    return {session.id,
            shortText(session.name),
            shortText(session.application_uri),
            shortText(session.application_name),
            shortText(session.user),
            session.thumbprint,
            session.role};
}

std::string browseNameOf(ServerCore& core, const NodeId& node) {
    return core.nodes().browseNameOf(node).value_or(QualifiedName()).name;
}

AuditRecord recordOf(AuditKind kind, std::string event) {
    AuditRecord record;
    record.kind = kind;
    record.time = std::chrono::system_clock::now();
    record.event = std::move(event);
    return record;
}

AuditRecord recordOf(AuditKind kind, std::string event, const Session& session) {
    auto record = recordOf(kind, std::move(event));
    record.session = shortened(session);
    return record;
}

/// Record of a call; its event is still empty.
AuditRecord recordOf(AuditKind kind, const CallContext& context, ServerCore& core) {
    auto record = recordOf(kind, {}, context.session);
    record.object = context.object;
    record.object_name = browseNameOf(core, context.object);
    record.method = context.method;
    record.method_name = browseNameOf(core, context.method);
    return record;
}

}  // namespace

AuditTrail::AuditTrail(ServerCore& core)
    : core_(core),
      events_(core),
      limits_{Limit{AuditKind::peer_refused, "PeerRefused", {20, 0.1}},
              Limit{AuditKind::login_refused, "LoginRefused", {100, 1}},
              Limit{AuditKind::denied, "Denied", {100, 1}},
              Limit{AuditKind::login, "Login", {200, 2}},
              Limit{AuditKind::session_closed, "SessionClosed", {200, 2}}} {}

void AuditTrail::called(const CallContext& context, std::span<const Value> inputs,
                        StatusCode outcome, std::string_view why) {
    if (nobodyCares()) {
        return;
    }
    auto record = recordOf(AuditKind::called, context, core_);
    record.event = record.method_name;
    for (const auto& input : inputs.first(std::min(inputs.size(), kMostInputs))) {
        record.inputs.push_back(shortText(input));
    }
    record.status = outcome;
    record.text = shortText(why);
    note(std::move(record));
}

void AuditTrail::denied(const CallContext& context) {
    if (!passes(AuditKind::denied)) {
        return;
    }
    auto record = recordOf(AuditKind::denied, context, core_);
    record.event = "Denied";
    record.status = status::kBadUserAccessDenied;
    note(std::move(record));
}

void AuditTrail::loggedIn(const Session& session) {
    if (passes(AuditKind::login)) {
        note(recordOf(AuditKind::login, "Login", session));
    }
}

void AuditTrail::loginRefused(const Session& session, StatusCode status, std::string_view why) {
    if (!passes(AuditKind::login_refused)) {
        return;
    }
    auto record = recordOf(AuditKind::login_refused, "LoginRefused", session);
    record.status = status;
    record.text = shortText(why);
    note(std::move(record));
}

void AuditTrail::sessionClosed(const Session& session) {
    if (passes(AuditKind::session_closed)) {
        note(recordOf(AuditKind::session_closed, "SessionClosed", session));
    }
}

void AuditTrail::peerRefused(std::string_view der, StatusCode status, std::string_view why) {
    if (!passes(AuditKind::peer_refused)) {
        return;
    }
    auto record = recordOf(AuditKind::peer_refused, "PeerRefused");
    record.session.thumbprint = security::thumbprintOf(der);
    if (const auto certificate = security::Certificate::fromDer(der)) {
        record.session.application_uri = shortText(certificate->applicationUri());
        record.session.application_name = shortText(certificate->subject());
    }
    record.status = status;
    record.text = shortText(why);
    record.certificate = der.size() > kLongestCertificate ? std::string() : std::string(der);
    note(std::move(record));
}

void AuditTrail::acted(const OwnAct& act) {
    auto record = recordOf(AuditKind::acted, shortText(act.event));
    record.session.name = "server";
    record.object = act.object;
    record.object_name = browseNameOf(core_, act.object);
    record.text = shortText(act.text);
    note(std::move(record));
}

void AuditTrail::tellLeftOut() {
    waiting_ = false;
    for (auto& limit : limits_) {
        const auto count = std::exchange(limit.left_out, 0);
        if (count == 0) {
            continue;
        }
        auto record = recordOf(AuditKind::left_out, "LeftOut");
        record.text = fmt::format("{} more of {}", count, limit.event);
        note(std::move(record));
    }
}

bool AuditTrail::nobodyCares() const {
    return !core_.options().on_audit && !core_.isWatched(ids::kServer);
}

bool AuditTrail::passes(AuditKind kind) {
    if (nobodyCares()) {
        return false;
    }
    auto* limit = std::find_if(limits_.begin(), limits_.end(),
                               [&](const Limit& each) { return each.kind == kind; });
    if (limit->rate.take(std::chrono::steady_clock::now())) {
        return true;
    }
    ++limit->left_out;
    if (!std::exchange(waiting_, true)) {
        // Not from inside a callback of the stack.
        core_.post([this] { timer_ = core_.after(kTellLeftOut, [this] { tellLeftOut(); }); });
    }
    return false;
}

void AuditTrail::note(AuditRecord record) {
    if (core_.options().on_audit) {
        core_.options().on_audit(record);
    }
    if (core_.isWatched(ids::kServer)) {
        // The stack calls about peers and sessions while it is at work on them.
        core_.post([this, record = std::move(record)] { events_.emit(record); });
    }
}

}  // namespace metier::opcua
