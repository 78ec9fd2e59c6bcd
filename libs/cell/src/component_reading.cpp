#include <fmt/format.h>

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
    if (table.has("axes")) {
        move.axes = table.texts("axes");
        if (move.model.empty()) {
            table.reject("axes", "is the order of the joints of a model; there is no \"model\"");
        }
    }
}

}  // namespace

MoveComponent readMove(const TomlTable& table, const std::filesystem::path& folder) {
    MoveComponent move;
    move.robot = table.text("robot");
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
