#include <fmt/format.h>

#include <utility>

#include "host/device_opening.hpp"
#include "host/skill_host.hpp"
#include "kinds/kinds.hpp"
#include "metier/opcua_skill/skill_controller.hpp"
#include "metier/robot_skills/gripper_skills.hpp"

namespace metier::server {
namespace {

class GripperServer final : public Server {
public:
    GripperServer(device::OpenDevice device, std::unique_ptr<SkillHost> host)
        : device_(std::move(device)), host_(std::move(host)) {}

    std::string url() const override { return host_->url(); }

    Result<void> begin(const cell::GripperServer& config) {
        METIER_ASSIGN(const auto found, opcua_skill::findSkillController(host_->nodes()));
        auto skills = robot_skills::makeGripperSkills(*device_.gripper);
        auto all = sharing(skills.resource, std::move(skills.skills));
        all.push_back(
            {robot_skills::makeHoldSkill(*device_.gripper, host_->skills().executor()), nullptr});
        METIER_TRY(host_->offerSkills(found.skills, config.skills, std::move(all)));
        METIER_TRY(host_->offerControl(found.controller));
        host_->haltOnLossOf(*device_.gripper);
        METIER_TRY(host_->publishGripper(found.controller, *device_.gripper));
        return host_->start();
    }

private:
    device::OpenDevice device_;
    std::unique_ptr<SkillHost> host_;  // ends before the device
};

}  // namespace

Result<std::unique_ptr<Server>> serve(const cell::ServerConfig& config,
                                      const cell::GripperServer& gripper, const Context& context) {
    METIER_ASSIGN(auto device, openDevice(gripper.driver, {config.name, context.drivers}));
    if (device.gripper == nullptr) {
        return fail(Errc::invalid_argument,
                    fmt::format("{}: the driver \"{}\" is not one of a gripper", config.name,
                                gripper.driver.type));
    }
    METIER_ASSIGN(auto host, SkillHost::create(config, context.identity, {gripper.nodeset}));
    awaitConnection(device);
    auto server = std::make_unique<GripperServer>(std::move(device), std::move(host));
    METIER_TRY(server->begin(gripper));
    return server;
}

}  // namespace metier::server
