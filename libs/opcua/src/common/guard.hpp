#pragma once

#include <open62541/types.h>

#include <exception>
#include <new>
#include <type_traits>

namespace metier::opcua {

/// Runs what a callback of the stack does; an exception becomes a StatusCode here and nowhere
/// else, since none may pass through C.
/// \param work returns nothing or a StatusCode
template <typename Work>
UA_StatusCode guarded(Work&& work) noexcept {
    try {
        if constexpr (std::is_void_v<std::invoke_result_t<Work&>>) {
            work();
            return UA_STATUSCODE_GOOD;
        } else {
            return work();
        }
    } catch (const std::bad_alloc&) {
        return UA_STATUSCODE_BADOUTOFMEMORY;
    } catch (...) {
        return UA_STATUSCODE_BADINTERNALERROR;
    }
}

}  // namespace metier::opcua
