#pragma once

#include <memory>
#include <string>

#include "host/skill_host.hpp"
#include "metier/base/error.hpp"
#include "metier/cell/cell.hpp"
#include "metier/device/driver.hpp"
#include "metier/server/server.hpp"

namespace metier::server {

/// A gripper behind its OPC UA server: the instances of its NodeSet, served by its skills.
///
/// Threading: one thread starts and ends it.
class GripperServer final : public Server {
public:
    /// Errors: what is wrong with the driver, the NodeSet, the skills or the port.
    /// \param gripper of `config`
    static Result<std::unique_ptr<GripperServer>> start(const cell::ServerConfig& config,
                                                        const cell::GripperServer& gripper,
                                                        const Context& context);

    std::string url() const override { return host_->url(); }

private:
    GripperServer(device::OpenDevice device, std::unique_ptr<SkillHost> host);
    Result<void> offer(const cell::GripperServer& config);

    device::OpenDevice device_;
    std::unique_ptr<SkillHost> host_;  // ends before the device
};

}  // namespace metier::server
