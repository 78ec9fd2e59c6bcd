#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/cell/limits.hpp"
#include "metier/cell/settings.hpp"

namespace metier::cell {

/// Which driver talks to a device, and where its controller is.
struct DriverChoice {
    std::string type;        ///< as "ur"; the command's `drivers` lists them
    std::string controller;  ///< an address, or the name of a virtual controller of the same file
    Settings settings;       ///< the driver's own
};

/// A tool at the flange of an arm.
struct Tool {
    std::string name;
    /// In the flange frame: x, y, z [m], a, b, c [rad], rotations about x, y, z.
    std::array<double, 6> frame{};
    double mass = 0.0;  ///< [kg]
};

/// An arm behind its own OPC UA server.
struct ArmServer {
    /// The robot's model file, absolute.
    std::filesystem::path model;
    DriverChoice driver;
    /// Of its flange, for moves that end at a contact.
    std::optional<DriverChoice> force_torque_sensor;
    /// Short name of the NodeSet that holds the robot's instances, such as `iiwa`; empty: the
    /// server makes them.
    std::string nodeset;
    /// Skills that the server offers, such as `PositionStreamSkill`.
    std::vector<std::string> skills;
    std::vector<Tool> tools;  ///< besides those of the model
    /// Silence of a moving stream that ends it [s].
    double stream_silence = 0.15;
    double payload = 0.0;  ///< what it may carry at its flange [kg]; 0: nobody says
    /// Files with skills made of the server's own; absolute.
    std::vector<std::filesystem::path> compositions;
};

/// A gripper behind its own OPC UA server.
struct GripperServer {
    DriverChoice driver;
    std::string nodeset;              ///< as ArmServer::nodeset
    std::vector<std::string> skills;  ///< as ArmServer::skills
};

/// Move skills over the PositionStreamSkill of another server.
struct MoveComponent {
    /// Name of a server of the same file, or an `opc.tcp://` address.
    /// The component reads the arm's kinematic chain and limits from there.
    std::string robot;
    /// Instead, whatever robot discovery tells of, and another one when that is gone.
    bool discover = false;
    std::optional<double> reach{};    ///< least of a robot that is found [m]
    std::optional<double> payload{};  ///< least of a robot that is found [kg]
    /// How long a robot that was found may be away before another one is used instead [s].
    double rebind_after = 10.0;
};

/// A server that another one uses.
struct UsedServer {
    std::string name;  ///< of a server of the same cell file, or the address
    std::string url;   ///< empty until the name is resolved
};

/// Skills that files declare, made of skills of other servers.
struct CompositionServer {
    std::vector<std::filesystem::path> files;  ///< absolute
    std::vector<UsedServer> servers;           ///< where the used skills are
    bool discover = false;                     ///< also at whatever servers discovery tells of
    /// How long a server that was found may be away before another one is used instead [s].
    double rebind_after = 10.0;
};

/// How others find a server without being told its address.
struct Discovery {
    std::vector<std::string> servers;  ///< addresses of Local Discovery Servers
    double period = 30.0;              ///< between its registrations there [s]
    bool mdns = false;                 ///< announced, and others sought, by mDNS
    /// Host by which others reach the server where that is not its listening address, as behind a
    /// forwarded port; empty: its address.
    std::string announce_as;

    /// Whether there is anybody to ask for other servers.
    bool enabled() const noexcept { return mdns || !servers.empty(); }
};

/// A skill that moves the arms of several servers together.
struct SynchronizedServer {
    std::vector<UsedServer> servers;  ///< one arm with move skills each; at least two, none twice
    /// From when all is known until the arms begin [s].
    double start_delay = 0.5;
};

/// Where what the servers do is recorded.
struct Records {
    /// A file, absolute, "sqlite:FILE", "postgresql://..." or "off"; empty: as whoever starts a
    /// server says.
    std::string url;
    double keep_days = 90.0;         ///< 0: for ever
    double keep_megabytes = 2000.0;  ///< [10^6 byte]; 0: without bound
};

/// Where a server tells its figures by HTTP.
struct HttpAddress {
    std::string host = "127.0.0.1";
    std::uint16_t port = 0;  ///< 0: a free one
};

/// One process of a cell: one OPC UA server.
struct ServerConfig {
    std::string name;
    /// TCP port; 0 takes a free one.
    std::uint16_t port = 0;
    /// Address to listen on. Without security only loopback addresses are accepted.
    std::string address;
    /// Sends notifications of events at once instead of at the publishing interval.
    bool publish_at_once = true;
    /// Where the server keeps what outlives it; empty: nothing does. Not of the file: whoever
    /// starts the server says it.
    std::filesystem::path state_folder;
    /// Longest time without a sign of life of the server's thread; then its device is stopped [s].
    double stall_limit = 0.25;
    /// Limits for its clients that are not as opcua::ServerLimits has them.
    std::vector<Limit> limits;
    Discovery discovery;
    Records records;                     ///< of the cell
    std::optional<HttpAddress> metrics;  ///< none: it does not
    /// Kind of server, with the keys that only servers of this kind have.
    std::variant<ArmServer, GripperServer, MoveComponent, CompositionServer, SynchronizedServer>
        kind;

    /// The part of one kind; nullptr if the server is of another one.
    template <typename Kind>
    const Kind* as() const noexcept {
        return std::get_if<Kind>(&kind);
    }
    template <typename Kind>
    Kind* as() noexcept {
        return std::get_if<Kind>(&kind);
    }
    /// Driver of its device; nullptr for the kinds that have none.
    const DriverChoice* driver() const noexcept;
    /// Servers whose skills this one runs; empty for the kinds that run none.
    std::span<const UsedServer> usedServers() const;
    std::span<UsedServer> usedServers();
};

/// A controller without its device, in a process of its own.
struct VirtualController {
    std::string name;
    std::string type;                   ///< as "ur"
    std::string address;                ///< of all its ports, as 127.0.1.1
    std::filesystem::path model;        ///< of an arm, absolute; empty for other devices
    std::uint16_t control_port = 7400;  ///< for `metier virtual inject`
    Settings settings;                  ///< the controller's own
};

/// A cell: the processes that work together, as a TOML file describes them (docs/guide/cell.md).
struct CellConfig {
    std::string name;
    std::filesystem::path file;
    std::vector<ServerConfig> servers;
    std::vector<VirtualController> virtual_controllers;

    /// The server of that name, or nullptr.
    const ServerConfig* find(const std::string& server) const;
    /// The virtual controller of that name, or nullptr.
    const VirtualController* findVirtual(const std::string& controller) const;
    /// The world of the virtual controllers, or nullptr.
    const VirtualController* world() const;
    /// A server of the cell with the addresses of what it names: virtual controllers of this file
    /// by their own, servers by their port. Whatever is no name in this file stays as it is.
    ServerConfig resolved(ServerConfig server) const;
    /// Whether nothing real can move: each device is simulated or behind a virtual controller of
    /// this file, and no skill of a server outside of the file is used.
    bool isVirtual() const;
};

/// "HOST:PORT" or "PORT", which is one of 127.0.0.1; an IPv6 address in brackets.
/// Errors: invalid_argument.
Result<HttpAddress> parseHttpAddress(std::string_view text);

/// Reads and checks a cell file. Relative paths in it are relative to the file.
/// Errors: not_found, invalid_argument with a line "file:line: key: why" for all that is wrong.
Result<CellConfig> loadCell(const std::filesystem::path& file);
/// The same from text; `file` says where relative paths in it begin. Errors: invalid_argument.
Result<CellConfig> parseCell(std::string_view text, const std::filesystem::path& file);

}  // namespace metier::cell
