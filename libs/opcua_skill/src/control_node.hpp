#pragma once

#include <spdlog/logger.h>

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "metier/opcua/server.hpp"
#include "metier/skill/control.hpp"

namespace metier::opcua_skill {

/// Serves a Control at the nodes of one controller: the lease of IControlLeaseType, and the Lock of
/// the DI model. Logs each loss of control, and has it audited.
///
/// Threading: the server's thread.
class ControlNode final : public opcua::VariableHandler, private skill::Control::Listener {
public:
    /// \param server must outlive this
    /// \param log    shared with its other users, as spdlog does
    ControlNode(std::shared_ptr<skill::Control> control, opcua::Server& server,
                std::shared_ptr<spdlog::logger> log);
    ~ControlNode() override;
    ControlNode(const ControlNode&) = delete;
    ControlNode& operator=(const ControlNode&) = delete;

    /// Makes the nodes below the controller call and read the Control. Once.
    /// Errors: not_found, if the controller lacks the lease; a Lock may be missing.
    Result<void> bind(opcua::AddressSpace& nodes, const opcua::NodeId& controller);
    void sessionClosed(const opcua::Session& session);

    opcua::DataValue read(const opcua::Session& session, std::uint32_t tag) const override;
    Result<void> write(const opcua::WriteContext& writer, std::uint32_t tag,
                       const opcua::Value& value) override;

private:
    enum class Item : std::uint32_t {
        control_owner,
        control_epoch,
        lease_remaining,
        locked,
        locking_client,
        locking_user,
        remaining_lock_time,
    };
    using Values = std::vector<opcua::Value>;

    void onControlLost(std::string_view session, skill::OwnerLossAction action,
                       const std::string& text) override;
    Result<void> bindLease(opcua::AddressSpace& nodes, const opcua::NodeId& controller);
    Result<void> bindLock(opcua::AddressSpace& nodes, const opcua::NodeId& lock);
    Result<void> show(opcua::AddressSpace& nodes, const opcua::NodeId& variable, Item item);
    Result<Values> acquire(const opcua::CallContext& context, std::span<const opcua::Value> inputs);

    // Shared with the Programs of the controller.
    std::shared_ptr<skill::Control> control_;
    opcua::Server& server_;
    std::shared_ptr<spdlog::logger> log_;  // shared with its other users, as spdlog does
    opcua::NodeId controller_;
    std::vector<std::unique_ptr<opcua::VariableSlot>> slots_;
};

}  // namespace metier::opcua_skill
