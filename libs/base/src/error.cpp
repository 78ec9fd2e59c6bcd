#include "metier/base/error.hpp"

namespace metier {

std::string_view toString(Errc code) noexcept {
    switch (code) {
        case Errc::invalid_argument:
            return "invalid_argument";
        case Errc::type_mismatch:
            return "type_mismatch";
        case Errc::out_of_range:
            return "out_of_range";
        case Errc::unreachable:
            return "unreachable";
        case Errc::not_found:
            return "not_found";
        case Errc::already_exists:
            return "already_exists";
        case Errc::invalid_state:
            return "invalid_state";
        case Errc::locked:
            return "locked";
        case Errc::resource_unavailable:
            return "resource_unavailable";
        case Errc::access_denied:
            return "access_denied";
        case Errc::timeout:
            return "timeout";
        case Errc::connection_lost:
            return "connection_lost";
        case Errc::execution_lost:
            return "execution_lost";
        case Errc::device_fault:
            return "device_fault";
        case Errc::limit_violated:
            return "limit_violated";
        case Errc::not_supported:
            return "not_supported";
        case Errc::cancelled:
            return "cancelled";
        case Errc::internal:
            return "internal";
    }
    return "unknown";
}

}  // namespace metier
