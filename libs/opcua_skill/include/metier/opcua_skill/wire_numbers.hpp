#pragma once

#include <cstdint>

#include "metier/opcua/node_id.hpp"
#include "metier/skill/state.hpp"

namespace metier::opcua_skill {

/// Node of a state in ProgramStateMachineType (OPC 10000-10, table 4). Threads: any; pure.
opcua::NodeId stateId(skill::State state);
/// Node of a transition in ProgramStateMachineType (OPC 10000-10, table 5). Threads: any; pure.
opcua::NodeId transitionId(skill::TransitionNumber number);

/// Status that the Methods of a device's lock return (OPC 10000-100, 7.6: InitLockStatus and its
/// like). A server may return other negative numbers; they are refusals too.
enum class LockStatus : std::int32_t {
    /// Done.
    done = 0,
    /// The device is locked already, or, for RenewLock and ExitLock, not by this session.
    refused = -1,
};

}  // namespace metier::opcua_skill
