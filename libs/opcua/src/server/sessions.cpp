#include "server/sessions.hpp"

#include <algorithm>
#include <limits>

#include "common/convert.hpp"
#include "common/guard.hpp"
#include "metier/opcua/text.hpp"
#include "metier/security/certificate.hpp"
#include "server/server_core.hpp"

namespace metier::opcua {

namespace {

constexpr std::uint8_t kAllAccess = 0xFF;
constexpr std::uint8_t kReadAccess = UA_ACCESSLEVELMASK_READ | UA_ACCESSLEVELMASK_HISTORYREAD;

bool isAbsent(const UA_ExtensionObject& token) noexcept {
    return token.encoding == UA_EXTENSIONOBJECT_ENCODED_NOBODY;
}

void addTokenPolicy(UA_AccessControl& control, UA_UserTokenType type, std::string_view id) {
    UA_UserTokenPolicy policy{};
    policy.tokenType = type;
    policy.policyId = viewOf(id);
    checkAllocated(UA_Array_appendCopy(reinterpret_cast<void**>(&control.userTokenPolicies),
                                       &control.userTokenPoliciesSize, &policy,
                                       &UA_TYPES[UA_TYPES_USERTOKENPOLICY]));
}

void closeInStack(UA_Server* server, const NodeId& session) {
    const UA_NodeId id = viewOf(session);
    UA_Server_closeSession(server, &id);
}

void describe(UA_Server* server, Session& session) {
    const UA_NodeId id = viewOf(session.id);
    UA_ApplicationDescription client{};
    if (UA_Server_getSessionAttribute_scalar(
            server, &id, UA_QualifiedName{0, viewOf("clientDescription")},
            &UA_TYPES[UA_TYPES_APPLICATIONDESCRIPTION], &client) == UA_STATUSCODE_GOOD) {
        session.application_uri = sanitise(textFrom(client.applicationUri));
        session.application_name = sanitise(textFrom(client.applicationName.text));
    }
    UA_String name{};
    if (UA_Server_getSessionAttribute_scalar(
            server, &id, UA_QualifiedName{0, viewOf("sessionName")}, &UA_TYPES[UA_TYPES_STRING],
            &name) == UA_STATUSCODE_GOOD) {
        session.name = sanitise(textFrom(name));
    }
}

StatusCode refusalOf(const Error& error) noexcept {
    return error.code == Errc::not_supported ? status::kBadIdentityTokenInvalid
                                             : status::kBadUserAccessDenied;
}

}  // namespace

/// Callbacks of the stack. It passes the session's context, which is ours or null.
struct Sessions::Callbacks {
    static Sessions& owner(UA_AccessControl* control) noexcept {
        return *static_cast<Sessions*>(control->context);
    }
    static UA_StatusCode activate(UA_Server* server, UA_AccessControl* control,
                                  const UA_EndpointDescription* /*endpoint*/,
                                  const UA_ByteString* certificate, const UA_NodeId* id,
                                  const UA_ExtensionObject* token, void** context) noexcept {
        return guarded([&] {
            const auto der =
                certificate == nullptr ? std::string() : std::string(bytesOf(*certificate));
            const auto thumbprint = der.empty() ? der : security::thumbprintOf(der);
            return owner(control).activate(server, *id, {*token, thumbprint, der}, context).value();
        });
    }
    static void close(UA_Server* server, UA_AccessControl* control, const UA_NodeId* id,
                      void* /*context*/) noexcept {
        guarded([&] { owner(control).close(server, *id); });
    }
    static UA_Byte accessLevel(UA_Server* server, UA_AccessControl* control,
                               const UA_NodeId* session_id, void* context, const UA_NodeId* node,
                               void* node_context) noexcept {
        const bool for_auditors = node_context == auditorsOnly();
        if (!ServerCore::of(server).mayWorkOn() ||
            (session_id == nullptr && (for_auditors || isOfTheStack(*node, node_context)))) {
            return 0;
        }
        if (for_auditors && context != nullptr && !mayAudit(owner(control).of(context).role)) {
            return 0;
        }
        if (context == nullptr) {
            return kAllAccess;
        }
        return mayCommand(owner(control).of(context).role) && isData(server, *node, node_context)
                   ? kAllAccess
                   : kReadAccess;
    }
    /// Whether a node is not the declaration of a type. A value that no program serves is kept by
    /// the server from here on, which is asked before each read and write of a client.
    static bool isData(UA_Server* server, const UA_NodeId& node,
                       const void* node_context) noexcept {
        auto storage = Storage::elsewhere;
        const auto code = guarded([&] {
            if (node_context == nullptr) {
                storage = keepValueOf(ServerCore::of(server), fromNative(node));
            }
        });
        return code == UA_STATUSCODE_GOOD && storage != Storage::declared;
    }
    /// Whether a node belongs to the diagnostics of a session, which the stack keeps in namespace
    /// 1. If a Subscription that has outlived its session asks for them, the stack would use a
    /// session that is null.
    static bool isOfTheStack(const UA_NodeId& node, const void* node_context) noexcept {
        return node.namespaceIndex == 1 && node_context == nullptr;
    }
    /// Methods of ours answer for themselves, with the StatusCode that the stack has not.
    static UA_Boolean executableOnObject(UA_Server* server, UA_AccessControl* /*control*/,
                                         const UA_NodeId* /*session_id*/, void* context,
                                         const UA_NodeId* method, void* method_context,
                                         const UA_NodeId* /*object*/,
                                         void* /*object_context*/) noexcept {
        return ServerCore::of(server).hooks().at(method_context) != nullptr ||
               mayCall(server, context, *method, method_context);
    }
    static void clear(UA_AccessControl* control) noexcept {
        UA_Array_delete(control->userTokenPolicies, control->userTokenPoliciesSize,
                        &UA_TYPES[UA_TYPES_USERTOKENPOLICY]);
        control->userTokenPolicies = nullptr;
        control->userTokenPoliciesSize = 0;
    }
};

Sessions::Sessions(const ServerOptions& options)
    : options_(options),
      by_application_(options.limits.sessions_per_application, options.limits.session_timeout) {}

bool Sessions::mayCreate(const ApplicationSessions::Application& application) {
    return by_application_.create(application, std::chrono::steady_clock::now());
}

void Sessions::created(UA_Server* server, const NodeId& id, std::uintptr_t connection) {
    unused_.created(id, connection);
    limitStack(*UA_Server_getConfig(server));
    if (sessions_.size() + unused_.count() > options_.limits.sessions) {
        ServerCore::of(server).post([this, server] { makeRoom(server); });
    }
}

void Sessions::makeRoom(UA_Server* server) {
    while (sessions_.size() + unused_.count() > options_.limits.sessions) {
        const auto surplus = unused_.surplus();
        if (!surplus) {
            return;
        }
        closeInStack(server, *surplus);
        unused_.gone(*surplus);
    }
}

/// The stack would refuse a new session for the sake of those that are not activated. While there
/// is room for one that is, it makes some more, and others go once it has.
void Sessions::limitStack(UA_ServerConfig& config) const {
    constexpr std::uint32_t kInOneTurn = 32;
    const std::uint32_t most = options_.limits.sessions;
    const auto with_unused =
        std::min<std::uint32_t>(2 * most + kInOneTurn, std::numeric_limits<UA_UInt16>::max());
    config.maxSessions = static_cast<UA_UInt16>(sessions_.size() < most ? with_unused : most);
}

void Sessions::install(UA_ServerConfig& config) {
    limitStack(config);
    UA_AccessControl& control = config.accessControl;
    control.context = this;
    control.clear = Callbacks::clear;
    control.activateSession = Callbacks::activate;
    control.closeSession = Callbacks::close;
    // The stack (1.4.11) loses items that are sampled with the publishing interval when it hands a
    // Subscription over: their end writes into freed memory.
    control.allowTransferSubscription = [](auto...) -> UA_Boolean { return false; };
    control.getUserRightsMask = [](auto...) -> UA_UInt32 { return 0; };
    control.getUserAccessLevel = Callbacks::accessLevel;
    control.getUserExecutableOnObject = Callbacks::executableOnObject;
    control.allowBrowseNode = [](UA_Server* server, auto...) -> UA_Boolean {
        return ServerCore::of(server).mayWorkOn();
    };
    control.allowAddNode = [](auto...) -> UA_Boolean { return false; };
    control.allowAddReference = [](auto...) -> UA_Boolean { return false; };
    control.allowDeleteNode = [](auto...) -> UA_Boolean { return false; };
    control.allowDeleteReference = [](auto...) -> UA_Boolean { return false; };
    control.allowHistoryUpdateUpdateData = [](auto...) -> UA_Boolean { return false; };
    control.allowHistoryUpdateDeleteRawModified = [](auto...) -> UA_Boolean { return false; };
    addTokenPolicy(control, UA_USERTOKENTYPE_ANONYMOUS, "anonymous");
    addTokenPolicy(control, UA_USERTOKENTYPE_USERNAME, "username");
    // The channels of a lab have no encryption.
    config.allowNonePolicyPassword = !options_.security;
}

const Session& Sessions::of(const void* context) const noexcept {
    return context == nullptr ? server_session_ : *static_cast<const Session*>(context);
}

Result<Admission> Sessions::admit(const Presented& presented) const {
    const auto& token = presented.token;
    const bool is_anonymous =
        isAbsent(token) || decodedAs<const UA_AnonymousIdentityToken>(
                               token, UA_TYPES[UA_TYPES_ANONYMOUSIDENTITYTOKEN]) != nullptr;
    const auto* named =
        decodedAs<const UA_UserNameIdentityToken>(token, UA_TYPES[UA_TYPES_USERNAMEIDENTITYTOKEN]);
    if (!is_anonymous && named == nullptr) {
        return fail(Errc::not_supported, "a kind of identity this server does not know");
    }
    if (!options_.security) {
        return Admission{"", security::Role::engineer};  // a lab, where names prove nothing
    }
    if (is_anonymous) {
        return options_.security->authenticate(
            {"", "", presented.thumbprint, presented.certificate});
    }
    const Login login{textFrom(named->userName), textFrom(named->password), presented.thumbprint,
                      presented.certificate};
    if (login.user.empty()) {
        return fail(Errc::access_denied, "a user without a name");
    }
    return options_.security->authenticate(login);
}

/// Closes a Session whose login was refused; it would count until its time-out.
void Sessions::closeUnused(UA_Server* server, const NodeId& id) const {
    if (sessions_.find(id) == sessions_.end()) {
        ServerCore::of(server).post([server, id] { closeInStack(server, id); });
    }
}

StatusCode Sessions::activate(UA_Server* server, const UA_NodeId& id, const Presented& presented,
                              void** context) {
    const bool is_new = sessions_.find(fromNative(id)) == sessions_.end();
    if (is_new && sessions_.size() >= options_.limits.sessions) {
        closeUnused(server, fromNative(id));
        return status::kBadTooManySessions;
    }
    const auto admission = admit(presented);
    if (!admission) {
        tellRefusal(server, fromNative(id), presented, admission.error());
        closeUnused(server, fromNative(id));
        return refusalOf(admission.error());
    }
    auto& session = sessions_[fromNative(id)];
    if (!session) {
        session = std::make_unique<Session>();
        session->id = fromNative(id);
        by_application_.activated(presented.thumbprint);
        unused_.gone(session->id);
        limitStack(*UA_Server_getConfig(server));
    }
    describe(server, *session);
    session->user = admission->user;
    session->role = admission->role;
    session->thumbprint = presented.thumbprint;
    *context = session.get();
    if (activated_) {
        activated_(*session);
    }
    return status::kGood;
}

void Sessions::tellRefusal(UA_Server* server, const NodeId& id, const Presented& presented,
                           const Error& error) {
    if (!refused_) {
        return;
    }
    Session session;
    session.id = id;
    session.thumbprint = presented.thumbprint;
    describe(server, session);
    const auto* named = decodedAs<const UA_UserNameIdentityToken>(
        presented.token, UA_TYPES[UA_TYPES_USERNAMEIDENTITYTOKEN]);
    session.user = named == nullptr ? std::string() : textFrom(named->userName);
    refused_(session, refusalOf(error), error.message);
}

void Sessions::close(UA_Server* server, const UA_NodeId& id) {
    const auto node = sessions_.extract(fromNative(id));
    unused_.gone(fromNative(id));
    limitStack(*UA_Server_getConfig(server));
    if (node.empty()) {
        Session unused{fromNative(id), {}, {}, {}, {}};
        describe(server, unused);
        by_application_.abandoned(unused.application_uri);
        return;
    }
    by_application_.closed(node.mapped()->thumbprint);
    for (const auto& handler : closed_) {
        handler(*node.mapped());
    }
}

void Sessions::closeIf(UA_Server* server, const std::function<bool(const Session&)>& which) {
    std::vector<NodeId> ids;
    for (const auto& [id, session] : sessions_) {
        if (which(*session)) {
            ids.push_back(id);
        }
    }
    for (const auto& id : ids) {
        closeInStack(server, id);
    }
}

}  // namespace metier::opcua
