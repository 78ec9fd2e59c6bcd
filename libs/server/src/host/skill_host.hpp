#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/announcement.hpp"
#include "host/server_access.hpp"
#include "host/server_audit.hpp"
#include "host/server_records.hpp"
#include "host/shown_arm.hpp"
#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/cell/cell.hpp"
#include "metier/composition/used_skill.hpp"
#include "metier/device/arm.hpp"
#include "metier/link/name_lock.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/opcua/server.hpp"
#include "metier/opcua_skill/motion_device_system.hpp"
#include "metier/opcua_skill/skill_server.hpp"
#include "metier/robot_skills/arm_skills.hpp"
#include "metier/robot_skills/device_watch.hpp"
#include "metier/robot_skills/stall_watch.hpp"
#include "metrics/server_metrics.hpp"

namespace metier::server {

/// A skill that a device can have.
struct DeviceSkill {
    std::unique_ptr<skill::Skill> skill;
    std::shared_ptr<skill::Resource> resource;  ///< its skills exclude each other; none: not this
};

/// Skills that exclude each other.
std::vector<DeviceSkill> sharing(const std::shared_ptr<skill::Resource>& resource,
                                 std::vector<std::unique_ptr<skill::Skill>> skills);

/// An OPC UA server with the skills of one arm: what all servers of arms have in common.
///
/// Threading: one thread at a time makes, starts and ends it.
class SkillHost {
public:
    /// \param identity must outlive this
    /// \param nodesets besides those that every skill needs
    /// \param names of a server before this one in the same place, shared with the Programs; null:
    ///              those of the state folder
    static Result<std::unique_ptr<SkillHost>> create(
        const cell::ServerConfig& config, const Identity& identity,
        std::vector<std::string> nodesets, std::shared_ptr<skill::ExecutionNames> names = nullptr);
    /// Brakes what moves and waits until it stands, 2 s at most; then ends the server.
    ~SkillHost();
    SkillHost(const SkillHost&) = delete;
    SkillHost& operator=(const SkillHost&) = delete;

    const Clock& clock() const noexcept { return clock_; }
    opcua::AddressSpace& nodes() { return server_->nodes(); }
    opcua_skill::SkillServer& skills() { return *skills_; }
    std::string url() const { return server_->endpointUrl(); }
    std::uint16_t port() const { return server_->port(); }
    /// Endpoint URL as announced to others.
    std::string announcedUrl() const { return server::announcedUrl(config_.discovery, url()); }

    /// Shows what is known of the arm, and its live state.
    Result<void> publishArm(const opcua_skill::MotionDeviceSystem& system, const ShownArm& shown);
    /// Shows at `parent` how wide the gripper is open and whether it holds a part. `gripper` must
    /// outlive this.
    Result<void> publishGripper(const opcua::NodeId& parent, const device::Gripper& gripper);
    /// Lets clients take control of the skills below `controller`, by lease or lock.
    Result<void> offerControl(const opcua::NodeId& controller);
    /// For the Programs of the controller's skills.
    const std::shared_ptr<skill::Control>& control() const noexcept { return control_; }
    /// ApplicationUri as announced to others.
    const std::string& applicationUri() const noexcept { return application_uri_; }
    /// For the Programs of the server.
    const std::shared_ptr<skill::ExecutionNames>& names() const noexcept { return names_; }
    /// Offers those of `skills` that are `wanted`: at the nodes of the NodeSet that have their
    /// names, at new nodes below `folder` for others.
    /// Errors: not_supported (no skill of a wanted name), invalid_argument (the NodeSet has one
    ///         that is not wanted); those of SkillServer.
    Result<void> offerSkills(const opcua::NodeId& folder, const std::vector<std::string>& wanted,
                             std::vector<DeviceSkill> skills);
    /// Has the executions of a used skill recorded if its server is not one of metier's.
    std::unique_ptr<composition::UsedSkill> recorded(std::unique_ptr<composition::UsedSkill> used,
                                                     ForeignPlace place) const;
    /// Halts the skills that are offered by now when the device is lost or stops by itself, at once
    /// if it is so already. The device must outlive this. It is stopped, too, by stopOnStall().
    template <typename Device>
    void haltOnLossOf(Device& device) {
        device_watch_.emplace(device, skills_->executor(), skills_->programs());
        stopOnStall(device);
    }
    /// Stops the device while the server's thread does not work. Before start(); the device must
    /// outlive this.
    template <typename Device>
    void stopOnStall(Device& device) {
        stops_.emplace_back([&device] { device.stop(); });
    }
    /// Starts to serve, and announces the server.
    Result<void> start();

private:
    SkillHost(cell::ServerConfig config, const Identity& identity);
    Result<void> makeServer(std::vector<std::string> nodesets);
    Result<void> keepNames(const cell::ServerConfig& config);
    Result<void> watchPrograms();
    void watchStalls();

    std::optional<link::NameLock> port_lock_;  // held until the server has ended
    const cell::ServerConfig config_;
    const Identity& identity_;
    std::string application_uri_;
    SystemClock clock_;
    std::unique_ptr<ServerAccess> access_;  // none in an insecure lab
    std::unique_ptr<opcua::Server> server_;
    std::unique_ptr<ServerAudit> audit_;  // none without a state folder
    std::string controller_;              // BrowseName
    MovedDevice moved_;
    const device::Gripper* gripper_ = nullptr;
    std::unique_ptr<ServerRecords> records_;  // none if nothing is recorded
    std::unique_ptr<opcua_skill::SkillServer> skills_;
    std::shared_ptr<skill::Control> control_;       // shared with the Programs
    std::shared_ptr<skill::ExecutionNames> names_;  // shared with the Programs
    std::unique_ptr<ServerMetrics> metrics_;        // null unless an address is configured
    std::optional<robot_skills::DeviceWatch> device_watch_;
    std::vector<std::function<void()>> stops_;
    std::optional<robot_skills::StallWatch> stall_watch_;
    std::optional<Announcement> announcement_;  // ends first; none before start()
};

}  // namespace metier::server
