#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "metier/opcua/server.hpp"
#include "metier/skill/control.hpp"

namespace metier::opcua_skill {

/// Serves a Control at the nodes of one controller: the lease of IControlLeaseType, and the Lock of
/// the DI model.
///
/// Threading: the server's thread.
class ControlNode final : public opcua::VariableHandler {
public:
    explicit ControlNode(std::shared_ptr<skill::Control> control) : control_(std::move(control)) {}

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

    Result<void> bindLease(opcua::AddressSpace& nodes, const opcua::NodeId& controller);
    Result<void> bindLock(opcua::AddressSpace& nodes, const opcua::NodeId& lock);
    Result<void> show(opcua::AddressSpace& nodes, const opcua::NodeId& variable, Item item);
    Result<Values> acquire(const opcua::CallContext& context, std::span<const opcua::Value> inputs);

    // Shared with the Programs of the controller.
    std::shared_ptr<skill::Control> control_;
    std::vector<std::unique_ptr<opcua::VariableSlot>> slots_;
};

}  // namespace metier::opcua_skill
