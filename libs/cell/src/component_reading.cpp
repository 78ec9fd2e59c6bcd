#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "cell_reading.hpp"

namespace metier::cell {
namespace {

// Bounds of the start delay [s]: a nearer start may reach an arm too late, a later one is less
// certain.
constexpr double kShortestStartDelay = 0.05;
constexpr double kLongestStartDelay = 30.0;
// A shorter absence is that of a server that is started again [s].
constexpr double kShortestAbsence = 0.5;
constexpr double kLongestAbsence = 3'600.0;

double readRebindAfter(const TomlTable& table, double preset) {
    return numberWithin(table, "rebind_after", preset, {kShortestAbsence, kLongestAbsence, "s"});
}

/// Model of a robot whose server does not publish it, and the order of its axes there.
void readRobotModel(const TomlTable& table, const std::filesystem::path& folder,
                    MoveComponent& move) {
    if (table.has("model")) {
        move.model = pathIn(table, "model", folder);
    }
    move.device = table.textOr("device", "");
    if (!move.device.empty() && move.model.empty()) {
        table.reject("device", "is of a robot with a \"model\" here; there is none");
    }
    if (table.has("axes")) {
        move.axes = table.texts("axes");
        if (move.model.empty()) {
            table.reject("axes", "is the order of the joints of a model; there is no \"model\"");
        }
    }
}

/// Errors, noted in the table: a name that is not one of the servers.
void checkIsUsed(const TomlTable& table, const char* key, const std::string& name,
                 const std::vector<UsedServer>& servers) {
    const bool used = std::any_of(servers.begin(), servers.end(),
                                  [&](const UsedServer& server) { return server.name == name; });
    if (!name.empty() && !used) {
        table.reject(key, fmt::format("\"{}\" is none of \"servers\"", name));
    }
}

/// A force of an arm of metier has the axes of that arm's flange.
Force readForce(const TomlTable& table, const std::vector<UsedServer>& servers) {
    Force force{.name = table.text("name"),
                .server = table.text("server"),
                .variable = table.textOr("variable", ""),
                .torque = table.textOr("torque", ""),
                .arm = {},
                .pose = table.textOr("pose", "")};
    force.arm = table.textOr("arm", force.variable.empty() ? force.server : "");
    checkIsUsed(table, "server", force.server, servers);
    checkIsUsed(table, "arm", force.arm, servers);
    if (force.variable.empty() && !force.torque.empty()) {
        table.reject("torque", "is for a force with a \"variable\"");
    }
    if (force.arm.empty() && !force.pose.empty()) {
        table.reject("pose", "is of an \"arm\"");
    }
    return force;
}

std::vector<Force> readForces(const TomlTable& table, const std::vector<UsedServer>& servers) {
    std::vector<Force> forces;
    std::set<std::string> names;
    for (const auto& each : table.tables("force")) {
        forces.push_back(readForce(each, servers));
        if (!names.insert(forces.back().name).second) {
            each.reject("name", fmt::format("\"{}\" is there twice", forces.back().name));
        }
    }
    return forces;
}

}  // namespace

MoveComponent readMove(const TomlTable& table, const std::filesystem::path& folder) {
    MoveComponent move;
    move.robot = table.text("robot");
    move.controller = table.textOr("controller", "");
    if (move.robot != kDiscover) {
        readRobotModel(table, folder, move);
        return move;
    }
    move.robot.clear();
    move.discover = true;
    move.reach = table.amount("reach", "m");
    move.payload = table.amount("payload", "kg");
    move.rebind_after = readRebindAfter(table, move.rebind_after);
    return move;
}

CompositionServer readComposition(const TomlTable& table, const std::filesystem::path& folder) {
    CompositionServer composition;
    composition.files = readFiles(table, "compositions", folder);
    for (const auto& server : textOrTexts(table, "servers")) {
        if (server == kDiscover) {
            composition.discover = true;
        } else {
            composition.servers.push_back(usedServer(server));
        }
    }
    composition.forces = readForces(table, composition.servers);
    composition.rebind_after = readRebindAfter(table, composition.rebind_after);
    return composition;
}

SynchronizedServer readSynchronized(const TomlTable& table) {
    SynchronizedServer synchronized;
    synchronized.start_delay = numberWithin(table, "start_delay", synchronized.start_delay,
                                            {kShortestStartDelay, kLongestStartDelay, "s"});
    std::set<std::string> names;
    for (const auto& server : table.texts("servers")) {
        synchronized.servers.push_back(usedServer(server));
        if (!names.insert(server).second) {
            table.reject("servers", fmt::format("\"{}\" is there twice", server));
        }
    }
    if (names.size() < 2) {
        table.reject("servers", "needs at least two arms");
    }
    return synchronized;
}

}  // namespace metier::cell
