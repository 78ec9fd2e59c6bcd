#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "host/device_opening.hpp"
#include "host/skill_host.hpp"
#include "kinds/compositions.hpp"
#include "kinds/kinds.hpp"
#include "metier/motion/frame.hpp"
#include "metier/robot_skills/gripper_skills.hpp"

namespace metier::server {
namespace {

/// Objects for a robot without a NodeSet of its own.
opcua_skill::MotionDeviceSystemSpec specOf(const cell::ServerConfig& config,
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

/// The model with the tools of the cell besides its own.
Result<motion::RobotModel> withTools(const motion::RobotModel& model,
                                     const std::vector<cell::Tool>& tools) {
    auto chain = model.chain();
    for (const auto& tool : tools) {
        const auto& f = tool.frame;
        chain.tools.push_back(
            {tool.name, motion::toPose(Frame{f[0], f[1], f[2], f[3], f[4], f[5]}), tool.mass});
    }
    return model.withChain(std::move(chain));
}

/// \return nothing if the cell file names none
Result<std::optional<device::OpenDevice>> openSensor(const std::string& server,
                                                     const cell::ArmServer& config,
                                                     std::span<const device::Driver> drivers) {
    if (!config.force_torque_sensor) {
        return std::optional<device::OpenDevice>();
    }
    METIER_ASSIGN(auto sensor, openDevice(*config.force_torque_sensor, {server, drivers}));
    if (sensor.force_torque_sensor == nullptr) {
        return fail(Errc::invalid_argument,
                    fmt::format("{}: the driver \"{}\" is not one of a force-torque sensor", server,
                                config.force_torque_sensor->type));
    }
    return std::optional(std::move(sensor));
}

class ArmServer final : public Server {
public:
    ArmServer(std::unique_ptr<const motion::RobotModel> file_model, device::OpenDevice device,
              std::optional<device::OpenDevice> sensor, std::unique_ptr<SkillHost> host)
        : file_model_(std::move(file_model)),
          device_(std::move(device)),
          sensor_(std::move(sensor)),
          model_(device_.model ? *device_.model : *file_model_),
          host_(std::move(host)) {}

    std::string url() const override { return host_->url(); }
    Result<void> begin(const cell::ServerConfig& config, const cell::ArmServer& arm);

private:
    Result<void> offerSkills(const opcua_skill::MotionDeviceSystem& system,
                             const cell::ArmServer& config);

    std::unique_ptr<const motion::RobotModel> file_model_;  // outlives the device, which reads it
    device::OpenDevice device_;
    std::optional<device::OpenDevice> sensor_;
    std::shared_ptr<const robot_skills::StreamReport> stream_report_;      // shared with the skill
    std::shared_ptr<const robot_skills::StoppingReport> stopping_report_;  // shared with the moves
    const motion::RobotModel& model_;  // as the controller describes the robot, else of the file
    std::unique_ptr<SkillHost> host_;  // ends before the device
};

Result<void> ArmServer::begin(const cell::ServerConfig& config, const cell::ArmServer& arm) {
    METIER_ASSIGN(const auto system, arm.nodeset.empty()
                                         ? opcua_skill::publishMotionDeviceSystem(
                                               host_->nodes(), specOf(config, model_))
                                         : opcua_skill::findMotionDeviceSystem(host_->nodes()));
    METIER_TRY(offerSkills(system, arm));
    METIER_TRY(offerOwnCompositions(*host_, system.skills,
                                    {.server = config.name, .files = arm.compositions}));
    METIER_TRY(host_->offerControl(system.controller));
    host_->haltOnLossOf(*device_.arm);
    if (device_.gripper != nullptr) {
        host_->stopOnStall(*device_.gripper);
        METIER_TRY(host_->publishGripper(system.controller, *device_.gripper));
    }
    // A controller that measures the wrench itself needs no sensor in the cell file.
    METIER_TRY(host_->publishArm(
        system, {*device_.arm, model_, arm.payload,
                 sensor_ ? sensor_->force_torque_sensor : device_.force_torque_sensor,
                 stream_report_, stopping_report_}));
    return host_->start();
}

Result<void> ArmServer::offerSkills(const opcua_skill::MotionDeviceSystem& system,
                                    const cell::ArmServer& config) {
    // The controller's own force measurement ends those force moves that its planner cannot run.
    auto* const own_sensor = device_.planner != nullptr ? device_.force_torque_sensor : nullptr;
    METIER_ASSIGN(auto arm,
                  robot_skills::makeArmSkills(
                      {.arm = *device_.arm,
                       .planner = device_.planner,
                       .sensor = sensor_ ? sensor_->force_torque_sensor : own_sensor},
                      model_, host_->clock(), {.longest_silence = config.stream_silence}));
    stream_report_ = arm.stream_report;
    stopping_report_ = arm.stopping_report;
    auto skills = std::move(arm.moves);
    skills.push_back(std::move(arm.position_stream));
    if (device_.gripper != nullptr) {
        // A gripper of the arm's own controller is moved by it, as the axes are.
        auto gripper = robot_skills::makeGripperSkills(*device_.gripper);
        std::move(gripper.skills.begin(), gripper.skills.end(), std::back_inserter(skills));
    }
    auto offered = sharing(arm.resource, std::move(skills));
    if (device_.gripper != nullptr) {
        offered.push_back(
            {robot_skills::makeHoldSkill(*device_.gripper, host_->skills().executor()), nullptr});
    }
    return host_->offerSkills(system.skills, config.skills, std::move(offered));
}

}  // namespace

Result<std::unique_ptr<Server>> serve(const cell::ServerConfig& config, const cell::ArmServer& arm,
                                      const Context& context) {
    METIER_ASSIGN(auto loaded, motion::RobotModel::load(arm.model).and_then(
                                   [&](const auto& model) { return withTools(model, arm.tools); }));
    auto model = std::make_unique<const motion::RobotModel>(std::move(loaded));
    METIER_ASSIGN(auto device, openDevice(arm.driver, {config.name, context.drivers, model.get()}));
    if (device.arm == nullptr) {
        return fail(Errc::invalid_argument,
                    fmt::format("{}: the driver \"{}\" is not one of an arm", config.name,
                                arm.driver.type));
    }
    const auto nodesets =
        arm.nodeset.empty() ? std::vector<std::string>() : std::vector{arm.nodeset};
    METIER_ASSIGN(auto host, SkillHost::create(config, context.identity, nodesets));
    METIER_ASSIGN(auto sensor, openSensor(config.name, arm, context.drivers));
    awaitConnection(device);
    auto server = std::make_unique<ArmServer>(std::move(model), std::move(device),
                                              std::move(sensor), std::move(host));
    METIER_TRY(server->begin(config, arm));
    return server;
}

}  // namespace metier::server
