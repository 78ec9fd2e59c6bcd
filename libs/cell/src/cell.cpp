#include "metier/cell/cell.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "cell_reading.hpp"
#include "component_reading.hpp"
#include "limits_reading.hpp"
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
    arm.payload = table.numberOr("payload", arm.payload);
    if (!(arm.payload >= 0 && arm.payload <= kHeaviest)) {
        table.reject("payload", fmt::format("{} is not within 0 to {} kg", arm.payload, kHeaviest));
    }
    arm.stream_silence = secondsWithin(table, "stream_silence", arm.stream_silence,
                                       {kShortestSilence, kLongestSilence});
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

/// What a cell says for all its servers.
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
    server.stall_limit =
        secondsWithin(table, "stall_limit", server.stall_limit, {kShortestStall, kLongestStall});
    if (table.has("limits")) {
        server.limits = readLimits(table.table("limits"));
    }
    server.discovery = readDiscovery(table, of_cell.discovery);
    server.records = of_cell.records;
    server.metrics = readMetrics(table);
    const auto kind = table.text("kind");
    if (kind == "arm") {
        server.kind = ServerKind::arm;
        server.arm = readArm(table, folder);
        if (table.has("compositions")) {
            server.own_compositions = readFiles(table, "compositions", folder);
        }
    } else if (kind == "gripper") {
        server.kind = ServerKind::gripper;
        server.gripper = readGripper(table);
    } else if (kind == "move") {
        server.kind = ServerKind::move;
        server.move = readMove(table);
        checkDiscovers(server.move.discover, "robot", server.discovery, table);
    } else if (kind == "composition") {
        server.kind = ServerKind::composition;
        server.composition = readComposition(table, folder);
        checkDiscovers(server.composition.discover, "servers", server.discovery, table);
    } else if (kind == "synchronized") {
        server.kind = ServerKind::synchronized;
        server.synchronized = readSynchronized(table);
    } else if (!kind.empty()) {
        table.reject(
            "kind",
            fmt::format("\"{}\" is not one of: arm, gripper, move, composition, synchronized",
                        kind));
    }
    return server;
}

/// Arms that are moved together are behind servers with move skills.
void checkSynchronized(const CellConfig& cell, const ServerConfig& config, const TomlTable& table) {
    for (const auto& used : config.synchronized.servers) {
        const auto* server = cell.find(used.name);
        const bool moves = server != nullptr &&
                           (server->kind == ServerKind::arm || server->kind == ServerKind::move);
        if (used.url.empty() && !moves) {
            table.reject("servers", fmt::format("\"{}\" is neither a server of kind arm or move in "
                                                "this file nor an opc.tcp:// address",
                                                used.name));
        }
    }
}

/// Whoever uses others comes after them, so that they can be started in the order of the file.
void checkUsedServers(const CellConfig& cell, std::size_t index, const TomlTable& table) {
    for (const auto& used : cell.servers[index].usedServers()) {
        const auto end = cell.servers.begin() + static_cast<std::ptrdiff_t>(index);
        const bool above = std::any_of(cell.servers.begin(), end, [&](const auto& server) {
            return server.name == used.name;
        });
        const auto* server = cell.find(used.name);
        const bool other_kind = server != nullptr && server->kind != ServerKind::composition;
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
        if (!server.name.empty() && !names.insert(server.name).second) {
            tables[i].reject("name", fmt::format("\"{}\" is taken by a server above", server.name));
        }
        if (server.name == kDiscover) {
            tables[i].reject("name", "\"discover\" means any server that is found");
        }
        if (server.port != 0 && !ports.insert(server.port).second) {
            tables[i].reject("port", fmt::format("{} is taken by a server above", server.port));
        }
        if (server.kind == ServerKind::synchronized) {
            checkSynchronized(cell, server, tables[i]);
        } else {
            checkUsedServers(cell, i, tables[i]);
        }
        if (server.kind != ServerKind::move || server.move.discover ||
            isAddress(server.move.robot)) {
            continue;
        }
        const auto* robot = cell.find(server.move.robot);
        if (!server.move.robot.empty() && (robot == nullptr || robot->kind != ServerKind::arm)) {
            tables[i].reject("robot", fmt::format("\"{}\" is neither a server of kind arm in this "
                                                  "file nor an opc.tcp:// address",
                                                  server.move.robot));
        }
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

}  // namespace

const ServerConfig* CellConfig::find(const std::string& server) const {
    const auto found = std::find_if(servers.begin(), servers.end(),
                                    [&](const auto& s) { return s.name == server; });
    return found == servers.end() ? nullptr : &*found;
}

const VirtualController* CellConfig::findVirtual(const std::string& controller) const {
    const auto found = std::find_if(virtual_controllers.begin(), virtual_controllers.end(),
                                    [&](const auto& known) { return known.name == controller; });
    return found == virtual_controllers.end() ? nullptr : &*found;
}

const VirtualController* CellConfig::world() const {
    const auto found = std::find_if(virtual_controllers.begin(), virtual_controllers.end(),
                                    [](const auto& known) { return known.type == "world"; });
    return found == virtual_controllers.end() ? nullptr : &*found;
}

bool CellConfig::isVirtual() const {
    const auto virtual_device = [&](const DriverChoice& driver) {
        return driver.type == "simulator" || findVirtual(driver.controller) != nullptr;
    };
    return std::all_of(servers.begin(), servers.end(), [&](const ServerConfig& server) {
        switch (server.kind) {
            case ServerKind::arm:
                return virtual_device(server.arm.driver) &&
                       (!server.arm.force_torque_sensor ||
                        virtual_device(*server.arm.force_torque_sensor));
            case ServerKind::gripper:
                return virtual_device(server.gripper.driver);
            case ServerKind::move:
                return !server.move.discover && find(server.move.robot) != nullptr;
            case ServerKind::composition:
            case ServerKind::synchronized:
                return !server.composition.discover &&
                       std::all_of(server.usedServers().begin(), server.usedServers().end(),
                                   [&](const auto& used) { return find(used.name) != nullptr; });
        }
        return false;
    });
}

namespace {

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
    if (auto checked = toml.finish(); !checked) {
        return fail(checked.error());
    }
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
