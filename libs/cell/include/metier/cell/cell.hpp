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
    /// Name of the driver: "ur"; `metier drivers` lists them.
    std::string type;
    /// Address of the controller, or the name of a virtual controller of the same file.
    std::string controller;
    /// Settings that only this driver knows; its open() checks them.
    Settings settings;
};

/// A tool at the flange of an arm.
struct Tool {
    /// Name of the tool frame, by which moves choose it.
    std::string name;
    /// Tool frame in the flange frame: x, y, z [m] and a, b, c [rad], rotations about x, y, z.
    std::array<double, 6> frame{};
    /// Mass [kg]; 0: not known.
    double mass = 0.0;
};

/// An arm behind its own OPC UA server.
struct ArmServer {
    /// The robot's model file, absolute.
    std::filesystem::path model;
    /// Driver of the arm.
    DriverChoice driver;
    /// Driver of the sensor at the arm's flange, for moves that end at a contact; none: no sensor.
    std::optional<DriverChoice> force_torque_sensor;
    /// Short name of the NodeSet that holds the robot's nodes, such as `iiwa`; empty: the server
    /// makes the nodes itself.
    std::string nodeset;
    /// Skills that the server offers, such as `PositionStreamSkill`.
    std::vector<std::string> skills;
    /// Tools in addition to those of the model.
    std::vector<Tool> tools;
    /// Longest pause between two set-points of a moving stream [s]; a longer one ends the stream.
    double stream_silence = 0.15;
    /// Largest load at the flange [kg]; 0: not known.
    double payload = 0.0;
    /// Files that compose further skills of the server's own skills; absolute paths.
    std::vector<std::filesystem::path> compositions;
};

/// A gripper behind its own OPC UA server.
struct GripperServer {
    /// Driver of the gripper.
    DriverChoice driver;
    /// Short name of the NodeSet that holds its nodes, as ArmServer::nodeset.
    std::string nodeset;
    /// Skills that the server offers, as ArmServer::skills.
    std::vector<std::string> skills;
};

/// Move skills over the PositionStreamSkill of another server.
struct MoveComponent {
    /// Name of a server of the same file, or an `opc.tcp://` address. The component reads the arm's
    /// kinematic chain and limits from there. Empty with `discover`.
    std::string robot;
    /// The robot's model file, absolute, for a server that does not publish the chain; empty: none.
    std::filesystem::path model{};
    /// Names of the model's joints in the order of that server's arrays; empty: by the names of its
    /// axes.
    std::vector<std::string> axes{};
    /// Controller of the stream at a server with several arms, by its BrowseName; empty: the server
    /// has one stream.
    std::string controller{};
    /// BrowseName of the arm's motion device, at a server whose stream does not say which one it
    /// moves; with a model only; empty: the only one.
    std::string device{};
    /// Whether it uses a robot found by discovery, and another one when that is gone.
    bool discover = false;
    /// Least reach of a robot that discovery may choose [m]; none: any.
    std::optional<double> reach{};
    /// Least payload of such a robot [kg]; none: any.
    std::optional<double> payload{};
    /// Time that a found robot may be away before another one is used instead [s].
    double rebind_after = 10.0;
};

/// A server that another one uses.
struct UsedServer {
    /// Name of a server of the same cell file, or its address.
    std::string name;
    /// Address "opc.tcp://..."; empty until the name is resolved.
    std::string url;
};

/// A force that a server measures; used skills may end at it.
struct Force {
    /// Name by which composition files call it.
    std::string name;
    /// Name of the server that measures it, one of the used servers.
    std::string server;
    /// NodeId of the force [N], "ns=2;s=Force" or "nsu=urn:lab;s=Force"; empty: the FlangeForce
    /// and FlangeTorque of the server's arm.
    std::string variable;
    /// NodeId of the torque [N m]; empty: none.
    std::string torque;
    /// Name of the used server whose arm carries the sensor; empty: the force is measured along
    /// the axes of the base frame.
    std::string arm;
    /// NodeId of the sensor's frame at that server; empty: the pose of the flange.
    std::string pose;
};

/// Skills that files declare, made of skills of other servers.
struct CompositionServer {
    /// Composition files; absolute paths.
    std::vector<std::filesystem::path> files;
    /// Servers that have the used skills.
    std::vector<UsedServer> servers;
    /// Forces at which used skills may end; names differ.
    std::vector<Force> forces{};
    /// Whether skills of servers found by discovery are used, too.
    bool discover = false;
    /// Time that a found server may be away before another one is used instead [s].
    double rebind_after = 10.0;
};

/// Ways in which a server is found without a configured address, and finds others.
struct Discovery {
    /// Addresses of Local Discovery Servers: "opc.tcp://host:4840".
    std::vector<std::string> servers;
    /// Time between two registrations at these servers [s].
    double period = 30.0;
    /// Whether the server is announced, and others are looked for, by mDNS.
    bool mdns = false;
    /// Host name or address by which others reach the server if it differs from the listening
    /// address, for example behind a forwarded port; empty: the listening address.
    std::string announce_as;

    /// Reports whether other servers can be looked for: by mDNS or at a discovery server.
    bool enabled() const noexcept { return mdns || !servers.empty(); }
};

/// A skill that moves the arms of several servers together.
struct SynchronizedServer {
    /// Servers with one arm with move skills each; at least two, none twice.
    std::vector<UsedServer> servers;
    /// Time from the moment when all motions are known until the arms begin [s].
    double start_delay = 0.5;
};

/// Place and extent of the records of executions.
struct Records {
    /// An absolute file path, "sqlite:FILE", "postgresql://..." or "off"; empty: the choice of the
    /// caller that starts the server.
    std::string url;
    /// Age after which records are removed [day]; 0: never.
    double keep_days = 90.0;
    /// Largest size of the records [10^6 byte]; 0: no bound.
    double keep_megabytes = 2000.0;
};

/// Address at which a server publishes its metrics by HTTP.
struct HttpAddress {
    /// Host name or IP address on which it listens.
    std::string host = "127.0.0.1";
    /// TCP port; 0: a free one.
    std::uint16_t port = 0;
};

/// One process of a cell: one OPC UA server.
struct ServerConfig {
    /// Name of the server, unique in its cell.
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
    /// NodeSet2.xml files with nodes that the server shows besides its own; absolute paths.
    std::vector<std::filesystem::path> nodesets;
    /// Files of skill types that the server declares; absolute paths.
    std::vector<std::filesystem::path> types;
    /// Ways in which it is found, and finds others.
    Discovery discovery;
    /// Place of its records, the same for all servers of a cell.
    Records records;
    /// Address of its metrics by HTTP; none: no metrics.
    std::optional<HttpAddress> metrics;
    /// Kind of server, with the keys that only servers of this kind have.
    std::variant<ArmServer, GripperServer, MoveComponent, CompositionServer, SynchronizedServer>
        kind;

    /// Keys of one kind of server; nullptr if the server is of another kind. Valid as long as
    /// `kind` is not changed.
    template <typename Kind>
    const Kind* as() const noexcept {
        return std::get_if<Kind>(&kind);
    }
    /// The same for a configuration that is changed.
    template <typename Kind>
    Kind* as() noexcept {
        return std::get_if<Kind>(&kind);
    }
    /// Driver of the server's device; nullptr for the kinds without a device.
    const DriverChoice* driver() const noexcept;
    /// Servers whose skills this one runs; empty for the kinds that run none.
    std::span<const UsedServer> usedServers() const;
    /// The same, to fill in the addresses of servers.
    std::span<UsedServer> usedServers();
};

/// A controller without its device, in a process of its own.
struct VirtualController {
    /// Name in the cell file, unique.
    std::string name;
    /// Kind of controller: "ur".
    std::string type;
    /// Address of all its ports: "127.0.1.1".
    std::string address;
    /// Model file of an arm, an absolute path; empty for other devices.
    std::filesystem::path model;
    /// Port for `metier virtual inject`; 0: a free one.
    std::uint16_t control_port = 7400;
    /// Settings that only this type of controller knows.
    Settings settings;
};

/// A cell: processes that work together, described by a TOML file (docs/guide/cell.md). Pointers
/// that it returns are valid as long as it is neither changed nor destroyed:
///
///     auto cell = loadCell("cell.toml");
///     if (const auto* arm = cell->find("arm")) { start(cell->resolved(*arm)); }
struct CellConfig {
    /// Name of the cell, for people.
    std::string name;
    /// File that it was read from.
    std::filesystem::path file;
    /// OPC UA servers, in the order of the file.
    std::vector<ServerConfig> servers;
    /// Controllers without their device, in the order of the file.
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
/// Errors: invalid_argument. Threads: any; pure.
Result<HttpAddress> parseHttpAddress(std::string_view text);

/// Reads and checks a cell file. Relative paths in it are relative to the file. Waits for the disk;
/// nothing is started or connected.
/// Errors: not_found, invalid_argument with a line "file:line: key: why" for all that is wrong.
Result<CellConfig> loadCell(const std::filesystem::path& file);
/// The same from text. Relative paths in it are relative to the folder of `file`, which need not
/// exist. Errors: invalid_argument.
Result<CellConfig> parseCell(std::string_view text, const std::filesystem::path& file);

}  // namespace metier::cell
