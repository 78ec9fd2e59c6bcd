#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "metier/client/skill_finder.hpp"
#include "metier/opcua/client.hpp"

namespace metier::client {

/// Something that a run of a skill cannot have, since its server is of another maker.
enum class Lack {
    /// Parameters and Start are separate requests, and nothing locks the skill's device: another
    /// client may write between them.
    atomic_start,
    /// The server does not stop the skill when the client that started it is lost.
    dead_man,
    /// The server does not publish the arm's state at the rate of its set-points, only as OPC
    /// 40010-1 has it: position by position.
    measured_state,
    /// The server publishes no safety state of the arm.
    safety_state,
};

/// Name for lists and JSON: "atomic start", "dead-man", "measured state at the arm's rate", "safety
/// state". Threads: any; pure.
std::string_view toString(Lack lack) noexcept;
/// "no atomic start, no dead-man"; empty if nothing is missing. Threads: any; pure.
std::string textOf(const std::vector<Lack>& lacks);
/// The same, each with its consequence in brackets. Threads: any; pure.
std::string explanationOf(const std::vector<Lack>& lacks);

/// Reads what a run of the skill cannot have; nothing, for a server of metier.
/// Errors: those of the server, connection_lost, timeout. Threads: any but the client's own; waits.
opcua::Answer<std::vector<Lack>> readLacks(opcua::Client& client, const SkillAddress& skill);

}  // namespace metier::client
