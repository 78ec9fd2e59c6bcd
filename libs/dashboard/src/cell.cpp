#include "metier/dashboard/cell.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <utility>

namespace metier::dashboard {
namespace {

using cell::CellConfig;
using cell::ServerConfig;
using cell::Settings;
using nlohmann::json;

std::optional<Frame> frameIn(const std::vector<double>& numbers) {
    return numbers.size() == 6 ? std::optional(Frame{numbers[0], numbers[1], numbers[2], numbers[3],
                                                     numbers[4], numbers[5]})
                               : std::nullopt;
}

std::string controllerOf(const ServerConfig& server) {
    const auto* driver = server.driver();
    return driver == nullptr ? "" : driver->controller;
}

/// The server of the arm behind that controller.
std::string armServerAt(const CellConfig& config, const std::string& controller) {
    const auto found =
        std::find_if(config.servers.begin(), config.servers.end(), [&](const ServerConfig& one) {
            const auto* arm = one.as<cell::ArmServer>();
            return arm != nullptr && !controller.empty() && arm->driver.controller == controller;
        });
    return found == config.servers.end() ? "" : found->name;
}

void placeInWorld(const CellConfig& config, const ServerConfig& server, CellServer& shown) {
    const auto* world = config.world();
    const auto controller = controllerOf(server);
    if (world == nullptr || controller.empty()) {
        return;
    }
    const auto& settings = world->settings;
    if (server.as<cell::ArmServer>() != nullptr) {
        // The world puts an arm without a base at its origin.
        shown.world_from_base =
            frameIn(settings.numbersOr("base." + controller, {0, 0, 0, 0, 0, 0}, 6));
        return;
    }
    shown.gripper =
        GripperMount{armServerAt(config, settings.textOr("on." + controller, {})),
                     frameIn(settings.numbersOr("jaws." + controller, {}, 6)).value_or(Frame{})};
}

std::string addressOf(const std::map<std::string, std::string>& given, const std::string& name,
                      const std::string& configured) {
    const auto found = given.find(name);
    return found == given.end() ? configured : found->second;
}

/// Names of the servers of the cell whose skills those of `server` use.
std::vector<std::string> usedBy(const CellConfig& config, const ServerConfig& server) {
    std::vector<std::string> names;
    const auto add = [&](const std::string& name) {
        if (config.find(name) != nullptr) {
            names.push_back(name);
        }
    };
    if (const auto* move = server.as<cell::MoveComponent>()) {
        add(move->robot);
    }
    for (const auto& used : server.usedServers()) {
        add(used.name);
    }
    return names;
}

json wallsOf(const Settings& settings) {
    auto walls = json::array();
    for (const auto& name : settings.namesUnder("wall")) {
        const auto v = settings.numbersOr("wall." + name, {}, 8);
        if (v.size() == 8) {
            walls.push_back(
                {{"name", name}, {"point", {v[0], v[1], v[2]}}, {"normal", {v[3], v[4], v[5]}}});
        }
    }
    return walls;
}

CellWorld worldOf(const cell::VirtualController& world, const Endpoints& endpoints) {
    CellWorld shown{addressOf(endpoints.virtual_controllers, world.name, world.address),
                    world.control_port};
    shown.fixed["table"] = nullptr;
    if (world.settings.has("table")) {
        shown.fixed["table"] = {{"height", world.settings.numberOr("table", 0.0, -10.0, 10.0)}};
    }
    shown.fixed["walls"] = wallsOf(world.settings);
    return shown;
}

void takeNames(const json& list, const char* key, std::map<std::string, std::string>& into) {
    for (const auto& one : list) {
        into[one.at("name").get<std::string>()] = one.at(key).get<std::string>();
    }
}

}  // namespace

Result<Endpoints> loadEndpoints(const std::string& file) {
    std::ifstream stream(file);
    if (!stream) {
        return fail(Errc::not_found, fmt::format("{}: cannot be read", file));
    }
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    try {
        const auto parsed = json::parse(text);
        Endpoints endpoints;
        takeNames(parsed.at("servers"), "url", endpoints.servers);
        takeNames(parsed.at("virtual"), "address", endpoints.virtual_controllers);
        return endpoints;
    } catch (const json::exception& error) {
        return fail(Errc::invalid_argument, fmt::format("{}: {}", file, error.what()));
    }
}

Cell cellFrom(const CellConfig& config, const Endpoints& endpoints) {
    Cell cell{.name = config.name, .servers = {}};
    for (const auto& server : config.servers) {
        CellServer shown{server.name,
                         addressOf(endpoints.servers, server.name,
                                   fmt::format("opc.tcp://{}:{}", server.address, server.port))};
        const auto* move = server.as<cell::MoveComponent>();
        if (move != nullptr && config.find(move->robot) != nullptr) {
            shown.arm_of = move->robot;
        }
        shown.uses = usedBy(config, server);
        placeInWorld(config, server, shown);
        cell.servers.push_back(std::move(shown));
        cell.records = server.records.url;  // the same for all
    }
    if (const auto* world = config.world()) {
        cell.world = worldOf(*world, endpoints);
    }
    return cell;
}

}  // namespace metier::dashboard
