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

/// Driver of a device, and the address of its controller.
struct DriverChoice {
    std::string type;        ///< such as "ur"; `metier drivers` lists them
    std::string controller;  ///< its address, or the name of a virtual controller of the same file
    Settings settings;       ///< settings that only this driver knows
};

/// A tool at the flange of an arm.
struct Tool {
    std::string name;
    /// Tool frame in the flange frame: x, y, z [m] and a, b, c [rad], rotations about x, y, z.
    std::array<double, 6> frame{};
    double mass = 0.0;  ///< [kg]
};

/// An arm behind its own OPC UA server.
struct ArmServer {
    /// The robot's model file, absolute.
    std::filesystem::path model;
    DriverChoice driver;
    /// Driver of the sensor at the arm's flange, for moves that end at a contact; none: no sensor.
    std::optional<DriverChoice> force_torque_sensor;
    /// Short name of the NodeSet that holds the robot's nodes, such as `iiwa`; empty: the server
    /// makes the nodes itself.
    std::string nodeset;
    /// Skills that the server offers, such as `PositionStreamSkill`.
    std::vector<std::string> skills;
    std::vector<Tool> tools;  ///< in addition to the tools of the model
    /// Longest pause between two set-points of a moving stream; a longer one ends the stream [s].
    double stream_silence = 0.15;
    double payload = 0.0;  ///< largest load at the flange [kg]; 0: not known
    /// Files that compose further skills of the server's own skills; absolute paths.
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
    /// Instead of `robot`: uses a robot found by discovery, and another one when that is gone.
    bool discover = false;
    std::optional<double> reach{};    ///< smallest reach of a robot that discovery may choose [m]
    std::optional<double> payload{};  ///< smallest payload of such a robot [kg]
    /// Time that a found robot may be away before another one is used instead [s].
    double rebind_after = 10.0;
};

/// A server that another one uses.
struct UsedServer {
    std::string name;  ///< name of a server of the same cell file, or its address
    std::string url;   ///< empty until the name is resolved
};

/// Skills that files declare, made of skills of other servers.
struct CompositionServer {
    std::vector<std::filesystem::path> files;  ///< absolute
    std::vector<UsedServer> servers;           ///< servers that have the used skills
    bool discover = false;                     ///< uses skills of servers found by discovery, too
    /// Time that a found server may be away before another one is used instead [s].
    double rebind_after = 10.0;
};

/// Ways in which a server is found without a configured address, and finds others.
struct Discovery {
    std::vector<std::string> servers;  ///< addresses of Local Discovery Servers
    double period = 30.0;              ///< time between two registrations at these servers [s]
    bool mdns = false;                 ///< announces the server, and looks for others, by mDNS
    /// Host name or address by which others reach the server if it differs from the listening
    /// address, for example behind a forwarded port; empty: the listening address.
    std::string announce_as;

    /// Reports whether other servers can be looked for: by mDNS or at a discovery server.
    bool enabled() const noexcept { return mdns || !servers.empty(); }
};

/// A skill that moves the arms of several servers together.
struct SynchronizedServer {
    std::vector<UsedServer> servers;  ///< one arm with move skills each; at least two, none twice
    /// Time from the moment when all motions are known until the arms begin [s].
    double start_delay = 0.5;
};

/// Place and extent of the records of executions.
struct Records {
    /// An absolute file path, "sqlite:FILE", "postgresql://..." or "off"; empty: the choice of the
    /// caller that starts the server.
    std::string url;
    double keep_days = 90.0;         ///< age after which records are removed [day]; 0: never
    double keep_megabytes = 2000.0;  ///< largest size of the records [10^6 byte]; 0: no bound
};

/// Address at which a server publishes its metrics by HTTP.
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
    /// Folder for data that must outlive the server's process; empty: no data outlives it. Not a
    /// key of the file: the caller that starts the server sets it.
    std::filesystem::path state_folder;
    /// Longest time without a sign of life of the server's thread; its device is stopped after that
    /// [s].
    double stall_limit = 0.25;
    /// Limits for its clients that differ from the defaults of opcua::ServerLimits.
    std::vector<Limit> limits;
    Discovery discovery;
    Records records;                     ///< the same for all servers of a cell
    std::optional<HttpAddress> metrics;  ///< none: no metrics by HTTP
    /// Kind of server, with the keys that only servers of this kind have.
    std::variant<ArmServer, GripperServer, MoveComponent, CompositionServer, SynchronizedServer>
        kind;

    /// Keys of one kind of server; nullptr if the server is of another kind.
    template <typename Kind>
    const Kind* as() const noexcept {
        return std::get_if<Kind>(&kind);
    }
    template <typename Kind>
    Kind* as() noexcept {
        return std::get_if<Kind>(&kind);
    }
    /// Driver of the server's device; nullptr for the kinds without a device.
    const DriverChoice* driver() const noexcept;
    /// Servers whose skills this one runs; empty for the kinds that run none.
    std::span<const UsedServer> usedServers() const;
    std::span<UsedServer> usedServers();
};

/// A controller without its device, in a process of its own.
struct VirtualController {
    std::string name;
    std::string type;                   ///< such as "ur"
    std::string address;                ///< address of all its ports, such as 127.0.1.1
    std::filesystem::path model;        ///< model file of an arm, absolute; empty for other devices
    std::uint16_t control_port = 7400;  ///< for `metier virtual inject`
    Settings settings;                  ///< settings that only this type of controller knows
};

/// A cell: processes that work together, described by a TOML file (docs/guide/cell.md). Pointers
/// that it returns are valid as long as it is neither changed nor destroyed.
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
    /// Replaces names in a server's configuration by addresses: a virtual controller of this file
    /// by its address, a server by its port. A text that is no name in this file stays unchanged.
    ServerConfig resolved(ServerConfig server) const;
    /// Reports whether no real device can move: each device is simulated or belongs to a virtual
    /// controller of this file, and no server outside of this file is used.
    bool isVirtual() const;
};

/// Parses "HOST:PORT", or "PORT" for 127.0.0.1; an IPv6 address is in brackets.
/// Errors: invalid_argument.
Result<HttpAddress> parseHttpAddress(std::string_view text);

/// Reads and checks a cell file. Relative paths in it are relative to the file.
/// Errors: not_found, invalid_argument with a line "file:line: key: why" for all that is wrong.
Result<CellConfig> loadCell(const std::filesystem::path& file);
/// The same from text. Relative paths in it are relative to the folder of `file`, which need not
/// exist. Errors: invalid_argument.
Result<CellConfig> parseCell(std::string_view text, const std::filesystem::path& file);

}  // namespace metier::cell
