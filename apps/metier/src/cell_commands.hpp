#pragma once

#include <map>
#include <string>
#include <vector>

#include "cell_member.hpp"
#include "metier/cell/cell.hpp"

namespace metier::app {

/// Where the servers and virtual controllers of a cell listen.
enum class Ports {
    configured,
    free,  ///< each server at a free port, each virtual controller at a free address of this
           ///< machine
};

/// Addresses of the processes of a cell that are ready, by name.
struct CellAddresses {
    std::map<std::string, std::string> servers;  ///< opc.tcp://...
    std::map<std::string, std::string> controllers;
};

/// \param known those that the controller uses are in it
CellMember::Plan planOf(const cell::CellConfig& cell,
                        const cell::VirtualController& controller, Ports ports,
                        const CellAddresses& known);
CellMember::Plan planOf(const cell::CellConfig& cell,
                        const cell::ServerConfig& server, Ports ports,
                        const CellAddresses& known);

/// Rank of a server.
CellRank rankOf(const cell::ServerConfig& server);

}  // namespace metier::app
