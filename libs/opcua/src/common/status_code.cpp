#include "metier/opcua/status_code.hpp"

#include <fmt/format.h>
#include <open62541/types.h>

#include <algorithm>
#include <array>

namespace metier::opcua {

namespace {

struct Entry {
    Errc errc;
    StatusCode status;
};

/// The first entry of a code or status is the one used in its direction.
constexpr std::array kTable{
    Entry{Errc::invalid_argument, status::kBadInvalidArgument},
    Entry{Errc::type_mismatch, status::kBadTypeMismatch},
    Entry{Errc::out_of_range, status::kBadOutOfRange},
    Entry{Errc::unreachable, status::kBadOutOfRange},
    Entry{Errc::not_found, status::kBadNotFound},
    Entry{Errc::already_exists, status::kBadNodeIdExists},
    Entry{Errc::invalid_state, status::kBadInvalidState},
    Entry{Errc::locked, status::kBadLocked},
    Entry{Errc::resource_unavailable, status::kBadResourceUnavailable},
    Entry{Errc::access_denied, status::kBadUserAccessDenied},
    Entry{Errc::timeout, status::kBadTimeout},
    Entry{Errc::connection_lost, status::kBadNoCommunication},
    Entry{Errc::execution_lost, status::kBadDataLost},
    Entry{Errc::device_fault, status::kBadDeviceFailure},
    Entry{Errc::limit_violated, status::kBadOutOfRange},
    Entry{Errc::not_supported, status::kBadNotSupported},
    Entry{Errc::cancelled, status::kBadRequestCancelledByClient},
    Entry{Errc::internal, status::kBadInternalError},
};

/// Further codes that a peer's stack may return.
constexpr std::array kFromStack{
    Entry{Errc::invalid_argument, status::kBadArgumentsMissing},
    Entry{Errc::invalid_argument, status::kBadTooManyArguments},
    Entry{Errc::invalid_argument, status::kBadMethodInvalid},
    Entry{Errc::not_found, status::kBadNodeIdUnknown},
    Entry{Errc::not_found, status::kBadNoMatch},
    Entry{Errc::not_found, status::kBadParentNodeIdInvalid},
    Entry{Errc::not_found, status::kBadSourceNodeIdInvalid},
    Entry{Errc::not_found, status::kBadTargetNodeIdInvalid},
    Entry{Errc::not_found, status::kBadTypeDefinitionInvalid},
    Entry{Errc::not_found, status::kBadReferenceTypeIdInvalid},
    Entry{Errc::already_exists, status::kBadDuplicateReferenceNotAllowed},
    Entry{Errc::already_exists, status::kBadBrowseNameDuplicated},
    Entry{Errc::invalid_argument, status::kBadNodeClassInvalid},
    Entry{Errc::not_supported, status::kBadWriteNotSupported},
    Entry{Errc::invalid_state, status::kBadStateNotActive},
    Entry{Errc::invalid_state, status::kBadNotExecutable},
    Entry{Errc::access_denied, status::kBadNotWritable},
    Entry{Errc::access_denied, status::kBadIdentityTokenRejected},
    Entry{Errc::access_denied, status::kBadSecurityChecksFailed},
    Entry{Errc::access_denied, status::kBadCertificateUntrusted},
    Entry{Errc::resource_unavailable, status::kBadTooManySessions},
    Entry{Errc::resource_unavailable, status::kBadOutOfMemory},
    Entry{Errc::timeout, status::kBadRequestTimeout},
    Entry{Errc::connection_lost, status::kBadCommunicationError},
    Entry{Errc::connection_lost, status::kBadShutdown},
    Entry{Errc::connection_lost, status::kBadServerNotConnected},
    Entry{Errc::connection_lost, status::kBadSessionIdInvalid},
    Entry{Errc::connection_lost, status::kBadSessionClosed},
    Entry{Errc::connection_lost, status::kBadSessionNotActivated},
    Entry{Errc::connection_lost, status::kBadSecureChannelClosed},
    Entry{Errc::connection_lost, status::kBadNotConnected},
    Entry{Errc::connection_lost, status::kBadConnectionRejected},
    Entry{Errc::connection_lost, status::kBadDisconnect},
    Entry{Errc::connection_lost, status::kBadConnectionClosed},
};

}  // namespace

std::string StatusCode::name() const {
    const std::string_view known = UA_StatusCode_name(value_);
    const bool unknown = known.empty() || known.starts_with("Unknown");
    return unknown ? fmt::format("0x{:08X}", value_) : std::string(known);
}

StatusCode statusFrom(Errc code) noexcept {
    const auto* found = std::find_if(kTable.begin(), kTable.end(),
                                     [code](const Entry& entry) { return entry.errc == code; });
    return found == kTable.end() ? status::kBadInternalError : found->status;
}

Errc errcFrom(StatusCode code) noexcept {
    const auto matches = [code](const Entry& entry) { return entry.status == code; };
    const auto* ours = std::find_if(kTable.begin(), kTable.end(), matches);
    if (ours != kTable.end()) {
        return ours->errc;
    }
    const auto* stack = std::find_if(kFromStack.begin(), kFromStack.end(), matches);
    return stack == kFromStack.end() ? Errc::internal : stack->errc;
}

Error errorFrom(StatusCode code, std::string_view doing) {
    return {errcFrom(code), fmt::format("{}: {}", doing, code.name())};
}

}  // namespace metier::opcua
