#pragma once

#include <open62541/plugin/eventloop.h>
#include <open62541/plugin/log.h>

#include <exception>
#include <new>
#include <type_traits>

#include "loop.hpp"

namespace metier::opcua {

/// The loop as open62541's interfaces see it: C functions that take the mutex and never throw.
struct LoopInterface {
    static void fill(UA_EventLoop& handle);
    static void fill(UA_ConnectionManager& manager, UA_EventLoop& handle);
    static Loop& of(UA_EventLoop* handle);
    static Loop& of(UA_ConnectionManager* manager);
};

/// Runs `work` and turns what it throws into a StatusCode: the only place that does.
/// \param work returns nothing or a StatusCode
template <typename Work>
UA_StatusCode guard(const UA_Logger* logger, Work work) noexcept {
    try {
        if constexpr (std::is_void_v<decltype(work())>) {
            work();
            return UA_STATUSCODE_GOOD;
        } else {
            return work();
        }
    } catch (const std::bad_alloc&) {
        return UA_STATUSCODE_BADOUTOFMEMORY;
    } catch (const std::exception& error) {
        UA_LOG_ERROR(logger, UA_LOGCATEGORY_EVENTLOOP, "The event loop failed: %s", error.what());
    } catch (...) {
        UA_LOG_ERROR(logger, UA_LOGCATEGORY_EVENTLOOP,
                     "The event loop failed for no stated reason");
    }
    return UA_STATUSCODE_BADINTERNALERROR;
}

}  // namespace metier::opcua
