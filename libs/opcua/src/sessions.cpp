#include "sessions.hpp"

#include <algorithm>

#include "convert.hpp"
#include "guard.hpp"
#include "metier/trust/certificate.hpp"

namespace metier::opcua {

namespace {

constexpr std::uint8_t kAllAccess = 0xFF;

/// Takes the same time wherever the first difference is.
bool samePassword(std::string_view left, std::string_view right) noexcept {
    unsigned difference = left.size() == right.size() ? 0U : 1U;
    for (std::size_t i = 0; i < std::min(left.size(), right.size()); ++i) {
        difference |= static_cast<unsigned char>(left[i]) ^ static_cast<unsigned char>(right[i]);
    }
    return difference == 0;
}

template <typename Native>
const Native* decodedAs(const UA_ExtensionObject& token, const UA_DataType& type) noexcept {
    const bool decoded = token.encoding == UA_EXTENSIONOBJECT_DECODED ||
                         token.encoding == UA_EXTENSIONOBJECT_DECODED_NODELETE;
    return decoded && token.content.decoded.type == &type
               ? static_cast<const Native*>(token.content.decoded.data)
               : nullptr;
}

bool isAbsent(const UA_ExtensionObject& token) noexcept {
    return token.encoding == UA_EXTENSIONOBJECT_ENCODED_NOBODY;
}

void addTokenPolicy(UA_AccessControl& control, UA_UserTokenType type, std::string_view id) {
    UA_UserTokenPolicy policy{};
    policy.tokenType = type;
    policy.policyId = viewOf(id);
    checkAllocated(UA_Array_appendCopy(
        reinterpret_cast<void**>(&control.userTokenPolicies),  // NOLINT(*-reinterpret-cast)
        &control.userTokenPoliciesSize, &policy, &UA_TYPES[UA_TYPES_USERTOKENPOLICY]));
}

UA_NodeId idOf(const Session& session) noexcept {
    return viewOf(session.id);
}

void describe(UA_Server* server, Session& session) {
    const UA_NodeId id = idOf(session);
    UA_ApplicationDescription client{};
    if (UA_Server_getSessionAttribute_scalar(
            server, &id, UA_QualifiedName{0, viewOf("clientDescription")},
            &UA_TYPES[UA_TYPES_APPLICATIONDESCRIPTION], &client) == UA_STATUSCODE_GOOD) {
        session.application_uri = textFrom(client.applicationUri);
        session.application_name = textFrom(client.applicationName.text);
    }
    UA_String name{};
    if (UA_Server_getSessionAttribute_scalar(
            server, &id, UA_QualifiedName{0, viewOf("sessionName")}, &UA_TYPES[UA_TYPES_STRING],
            &name) == UA_STATUSCODE_GOOD) {
        session.name = textFrom(name);
    }
}

}  // namespace

/// What the stack calls. It passes the session's context, which is ours or null.
struct Sessions::Callbacks {
    static Sessions& owner(UA_AccessControl* control) noexcept {
        return *static_cast<Sessions*>(control->context);
    }
    static UA_StatusCode activate(UA_Server* server, UA_AccessControl* control,
                                  const UA_EndpointDescription* /*endpoint*/,
                                  const UA_ByteString* certificate, const UA_NodeId* id,
                                  const UA_ExtensionObject* token, void** context) noexcept {
        return guarded([&] {
            const auto thumbprint = certificate == nullptr || certificate->length == 0
                                        ? std::string()
                                        : trust::thumbprintOf(bytesOf(*certificate));
            return owner(control).activate(server, *id, {*token, thumbprint}, context).value();
        });
    }
    static void close(UA_Server* /*server*/, UA_AccessControl* control, const UA_NodeId* id,
                      void* /*context*/) noexcept {
        guarded([&]() -> UA_StatusCode {
            owner(control).close(*id);
            return UA_STATUSCODE_GOOD;
        });
    }
    static void clear(UA_AccessControl* control) noexcept {
        UA_Array_delete(control->userTokenPolicies, control->userTokenPoliciesSize,
                        &UA_TYPES[UA_TYPES_USERTOKENPOLICY]);
        control->userTokenPolicies = nullptr;
        control->userTokenPoliciesSize = 0;
    }
    static UA_Boolean sameUser(UA_Server* /*server*/, UA_AccessControl* control,
                               const UA_NodeId* /*old_id*/, void* old_context,
                               const UA_NodeId* /*new_id*/, void* new_context) noexcept {
        const auto& sessions = owner(control);
        return new_context != nullptr &&
               (old_context == nullptr ||
                sessions.of(old_context).user == sessions.of(new_context).user);
    }
};

Sessions::Sessions(const ServerOptions& options) : options_(options) {}

void Sessions::install(UA_ServerConfig& config) {
    UA_AccessControl& control = config.accessControl;
    control.context = this;
    control.clear = Callbacks::clear;
    control.activateSession = Callbacks::activate;
    control.closeSession = Callbacks::close;
    control.allowTransferSubscription = Callbacks::sameUser;
    control.getUserRightsMask = [](auto...) -> UA_UInt32 { return 0; };
    control.getUserAccessLevel = [](auto...) -> UA_Byte { return kAllAccess; };
    control.getUserExecutableOnObject = [](auto...) -> UA_Boolean { return true; };
    control.allowBrowseNode = [](auto...) -> UA_Boolean { return true; };
    control.allowAddNode = [](auto...) -> UA_Boolean { return false; };
    control.allowAddReference = [](auto...) -> UA_Boolean { return false; };
    control.allowDeleteNode = [](auto...) -> UA_Boolean { return false; };
    control.allowDeleteReference = [](auto...) -> UA_Boolean { return false; };
    control.allowHistoryUpdateUpdateData = [](auto...) -> UA_Boolean { return false; };
    control.allowHistoryUpdateDeleteRawModified = [](auto...) -> UA_Boolean { return false; };
    if (!options_.security) {
        addTokenPolicy(control, UA_USERTOKENTYPE_ANONYMOUS, "anonymous");
    }
    if (options_.security || !options_.users.empty()) {
        addTokenPolicy(control, UA_USERTOKENTYPE_USERNAME, "username");
        config.allowNonePolicyPassword = !options_.security;
    }
}

const Session& Sessions::of(const void* context) const noexcept {
    return context == nullptr ? server_session_ : *static_cast<const Session*>(context);
}

Result<std::string> Sessions::userOf(const Presented& presented) const {
    const auto& token = presented.token;
    if (isAbsent(token) || decodedAs<UA_AnonymousIdentityToken>(
                               token, UA_TYPES[UA_TYPES_ANONYMOUSIDENTITYTOKEN]) != nullptr) {
        return options_.security ? fail(Errc::access_denied, "nobody is let in without a name")
                                 : Result<std::string>("");
    }
    const auto* named =
        decodedAs<UA_UserNameIdentityToken>(token, UA_TYPES[UA_TYPES_USERNAMEIDENTITYTOKEN]);
    if (named == nullptr) {
        return fail(Errc::not_supported, "a kind of identity this server does not know");
    }
    const Login login{textFrom(named->userName), textFrom(named->password), presented.thumbprint};
    const auto known = authenticate(login);
    return known ? Result<std::string>(login.user) : fail(known.error());
}

Result<void> Sessions::authenticate(const Login& login) const {
    if (options_.security) {
        return options_.security->authenticate(login);
    }
    const auto& users = options_.users;
    const bool known = std::any_of(users.begin(), users.end(), [&](const UserPassword& entry) {
        return entry.user == login.user && samePassword(entry.password, login.password);
    });
    return known ? Result<void>() : fail(Errc::access_denied, "unknown user or wrong password");
}

StatusCode Sessions::activate(UA_Server* server, const UA_NodeId& id, const Presented& presented,
                              void** context) {
    const auto user = userOf(presented);
    if (!user) {
        return user.error().code == Errc::not_supported ? status::kBadIdentityTokenInvalid
                                                        : status::kBadUserAccessDenied;
    }
    auto& session = sessions_[fromNative(id)];
    if (!session) {
        session = std::make_unique<Session>();
        session->id = fromNative(id);
    }
    describe(server, *session);
    session->user = *user;
    session->thumbprint = presented.thumbprint;
    *context = session.get();
    if (activated_) {
        activated_(*session);
    }
    return status::kGood;
}

void Sessions::close(const UA_NodeId& id) {
    const auto node = sessions_.extract(fromNative(id));
    if (node.empty()) {
        return;
    }
    for (const auto& handler : closed_) {
        handler(*node.mapped());
    }
}

void Sessions::closeAll(UA_Server* server) {
    std::vector<NodeId> ids;
    for (const auto& [id, session] : sessions_) {
        ids.push_back(id);
    }
    for (const auto& id : ids) {
        const UA_NodeId native = viewOf(id);
        UA_Server_closeSession(server, &native);
    }
}

}  // namespace metier::opcua
