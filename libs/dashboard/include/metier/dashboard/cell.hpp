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

/// Where a gripper is, as the world of the virtual controllers has it.
struct GripperMount {
    std::string on;  ///< name of the server of the arm that carries it; empty: of none
    Frame flange_from_jaws{};
};

/// A server to be shown, and what is known of it besides what it tells.
struct CellServer {
    std::string name;  ///< for people, unique; part of the keys of its skills
    std::string url;   ///< "opc.tcp://host:port"
    /// Name of the server whose arm this one's skills move; empty: its own, or as it tells.
    std::string arm_of{};
    /// Names of the servers of the cell whose skills its own use, as far as the cell file says.
    std::vector<std::string> uses{};
    std::optional<Frame> world_from_base{};  ///< of its arm; none: nobody says
    std::optional<GripperMount> gripper{};
};

/// The control port of the world of virtual controllers.
struct CellWorld {
    std::string address;
    std::uint16_t port = 7400;
    nlohmann::json fixed = nlohmann::json::object();  ///< table and walls, as served
};

/// What is to be shown.
struct Cell {
    std::string name;
    std::vector<CellServer> servers;
    std::optional<CellWorld> world{};
    std::string records{};  ///< as cell::Records::url
};

/// Addresses that `metier up --endpoints` wrote, by name, instead of those of the cell file.
struct Endpoints {
    std::map<std::string, std::string> servers;
    std::map<std::string, std::string> virtual_controllers;
};

/// Errors: not_found, invalid_argument, with the file's name.
Result<Endpoints> loadEndpoints(const std::string& file);

/// Threads: any; pure.
Cell cellFrom(const cell::CellConfig& config, const Endpoints& endpoints = {});

}  // namespace metier::dashboard
