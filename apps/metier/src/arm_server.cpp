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

/// Skill objects of the NodeSet that the cell file does not ask for would stay without a skill.
Result<void> checkAllAsked(const std::vector<opcua::Reference>& nodes,
                           const configuration::ArmServer& config) {
    for (const auto& node : nodes) {
        const auto& name = node.browse_name.name;
        if (std::find(config.skills.begin(), config.skills.end(), name) == config.skills.end()) {
            return fail(Errc::invalid_argument,
                        fmt::format("skills = [{}], but the NodeSet '{}' also has {}",
                                    fmt::join(config.skills, ", "), config.nodeset, name));
        }
    }
    return {};
}

/// Objects for a robot without a NodeSet of its own.
opcua_skill::MotionDeviceSystemSpec specOf(const configuration::ServerConfig& config,
                                           const motion::RobotModel& model) {
    opcua_skill::MotionDeviceSystemSpec spec;
    spec.name = config.name;
    spec.description = fmt::format("{} {}", model.maker(), model.product());
    spec.manufacturer = model.maker();
    spec.model = model.product();
    for (const auto& joint : model.chain().joints) {
        spec.axis_names.push_back(joint.name);
    }
    return spec;
}

std::vector<std::string> nodesetsOf(const configuration::ArmServer& config) {
    if (config.nodeset.empty()) {
        return {};
    }
    return {config.nodeset};
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
    auto host = SkillHost::create(config, nodesetsOf(config.arm));
    if (!host) {
        return fail(host.error());
    }
    if (!awaitConnection(*device, kFirstAnswer)) {
        spdlog::warn("{}", device->arm->safety().text);
    }
    std::unique_ptr<ArmServer> server(
        new ArmServer(std::move(*loaded), std::move(*device), std::move(*host)));
    if (auto offered = server->offer(config); !offered) {
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

Result<void> ArmServer::offer(const configuration::ServerConfig& config) {
    const auto system =
        config.arm.nodeset.empty()
            ? opcua_skill::publishMotionDeviceSystem(host_->nodes(), specOf(config, model_))
            : opcua_skill::findMotionDeviceSystem(host_->nodes());
    if (!system) {
        return fail(system.error());
    }
    if (auto offered = offerSkills(*system, config.arm); !offered) {
        return offered;
    }
    if (auto offered = host_->offerControl(system->controller); !offered) {
        return offered;
    }
    host_->haltOnLossOf(*device_.arm);
    return host_->publishArm(*system, *device_.arm, model_);
}

Result<void> ArmServer::offerSkills(const opcua_skill::MotionDeviceSystem& system,
                                    const configuration::ArmServer& config) {
    const auto nodes = host_->nodes().browse(system.skills);
    if (!nodes) {
        return fail(nodes.error());
    }
    if (auto all_asked = checkAllAsked(*nodes, config); !all_asked) {
        return all_asked;
    }
    auto arm_skills = robot_skills::makeArmSkills(*device_.arm, model_, host_->clock(),
                                                  {.longest_silence = config.stream_silence});
    if (!arm_skills) {
        return fail(arm_skills.error());
    }
    const skill::ProgramOptions options{.resource = arm_skills->resource,
                                        .control = host_->control()};
    auto skills = byName(std::move(*arm_skills));
    for (const auto& name : config.skills) {
        const auto found = skills.find(name);
        if (found == skills.end()) {
            return fail(Errc::not_supported, fmt::format("no skill '{}' for this arm", name));
        }
        const auto node = std::find_if(nodes->begin(), nodes->end(), [&](const auto& reference) {
            return reference.browse_name.name == name;
        });
        if (node == nodes->end()) {
            if (auto published =
                    host_->skills().publish(system.skills, std::move(found->second), options);
                !published) {
                return fail(published.error());
            }
        } else if (auto bound =
                       host_->skills().bind(node->target, std::move(found->second), options);
                   !bound) {
            return fail(bound.error());
        }
    }
    return {};
}

}  // namespace metier::app
