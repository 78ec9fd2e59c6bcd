#pragma once

#include <memory>
#include <optional>
#include <string>

#include "host/skill_host.hpp"
#include "metier/base/error.hpp"
#include "metier/cell/cell.hpp"
#include "metier/device/driver.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/server/server.hpp"

namespace metier::server {

/// An arm behind its OPC UA server, with its skills: at the instances of its NodeSet, and at nodes
/// made at run time for those that the NodeSet does not have.
///
/// Threading: one thread starts and ends it.
class ArmServer final : public Server {
public:
    /// Errors: what is wrong with the model, the driver, the NodeSet, the skills or the port.
    /// \param arm of `config`
    static Result<std::unique_ptr<ArmServer>> start(const cell::ServerConfig& config,
                                                    const cell::ArmServer& arm,
                                                    const Context& context);

    std::string url() const override { return host_->url(); }

private:
    ArmServer(std::unique_ptr<const motion::RobotModel> file_model, device::OpenDevice device,
              std::optional<device::OpenDevice> sensor, std::unique_ptr<SkillHost> host);
    Result<void> offer(const cell::ServerConfig& config, const cell::ArmServer& arm);
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

}  // namespace metier::server
