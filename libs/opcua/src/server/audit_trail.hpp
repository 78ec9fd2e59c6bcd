#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "metier/opcua/address_space.hpp"
#include "metier/opcua/audit.hpp"
#include "metier/opcua/security.hpp"
#include "metier/opcua/server.hpp"
#include "server/audit_events.hpp"
#include "server/rate_limit.hpp"

namespace metier::opcua {

/// Notifies ServerOptions::on_audit, and the subscribers of audit events, what sessions and the
/// server do. What a peer may cause without a role that commands is limited in number, and the rest
/// counted.
///
/// Threading: the server's thread.
class AuditTrail {
public:
    explicit AuditTrail(ServerCore& core);

    void called(const CallContext& context, std::span<const Value> inputs, StatusCode outcome,
                std::string_view why);
    void denied(const CallContext& context);
    void loggedIn(const Session& session);
    void loginRefused(const Session& session, StatusCode status, std::string_view why);
    void sessionClosed(const Session& session);
    void peerRefused(std::string_view der, StatusCode status, std::string_view why);
    void acted(const OwnAct& act);
    /// Reports what was left out up to now.
    void tellLeftOut();

private:
    struct Limit {
        AuditKind kind;
        std::string_view event;
        RateLimit rate;
        std::uint64_t left_out = 0;
    };

    bool nobodyCares() const;
    /// Whether one more of a kind is noted; else it is counted.
    bool passes(AuditKind kind);
    void note(AuditRecord record);

    ServerCore& core_;
    AuditEvents events_;
    std::array<Limit, 5> limits_;
    TimerHandle timer_;  ///< time until the left-out records are reported
    bool waiting_ = false;
};

}  // namespace metier::opcua
