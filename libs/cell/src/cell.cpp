#include "metier/cell/cell.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "cell_reading.hpp"
#include "metier/base/overloaded.hpp"
#include "metier/cell/toml_file.hpp"

namespace metier::cell {
namespace {

constexpr std::int64_t kMaxPort = 65535;
// A shorter silence is within the jitter of a network, a longer one leaves an arm to itself [s].
constexpr double kShortestSilence = 0.02;
constexpr double kLongestSilence = 2.0;
// A shorter limit is within what a busy machine lets a thread wait [s].
constexpr double kShortestStall = 0.1;
constexpr double kLongestStall = 2.0;
constexpr double kHeaviest = 10'000.0;  // payload [kg]

DriverChoice readDriver(const TomlTable& table) {
    DriverChoice driver;
    driver.type = table.text("type");
    driver.controller = table.textOr("controller", "");
    driver.settings = table.settings({"type", "controller"});
    return driver;
}

Tool readTool(const TomlTable& table) {
    Tool tool;
    tool.name = table.text("name");
    tool.mass = table.numberOr("mass", 0.0);
    const auto frame = table.numbers("frame");
    if (frame.size() == tool.frame.size()) {
        std::copy(frame.begin(), frame.end(), tool.frame.begin());
    } else {
        table.reject("frame", fmt::format("has {} numbers; needs 6: x, y, z [m], a, b, c [rad]",
                                          frame.size()));
    }
    return tool;
}

ArmServer readArm(const TomlTable& table, const std::filesystem::path& folder) {
    ArmServer arm;
    arm.model = pathIn(table, "model", folder);
    arm.driver = readDriver(table.table("driver"));
    if (table.has("force_torque_sensor")) {
        arm.force_torque_sensor = readDriver(table.table("force_torque_sensor"));
    }
    arm.nodeset = table.textOr("nodeset", "");
    arm.skills = table.texts("skills");
    for (const auto& tool : table.tables("tool")) {
        arm.tools.push_back(readTool(tool));
    }
    arm.payload = numberWithin(table, "payload", arm.payload, {0, kHeaviest, "kg"});
    arm.stream_silence = numberWithin(table, "stream_silence", arm.stream_silence,
                                      {kShortestSilence, kLongestSilence, "s"});
    if (table.has("compositions")) {
        arm.compositions = readFiles(table, "compositions", folder);
    }
    return arm;
}

GripperServer readGripper(const TomlTable& table) {
    GripperServer gripper;
    gripper.driver = readDriver(table.table("driver"));
    gripper.nodeset = table.text("nodeset");
    gripper.skills = table.texts("skills");
    return gripper;
}

VirtualController readVirtual(const TomlTable& table, const std::filesystem::path& folder) {
    VirtualController controller;
    controller.name = table.text("name");
    controller.type = table.text("type");
    controller.address = table.textOr("address", "127.0.0.1");
    controller.control_port = static_cast<std::uint16_t>(
        table.integerOr("control_port", controller.control_port, 0, kMaxPort));
    if (table.has("model")) {
        controller.model = pathIn(table, "model", folder);
    }
    controller.settings = table.settings({"name", "type", "address", "control_port", "model"});
    return controller;
}

void checkDiscovers(bool wanted, const char* key, const Discovery& discovery,
                    const TomlTable& table) {
    if (wanted && !discovery.enabled()) {
        table.reject(key, "\"discover\" needs discovery = \"opc.tcp://...\" or mdns = true");
    }
}

/// After what all kinds have: some keys need discovery.
void readKind(const TomlTable& table, const std::filesystem::path& folder, ServerConfig& server) {
    const auto kind = table.text("kind");
    if (kind == "arm") {
        server.kind = readArm(table, folder);
    } else if (kind == "gripper") {
        server.kind = readGripper(table);
    } else if (kind == "move") {
        const auto move = readMove(table, folder);
        checkDiscovers(move.discover, "robot", server.discovery, table);
        server.kind = move;
    } else if (kind == "composition") {
        const auto composition = readComposition(table, folder);
        checkDiscovers(composition.discover, "servers", server.discovery, table);
        server.kind = composition;
    } else if (kind == "synchronized") {
        server.kind = readSynchronized(table);
    } else if (!kind.empty()) {
        table.reject(
            "kind",
            fmt::format("\"{}\" is not one of: arm, gripper, move, composition, synchronized",
                        kind));
    }
}

/// Values of a cell for all its servers.
struct Shared {
    Discovery discovery;
    Records records;
};

ServerConfig readServer(const TomlTable& table, const std::filesystem::path& folder,
                        const Shared& of_cell) {
    ServerConfig server;
    server.name = table.text("name");
    server.port = static_cast<std::uint16_t>(table.integerOr("port", 0, 0, kMaxPort));
    server.address = table.textOr("address", "127.0.0.1");
    server.publish_at_once = table.flagOr("publish_at_once", true);
    server.stall_limit = numberWithin(table, "stall_limit", server.stall_limit,
                                      {kShortestStall, kLongestStall, "s"});
    if (table.has("limits")) {
        server.limits = readLimits(table.table("limits"));
    }
    if (table.has("nodesets")) {
        server.nodesets = readFiles(table, "nodesets", folder);
    }
    if (table.has("types")) {
        server.types = readFiles(table, "types", folder);
    }
    server.discovery = readDiscovery(table, of_cell.discovery);
    server.records = of_cell.records;
    server.metrics = readMetrics(table);
    readKind(table, folder, server);
    return server;
}

/// Arms that are moved together are behind servers with move skills.
void checkKind(const CellConfig& cell, const SynchronizedServer& config, const TomlTable& table) {
    for (const auto& used : config.servers) {
        const auto* server = cell.find(used.name);
        const bool moves =
            server != nullptr && (server->as<ArmServer>() || server->as<MoveComponent>());
        if (used.url.empty() && !moves) {
            table.reject("servers", fmt::format("\"{}\" is neither a server of kind arm or move in "
                                                "this file nor an opc.tcp:// address",
                                                used.name));
        }
    }
}

void checkKind(const CellConfig& cell, const MoveComponent& config, const TomlTable& table) {
    if (config.discover || isAddress(config.robot)) {
        return;
    }
    const auto* robot = cell.find(config.robot);
    if (!config.robot.empty() && (robot == nullptr || !robot->as<ArmServer>())) {
        table.reject("robot", fmt::format("\"{}\" is neither a server of kind arm in this file nor "
                                          "an opc.tcp:// address",
                                          config.robot));
    }
}

/// Compositions that use each other are in the order of their start.
/// \param index of the server that uses others
void checkOrder(const CellConfig& cell, std::size_t index, const TomlTable& table) {
    for (const auto& used : cell.servers[index].usedServers()) {
        const auto end = cell.servers.begin() + static_cast<std::ptrdiff_t>(index);
        const bool above = std::any_of(cell.servers.begin(), end, [&](const auto& server) {
            return server.name == used.name;
        });
        const auto* server = cell.find(used.name);
        const bool other_kind = server != nullptr && !server->as<CompositionServer>();
        if (used.url.empty() && !above && !other_kind) {
            table.reject("servers", fmt::format("\"{}\" is neither a server of this file (one of "
                                                "kind composition only above this one) nor an "
                                                "opc.tcp:// address",
                                                used.name));
        }
    }
}

void checkReferences(const CellConfig& cell, const std::vector<TomlTable>& tables) {
    std::set<std::string> names;
    std::set<std::uint16_t> ports;
    for (std::size_t i = 0; i < cell.servers.size(); ++i) {
        const auto& server = cell.servers[i];
        const auto& table = tables[i];
        if (!server.name.empty() && !names.insert(server.name).second) {
            table.reject("name", fmt::format("\"{}\" is taken by a server above", server.name));
        }
        if (server.name == kDiscover) {
            table.reject("name", "\"discover\" means any server that is found");
        }
        if (server.port != 0 && !ports.insert(server.port).second) {
            table.reject("port", fmt::format("{} is taken by a server above", server.port));
        }
        std::visit(overloaded{[](const auto& /*device*/) {},
                              [&](const MoveComponent& move) { checkKind(cell, move, table); },
                              [&](const SynchronizedServer& both) { checkKind(cell, both, table); },
                              [&](const CompositionServer&) { checkOrder(cell, i, table); }},
                   server.kind);
    }
}

void checkVirtual(const CellConfig& cell, const std::vector<TomlTable>& tables) {
    std::set<std::string> names;
    std::set<std::string> addresses;
    for (std::size_t i = 0; i < tables.size(); ++i) {
        const auto& controller = cell.virtual_controllers[i];
        if (!controller.name.empty() && !names.insert(controller.name).second) {
            tables[i].reject("name", fmt::format("\"{}\" is taken by a virtual controller above",
                                                 controller.name));
        }
        if (!addresses.insert(controller.address).second && controller.control_port != 0) {
            tables[i].reject("address",
                             fmt::format("{} is taken by a virtual controller above; any "
                                         "127.x.y.z is an address of this machine",
                                         controller.address));
        }
    }
}

Result<CellConfig> readCell(const TomlFile& toml, const std::filesystem::path& file) {
    const auto root = toml.root();
    CellConfig cell;
    cell.file = std::filesystem::absolute(file);
    cell.name = root.text("name");
    const Shared shared{readDiscovery(root, {}), readRecords(root, cell.file.parent_path())};
    const auto tables = root.tables("server");
    for (const auto& table : tables) {
        cell.servers.push_back(readServer(table, cell.file.parent_path(), shared));
    }
    const auto virtual_tables = root.tables("virtual");
    for (const auto& table : virtual_tables) {
        cell.virtual_controllers.push_back(readVirtual(table, cell.file.parent_path()));
    }
    if (tables.empty() && virtual_tables.empty()) {
        root.reject("server", "a cell needs at least one [[server]] or [[virtual]]");
    }
    checkReferences(cell, tables);
    checkVirtual(cell, virtual_tables);
    METIER_TRY(toml.finish());
    return cell;
}

}  // namespace

Result<CellConfig> loadCell(const std::filesystem::path& file) {
    const auto toml = TomlFile::load(file);
    return toml ? readCell(*toml, file) : fail(toml.error());
}

Result<CellConfig> parseCell(std::string_view text, const std::filesystem::path& file) {
    const auto toml = TomlFile::parse(text, file.string());
    return toml ? readCell(*toml, file) : fail(toml.error());
}

}  // namespace metier::cell
