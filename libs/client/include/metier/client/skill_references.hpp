#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "metier/opcua/client.hpp"

namespace metier::client {

/// A skill that another skill uses, as published by the server of the using skill.
struct SkillUse {
    std::string endpoint_url;  ///< address of its server; empty: the same server
    std::string name;          ///< BrowseName; empty if it is in the same server
    std::string controller;    ///< BrowseName of its controller; empty: none, or not published
    /// In the publishing server: the skill, or the object with its address
    opcua::NodeId node;
};

/// References of a skill or of a skill type.
struct SkillReferences {
    /// Purposes: BrowseNames of the entries to which HasDictionaryEntry leads. The names are the
    /// entries' identifiers (OPC 10000-19).
    std::vector<std::string> terms;
    std::vector<SkillUse> uses;  ///< targets of UsesSkill, the first 100
};

/// Reads references of skills and types of one server. Text is returned as the server sent it.
///
/// Threads: one at a time, any but the client's own; waits.
///
///     auto reader = ReferenceReader::create(client);
///     if (const auto found = reader->read(skill_node); found) { show(found->terms, found->uses); }
///
/// The client must outlive it. NodeIds of the namespace are looked up once: make a new one after
/// the server was started again.
class ReferenceReader {
public:
    /// A server without the Metier namespace is no error: its skills have no uses then.
    /// Errors: those of the server.
    static opcua::Answer<ReferenceReader> create(opcua::Client& client);

    /// Errors: those of the server.
    opcua::Answer<SkillReferences> read(const opcua::NodeId& node) const;

private:
    ReferenceReader(opcua::Client& client, std::optional<std::uint16_t> metier);

    opcua::Answer<SkillUse> readUse(const opcua::Reference& used) const;

    opcua::Client* client_;
    std::optional<std::uint16_t> metier_;  // index of the Metier namespace; none: no UsesSkill
};

}  // namespace metier::client
