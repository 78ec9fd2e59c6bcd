#include "kinds/gripper_server.hpp"

#include <fmt/format.h>

#include <utility>

#include "host/device_opening.hpp"
#include "metier/opcua_skill/skill_controller.hpp"
#include "metier/robot_skills/gripper_skills.hpp"

namespace metier::server {

Result<std::unique_ptr<GripperServer>> GripperServer::start(
    const cell::ServerConfig& config, const cell::GripperServer& gripper,
    const Context& context) {
    auto device = openDevice(gripper.driver, {config.name, context.drivers});
    if (!device) {
        return fail(device.error());
    }
    if (device->gripper == nullptr) {
        return fail(Errc::invalid_argument,
                    fmt::format("{}: the driver \"{}\" is not one of a gripper", config.name,
                                gripper.driver.type));
    }
    auto host = SkillHost::create(config, context.identity, {gripper.nodeset});
    if (!host) {
        return fail(host.error());
    }
    awaitConnection(*device);
    std::unique_ptr<GripperServer> server(new GripperServer(std::move(*device), std::move(*host)));
    if (auto offered = server->offer(gripper); !offered) {
        return fail(offered.error());
    }
    if (auto started = server->host_->start(); !started) {
        return fail(started.error());
    }
    return server;
}

GripperServer::GripperServer(device::OpenDevice device, std::unique_ptr<SkillHost> host)
    : device_(std::move(device)), host_(std::move(host)) {}

Result<void> GripperServer::offer(const cell::GripperServer& config) {
    const auto found = opcua_skill::findSkillController(host_->nodes());
    if (!found) {
        return fail(found.error());
    }
    auto skills = robot_skills::makeGripperSkills(*device_.gripper);
    auto all = sharing(skills.resource, std::move(skills.skills));
    all.push_back(
        {robot_skills::makeHoldSkill(*device_.gripper, host_->skills().executor()), nullptr});
    if (auto offered = host_->offerSkills(found->skills, config.skills, std::move(all)); !offered) {
        return offered;
    }
    if (auto offered = host_->offerControl(found->controller); !offered) {
        return offered;
    }
    host_->haltOnLossOf(*device_.gripper);
    return host_->publishGripper(found->controller, *device_.gripper);
}

}  // namespace metier::server
