#include <fmt/format.h>

#include <algorithm>

#include "metier/base/overloaded.hpp"
#include "metier/cell/cell.hpp"

namespace metier::cell {
namespace {

/// \param kind the part of a server, const or not
template <typename Used, typename Kind>
std::span<Used> usedBy(Kind& kind) {
    if (auto* composition = std::get_if<CompositionServer>(&kind)) {
        return composition->servers;
    }
    if (auto* synchronized = std::get_if<SynchronizedServer>(&kind)) {
        return synchronized->servers;
    }
    return {};
}

/// The first element that fits, or nullptr.
template <typename T, typename Fits>
const T* firstOf(const std::vector<T>& all, Fits fits) {
    const auto found = std::find_if(all.begin(), all.end(), fits);
    return found == all.end() ? nullptr : &*found;
}

std::string urlOf(const ServerConfig& server) {
    return fmt::format("opc.tcp://{}:{}", server.address, server.port);
}

bool allInCell(const CellConfig& cell, const std::vector<UsedServer>& used) {
    return std::all_of(used.begin(), used.end(),
                       [&](const auto& server) { return cell.find(server.name) != nullptr; });
}

bool isVirtualDevice(const CellConfig& cell, const DriverChoice& driver) {
    return driver.type == "simulator" || cell.findVirtual(driver.controller) != nullptr;
}

}  // namespace

const DriverChoice* ServerConfig::driver() const noexcept {
    if (const auto* arm = as<ArmServer>()) {
        return &arm->driver;
    }
    const auto* gripper = as<GripperServer>();
    return gripper == nullptr ? nullptr : &gripper->driver;
}

std::span<const UsedServer> ServerConfig::usedServers() const {
    return usedBy<const UsedServer>(kind);
}

std::span<UsedServer> ServerConfig::usedServers() {
    return usedBy<UsedServer>(kind);
}

const ServerConfig* CellConfig::find(const std::string& server) const {
    return firstOf(servers, [&](const auto& known) { return known.name == server; });
}

const VirtualController* CellConfig::findVirtual(const std::string& controller) const {
    return firstOf(virtual_controllers,
                   [&](const auto& known) { return known.name == controller; });
}

const VirtualController* CellConfig::world() const {
    return firstOf(virtual_controllers, [](const auto& known) { return known.type == "world"; });
}

ServerConfig CellConfig::resolved(ServerConfig server) const {
    const auto resolve = [this](DriverChoice& driver) {
        if (const auto* controller = findVirtual(driver.controller)) {
            driver.controller = controller->address;
        }
    };
    std::visit(overloaded{[](auto& /*uses none of these*/) {},
                          [&](ArmServer& arm) {
                              resolve(arm.driver);
                              if (arm.force_torque_sensor) {
                                  resolve(*arm.force_torque_sensor);
                              }
                          },
                          [&](GripperServer& gripper) { resolve(gripper.driver); },
                          [&](MoveComponent& move) {
                              if (const auto* robot = find(move.robot)) {
                                  move.robot = urlOf(*robot);
                              }
                          }},
               server.kind);
    for (auto& used : server.usedServers()) {
        const auto* known = find(used.name);
        if (used.url.empty() && known != nullptr) {
            used.url = urlOf(*known);
        }
    }
    return server;
}

bool CellConfig::isVirtual() const {
    const overloaded is_virtual{
        [this](const ArmServer& arm) {
            return isVirtualDevice(*this, arm.driver) &&
                   (!arm.force_torque_sensor || isVirtualDevice(*this, *arm.force_torque_sensor));
        },
        [this](const GripperServer& gripper) { return isVirtualDevice(*this, gripper.driver); },
        [this](const MoveComponent& move) { return !move.discover && find(move.robot) != nullptr; },
        [this](const CompositionServer& composition) {
            return !composition.discover && allInCell(*this, composition.servers);
        },
        [this](const SynchronizedServer& both) { return allInCell(*this, both.servers); }};
    return std::all_of(servers.begin(), servers.end(), [&](const ServerConfig& server) {
        return std::visit(is_virtual, server.kind);
    });
}

}  // namespace metier::cell
