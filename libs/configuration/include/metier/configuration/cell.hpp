#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "metier/base/error.hpp"

namespace metier::configuration {

/// An arm behind its own OPC UA server.
struct ArmServer {
    /// The robot's model file, absolute.
    std::filesystem::path model;
    /// Short name of the NodeSet that holds the robot's instances, such as `iiwa`.
    std::string nodeset;
    /// Skills that the server offers, such as `PositionStreamSkill`; all are in its NodeSet.
    std::vector<std::string> skills;
    /// Silence of a moving stream that ends it [s].
    double stream_silence = 0.15;
};

/// Move skills over the PositionStreamSkill of another server.
struct MoveComponent {
    /// Name of a server of the same file, or an `opc.tcp://` address.
    /// The component reads the arm's kinematic chain and limits from there.
    std::string robot;
};

enum class ServerKind { arm, move };

/// One process of a cell: one OPC UA server.
struct ServerConfig {
    std::string name;
    ServerKind kind = ServerKind::arm;
    /// TCP port; 0 takes a free one.
    std::uint16_t port = 0;
    /// Address to listen on. Without security only loopback addresses are accepted.
    std::string address;
    /// Sends notifications of events at once instead of at the publishing interval.
    bool publish_at_once = true;
    ArmServer arm;       ///< for ServerKind::arm
    MoveComponent move;  ///< for ServerKind::move
};

/// A cell: the processes that work together, as a TOML file describes them (docs/guide/cell.md).
struct CellConfig {
    std::string name;
    std::filesystem::path file;
    std::vector<ServerConfig> servers;

    /// The server of that name, or nullptr.
    const ServerConfig* find(const std::string& server) const;
};

/// Reads and checks a cell file. Relative paths in it are relative to the file.
/// Errors: not_found, invalid_argument with a line "file:line: key: why" for all that is wrong.
Result<CellConfig> loadCell(const std::filesystem::path& file);

}  // namespace metier::configuration
