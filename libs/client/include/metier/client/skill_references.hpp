#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "metier/opcua/client.hpp"

namespace metier::client {

/// A skill that another one runs, as the other one's server tells.
struct SkillUse {
    std::string endpoint_url;  ///< of its server; empty: the server that tells
    std::string name;          ///< BrowseName; empty in the server that tells
    std::string controller;    ///< BrowseName of its controller; empty: none, or not told
    opcua::NodeId node;        ///< in the server that tells: the skill, or what tells where it is
};

/// What a skill, or the type of one, refers to.
struct SkillReferences {
    /// What it is for: BrowseNames of the entries to which HasDictionaryEntry leads, which are
    /// their identifiers (OPC 10000-19).
    std::vector<std::string> terms;
    std::vector<SkillUse> uses;  ///< to which UsesSkill leads, the first 100
};

/// Reads references of skills and types of one server. Text is as the server says it.
///
/// Threads: one at a time, any but the client's own; waits.
class ReferenceReader {
public:
    /// Errors: the server's.
    static opcua::Answer<ReferenceReader> create(opcua::Client& client);

    /// Errors: the server's.
    opcua::Answer<SkillReferences> read(const opcua::NodeId& node) const;

private:
    ReferenceReader(opcua::Client& client, std::optional<std::uint16_t> metier);

    opcua::Answer<SkillUse> readUse(const opcua::ReferenceDescription& used) const;

    opcua::Client* client_;
    std::optional<std::uint16_t> metier_;  // index of the Metier namespace; without it no uses
};

}  // namespace metier::client
