#include "metier/opcua/status_code.hpp"

#include <fmt/format.h>
#include <open62541/types.h>

#include <algorithm>
#include <array>

namespace metier::opcua {

namespace {

struct Entry {
    Errc errc;
    UA_StatusCode status;
};

/// The first entry of a code or status is the one used in its direction. Further codes that a
/// peer's stack may return follow those that metier sends.
constexpr std::array kTable{
    Entry{Errc::invalid_argument, UA_STATUSCODE_BADINVALIDARGUMENT},
    Entry{Errc::type_mismatch, UA_STATUSCODE_BADTYPEMISMATCH},
    Entry{Errc::out_of_range, UA_STATUSCODE_BADOUTOFRANGE},
    Entry{Errc::unreachable, UA_STATUSCODE_BADOUTOFRANGE},
    Entry{Errc::not_found, UA_STATUSCODE_BADNOTFOUND},
    Entry{Errc::already_exists, UA_STATUSCODE_BADNODEIDEXISTS},
    Entry{Errc::invalid_state, UA_STATUSCODE_BADINVALIDSTATE},
    Entry{Errc::locked, UA_STATUSCODE_BADLOCKED},
    Entry{Errc::resource_unavailable, UA_STATUSCODE_BADRESOURCEUNAVAILABLE},
    Entry{Errc::access_denied, UA_STATUSCODE_BADUSERACCESSDENIED},
    Entry{Errc::timeout, UA_STATUSCODE_BADTIMEOUT},
    Entry{Errc::connection_lost, UA_STATUSCODE_BADNOCOMMUNICATION},
    Entry{Errc::execution_lost, UA_STATUSCODE_BADDATALOST},
    Entry{Errc::device_fault, UA_STATUSCODE_BADDEVICEFAILURE},
    Entry{Errc::limit_violated, UA_STATUSCODE_BADOUTOFRANGE},
    Entry{Errc::not_supported, UA_STATUSCODE_BADNOTSUPPORTED},
    Entry{Errc::cancelled, UA_STATUSCODE_BADREQUESTCANCELLEDBYCLIENT},
    Entry{Errc::internal, UA_STATUSCODE_BADINTERNALERROR},

    Entry{Errc::invalid_argument, UA_STATUSCODE_BADARGUMENTSMISSING},
    Entry{Errc::invalid_argument, UA_STATUSCODE_BADTOOMANYARGUMENTS},
    Entry{Errc::invalid_argument, UA_STATUSCODE_BADMETHODINVALID},
    Entry{Errc::not_found, UA_STATUSCODE_BADNODEIDUNKNOWN},
    Entry{Errc::not_found, UA_STATUSCODE_BADNOMATCH},
    Entry{Errc::not_found, UA_STATUSCODE_BADPARENTNODEIDINVALID},
    Entry{Errc::not_found, UA_STATUSCODE_BADSOURCENODEIDINVALID},
    Entry{Errc::not_found, UA_STATUSCODE_BADTARGETNODEIDINVALID},
    Entry{Errc::not_found, UA_STATUSCODE_BADTYPEDEFINITIONINVALID},
    Entry{Errc::not_found, UA_STATUSCODE_BADREFERENCETYPEIDINVALID},
    Entry{Errc::already_exists, UA_STATUSCODE_BADDUPLICATEREFERENCENOTALLOWED},
    Entry{Errc::already_exists, UA_STATUSCODE_BADBROWSENAMEDUPLICATED},
    Entry{Errc::invalid_argument, UA_STATUSCODE_BADNODECLASSINVALID},
    Entry{Errc::not_supported, UA_STATUSCODE_BADWRITENOTSUPPORTED},
    Entry{Errc::invalid_state, UA_STATUSCODE_BADSTATENOTACTIVE},
    Entry{Errc::invalid_state, UA_STATUSCODE_BADNOTEXECUTABLE},
    Entry{Errc::access_denied, UA_STATUSCODE_BADNOTWRITABLE},
    Entry{Errc::access_denied, UA_STATUSCODE_BADIDENTITYTOKENREJECTED},
    Entry{Errc::access_denied, UA_STATUSCODE_BADSECURITYCHECKSFAILED},
    Entry{Errc::access_denied, UA_STATUSCODE_BADCERTIFICATEUNTRUSTED},
    Entry{Errc::resource_unavailable, UA_STATUSCODE_BADTOOMANYSESSIONS},
    Entry{Errc::resource_unavailable, UA_STATUSCODE_BADOUTOFMEMORY},
    Entry{Errc::timeout, UA_STATUSCODE_BADREQUESTTIMEOUT},
    Entry{Errc::connection_lost, UA_STATUSCODE_BADCOMMUNICATIONERROR},
    Entry{Errc::connection_lost, UA_STATUSCODE_BADSHUTDOWN},
    Entry{Errc::connection_lost, UA_STATUSCODE_BADSERVERNOTCONNECTED},
    Entry{Errc::connection_lost, UA_STATUSCODE_BADSESSIONIDINVALID},
    Entry{Errc::connection_lost, UA_STATUSCODE_BADSESSIONCLOSED},
    Entry{Errc::connection_lost, UA_STATUSCODE_BADSESSIONNOTACTIVATED},
    Entry{Errc::connection_lost, UA_STATUSCODE_BADSECURECHANNELCLOSED},
    Entry{Errc::connection_lost, UA_STATUSCODE_BADNOTCONNECTED},
    Entry{Errc::connection_lost, UA_STATUSCODE_BADCONNECTIONREJECTED},
    Entry{Errc::connection_lost, UA_STATUSCODE_BADDISCONNECT},
    Entry{Errc::connection_lost, UA_STATUSCODE_BADCONNECTIONCLOSED},
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
    return found == kTable.end() ? status::kBadInternalError : StatusCode(found->status);
}

Errc errcFrom(StatusCode code) noexcept {
    const auto* found = std::find_if(kTable.begin(), kTable.end(), [code](const Entry& entry) {
        return entry.status == code.value();
    });
    return found == kTable.end() ? Errc::internal : found->errc;
}

Error errorFrom(StatusCode code, std::string_view doing) {
    return {errcFrom(code), fmt::format("{}: {}", doing, code.name())};
}

}  // namespace metier::opcua
