#pragma once

#include <open62541/types.h>

#include <exception>
#include <new>
#include <string_view>

namespace metier::opcua {

/// Runs what a callback of the stack does; an exception becomes a StatusCode here and nowhere
/// else, since none may pass through C.
template <typename Work>
UA_StatusCode guarded(Work&& work) noexcept {
    try {
        return work();
    } catch (const std::bad_alloc&) {
        return UA_STATUSCODE_BADOUTOFMEMORY;
    } catch (...) {
        return UA_STATUSCODE_BADINTERNALERROR;
    }
}

}  // namespace metier::opcua
