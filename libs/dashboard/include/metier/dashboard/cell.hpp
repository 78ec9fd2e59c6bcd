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
    std::string on;  ///< name of the server of the arm that carries it; empty: no arm
    Frame flange_from_jaws{};
};

/// A server to be shown, and what the cell file says of it.
struct CellServer {
    std::string name;  ///< for people, unique; part of the keys of its skills
    std::string url;   ///< "opc.tcp://host:port"
    /// Name of the server whose arm this server's skills move; empty: its own, or the one that the
    /// server publishes.
    std::string arm_of{};
    /// Names of the servers whose skills this server uses, as far as the cell file says.
    std::vector<std::string> uses{};
    std::optional<Frame> world_from_base{};  ///< of its arm; none: not known
    std::optional<GripperMount> gripper{};
};

/// Control port of the virtual controllers' world.
struct CellWorld {
    std::string address;
    std::uint16_t port = 7400;
    /// Table and walls, in the form in which they are sent to browsers
    nlohmann::json fixed = nlohmann::json::object();
};

/// Cell to be shown.
struct Cell {
    std::string name;
    std::vector<CellServer> servers;
    std::optional<CellWorld> world{};
    std::string records{};  ///< as cell::Records::url
};

/// Addresses by name, from the file of `metier up --endpoints`; used instead of those of the cell
/// file.
struct Endpoints {
    std::map<std::string, std::string> servers;
    std::map<std::string, std::string> virtual_controllers;
};

/// Reads the file of `metier up --endpoints`.
/// Errors: not_found, invalid_argument, with the file's name.
Result<Endpoints> loadEndpoints(const std::string& file);

/// Makes the cell from a cell file's content.
/// Threads: any; pure.
Cell cellFrom(const cell::CellConfig& config, const Endpoints& endpoints = {});

}  // namespace metier::dashboard
