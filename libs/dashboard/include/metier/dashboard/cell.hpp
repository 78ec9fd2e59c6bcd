#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "metier/base/quantities.hpp"
#include "metier/cell/cell.hpp"

namespace metier::dashboard {

/// Mount of a gripper, as given by the world of the virtual controllers.
struct GripperMount {
    /// Name of the server of the arm that carries it; empty: no arm.
    std::string on;
    /// Place of the jaws on the flange [m, rad].
    Frame flange_from_jaws{};
};

/// A server to be shown, and what the cell file says of it.
/// Names refer to servers of the same Cell.
struct CellServer {
    /// Name for people, unique; part of the keys of its skills.
    std::string name;
    /// Address: "opc.tcp://host:port".
    std::string url;
    /// Name of the server whose arm this server's skills move; empty: its own, or the one that the
    /// server publishes.
    std::string arm_of{};
    /// Names of the servers whose skills this server uses, as far as the cell file says.
    std::vector<std::string> uses{};
    /// Place of its arm's base in the world [m, rad]; none: not known.
    std::optional<Frame> world_from_base{};
    /// Mount of its gripper; none: it has none, or it is not known.
    std::optional<GripperMount> gripper{};
};

/// Control port of the virtual controllers' world.
struct CellWorld {
    /// IP address of its process.
    std::string address;
    /// TCP port; 7400 unless the cell file says otherwise.
    std::uint16_t port = 7400;
    /// Table and walls, in the form in which they are sent to browsers
    nlohmann::json fixed = nlohmann::json::object();
};

/// Cell to be shown.
struct Cell {
    /// Name of the cell, for people.
    std::string name;
    /// Servers to be shown, in this order.
    std::vector<CellServer> servers;
    /// World of the virtual controllers; none: there is none.
    std::optional<CellWorld> world{};
    /// Place of the servers' records, as cell::Records::url.
    std::string records{};
};

/// Addresses by name, from the file of `metier up --endpoints`; used instead of those of the cell
/// file.
/// A name that is missing here keeps its address of the cell file.
struct Endpoints {
    /// Addresses "opc.tcp://..." by the servers' names.
    std::map<std::string, std::string> servers;
    /// IP addresses by the virtual controllers' names.
    std::map<std::string, std::string> virtual_controllers;
};

/// Reads the file of `metier up --endpoints`. Waits for the disk.
/// Errors: not_found, invalid_argument, with the file's name.
Result<Endpoints> loadEndpoints(const std::string& file);

/// Makes the cell from a cell file's content.
/// Threads: any; pure.
Cell cellFrom(const cell::CellConfig& config, const Endpoints& endpoints = {});

}  // namespace metier::dashboard
