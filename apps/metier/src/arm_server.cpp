#include "arm_server.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <map>
#include <utility>

#include "device_opening.hpp"

namespace metier::app {
namespace {

// A controller that answers later than this finds its skills Halted.
constexpr std::chrono::seconds kFirstAnswer{10};

using SkillsByName = std::map<std::string, std::unique_ptr<skill::Skill>, std::less<>>;

SkillsByName byName(robot_skills::ArmSkills skills) {
    SkillsByName result;
    for (auto& move : skills.moves) {
        const auto name = move->description().name;
        result.emplace(name, std::move(move));
    }
    const auto name = skills.position_stream->description().name;
    result.emplace(name, std::move(skills.position_stream));
    return result;
}

/// The skill objects of the NodeSet must be just those that the cell file asks for.
Result<void> checkSameSkills(const std::vector<opcua::Reference>& nodes,
                             const configuration::ArmServer& config) {
    std::vector<std::string> in_nodeset;
    for (const auto& node : nodes) {
        in_nodeset.push_back(node.browse_name.name);
    }
    auto wanted = config.skills;
    std::sort(in_nodeset.begin(), in_nodeset.end());
    std::sort(wanted.begin(), wanted.end());
    if (in_nodeset == wanted) {
        return {};
    }
    return fail(Errc::invalid_argument,
                fmt::format("skills = [{}], but the NodeSet '{}' has [{}]", fmt::join(wanted, ", "),
                            config.nodeset, fmt::join(in_nodeset, ", ")));
}

}  // namespace

Result<std::unique_ptr<ArmServer>> ArmServer::start(const configuration::ServerConfig& config) {
    auto loaded = motion::RobotModel::load(config.arm.model);
    if (!loaded) {
        return fail(loaded.error());
    }
    auto device = openDevice(config.arm.driver, config.name, &*loaded);
    if (!device) {
        return fail(device.error());
    }
    if (device->arm == nullptr) {
        return fail(Errc::invalid_argument,
                    fmt::format("{}: the driver \"{}\" is not one of an arm", config.name,
                                config.arm.driver.type));
    }
    auto host = SkillHost::create(config, {config.arm.nodeset});
    if (!host) {
        return fail(host.error());
    }
    if (!awaitConnection(*device, kFirstAnswer)) {
        spdlog::warn("{}", device->arm->safety().text);
    }
    std::unique_ptr<ArmServer> server(
        new ArmServer(std::move(*loaded), std::move(*device), std::move(*host)));
    if (auto offered = server->offer(config.arm); !offered) {
        return fail(offered.error());
    }
    if (auto started = server->host_->start(); !started) {
        return fail(started.error());
    }
    return server;
}

ArmServer::ArmServer(motion::RobotModel model, driver::OpenDevice device,
                     std::unique_ptr<SkillHost> host)
    : model_(device.model ? std::move(*device.model) : std::move(model)),
      device_(std::move(device)),
      host_(std::move(host)) {}

Result<void> ArmServer::offer(const configuration::ArmServer& config) {
    const auto system = opcua_skill::findMotionDeviceSystem(host_->nodes());
    if (!system) {
        return fail(system.error());
    }
    const auto nodes = host_->nodes().browse(system->skills);
    if (!nodes) {
        return fail(nodes.error());
    }
    if (auto same = checkSameSkills(*nodes, config); !same) {
        return same;
    }
    auto arm_skills = robot_skills::makeArmSkills(*device_.arm, model_, host_->clock(),
                                                  {.longest_silence = config.stream_silence});
    if (!arm_skills) {
        return fail(arm_skills.error());
    }
    const auto resource = arm_skills->resource;
    auto skills = byName(std::move(*arm_skills));
    for (const auto& node : *nodes) {
        auto found = skills.find(node.browse_name.name);
        if (found == skills.end()) {
            return fail(Errc::not_supported,
                        fmt::format("no skill '{}' for this arm", node.browse_name.name));
        }
        const auto bound =
            host_->skills().bind(node.target, std::move(found->second),
                                 {.resource = resource, .control = host_->control()});
        if (!bound) {
            return fail(bound.error());
        }
    }
    if (auto offered = host_->offerControl(system->controller); !offered) {
        return offered;
    }
    host_->haltOnLossOf(*device_.arm);
    return host_->publishArm(*system, *device_.arm, model_);
}

}  // namespace metier::app
