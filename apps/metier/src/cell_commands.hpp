#pragma once

#include <string>
#include <vector>

#include "metier/cell/cell.hpp"
#include "metier/server/cell_runner.hpp"
#include "metier/server/identity.hpp"

namespace metier::app {

/// Ports on which the servers and virtual controllers of a cell listen.
enum class Ports {
    configured,
    free,  ///< each server at a free port, each virtual controller at a free address of this
           ///< machine
};

/// The processes of a cell as commands of this program: `metier serve` and `metier virtual run`.
class MetierCommands final : public server::CellCommands {
public:
    /// \param cell must outlive this
    MetierCommands(const cell::CellConfig& cell, Ports ports, const server::Security& security);

    server::CellCommand of(const cell::VirtualController& controller,
                           const server::CellAddresses& known) const override;
    server::CellCommand of(const cell::ServerConfig& server,
                           const server::CellAddresses& known) const override;

private:
    const cell::CellConfig& cell_;
    const Ports ports_;
    const std::vector<std::string> security_;
};

}  // namespace metier::app
