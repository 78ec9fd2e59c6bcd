#include "control_node.hpp"

#include <fmt/format.h>

#include <array>
#include <functional>
#include <utility>

#include "metier/opcua_skill/wire_numbers.hpp"
#include "model_ids.hpp"
#include "owner_loss.hpp"
#include "skill_node.hpp"

namespace metier::opcua_skill {

namespace {

using opcua::AddressSpace;
using opcua::CallContext;
using opcua::NodeId;
using opcua::Value;
using Inputs = std::span<const Value>;

/// A Method of a controller.
struct Call {
    const char* name;
    opcua::MethodHandler handler;
    opcua::MethodEffect effect = opcua::MethodEffect::commands;
};

Result<void> setAll(AddressSpace& nodes, const NodeId& parent, std::uint16_t index,
                    std::span<const Call> calls) {
    for (const auto& call : calls) {
        METIER_ASSIGN(const auto method, nodes.find(parent, {index, call.name}));
        METIER_TRY(nodes.setMethod(method, call.handler, call.effect));
    }
    return {};
}

double milliseconds(std::chrono::nanoseconds time) {
    return std::chrono::duration<double, std::milli>(time).count();
}

/// Work of a Method of the lock, which returns a status.
template <typename Work>
opcua::MethodHandler withStatus(std::shared_ptr<skill::Control> control, Work work) {
    return [control, work](const CallContext& context, Inputs /*inputs*/) {
        const auto outcome = std::invoke(work, *control, callerOf(context.session));
        const auto status = outcome ? LockStatus::done : LockStatus::refused;
        return Result<std::vector<Value>>({Value::of(static_cast<std::int32_t>(status))});
    };
}

/// Work of Heartbeat and ReleaseControl with the epoch in their argument.
template <typename Work>
opcua::MethodHandler withEpoch(std::shared_ptr<skill::Control> control, Work work) {
    return
        [control, work](const CallContext& context, Inputs inputs) -> Result<std::vector<Value>> {
            METIER_ASSIGN(const auto epoch, inputs[0].as<std::uint64_t>());
            METIER_TRY(std::invoke(work, *control, callerOf(context.session), epoch));
            return std::vector<Value>();
        };
}

}  // namespace

ControlNode::ControlNode(std::shared_ptr<skill::Control> control, opcua::Server& server,
                         std::shared_ptr<spdlog::logger> log)
    : control_(std::move(control)), server_(server), log_(std::move(log)) {
    control_->attach(*this);
}

ControlNode::~ControlNode() {
    control_->detach(*this);
}

void ControlNode::onControlLost(std::string_view session, skill::OwnerLossAction action,
                                const std::string& text) {
    server_.audit({.object = controller_,
                   .event = "ControlLost",
                   .text = fmt::format("{}; session {}, OnOwnerLoss {}", text, session,
                                       skill::toString(action))});
    log_->warn("control of {} is lost: {}", controller_.toString(), text);
}

Result<void> ControlNode::bind(AddressSpace& nodes, const NodeId& controller) {
    controller_ = controller;
    METIER_TRY(bindLease(nodes, controller));
    const auto di = nodes.namespaceIndex(kDiUri);
    const auto lock = di ? nodes.find(controller, {*di, "Lock"}) : Result<NodeId>(fail(di.error()));
    return lock ? bindLock(nodes, *lock) : Result<void>{};
}

Result<void> ControlNode::bindLease(AddressSpace& nodes, const NodeId& controller) {
    METIER_ASSIGN(const auto metier, nodes.namespaceIndex(kMetierUri));
    const std::array calls{
        Call{"AcquireControl", [this](const CallContext& context,
                                      Inputs inputs) { return acquire(context, inputs); }},
        Call{"Heartbeat", withEpoch(control_, &skill::Control::heartbeat),
             opcua::MethodEffect::renews},
        Call{"ReleaseControl", withEpoch(control_, &skill::Control::release)},
    };
    METIER_TRY(setAll(nodes, controller, metier, calls));
    for (const auto& [name, item] : {std::pair{"ControlOwner", Item::control_owner},
                                     {"ControlEpoch", Item::control_epoch},
                                     {"LeaseRemaining", Item::lease_remaining}}) {
        METIER_ASSIGN(const auto variable, nodes.find(controller, {metier, name}));
        METIER_TRY(show(nodes, variable, item));
    }
    return {};
}

Result<void> ControlNode::bindLock(AddressSpace& nodes, const NodeId& lock) {
    METIER_ASSIGN(const auto index, nodes.namespaceIndex(kDiUri));
    const std::array calls{
        Call{"InitLock", withStatus(control_, &skill::Control::lock)},
        Call{"RenewLock", withStatus(control_, &skill::Control::renewLock),
             opcua::MethodEffect::renews},
        Call{"ExitLock", withStatus(control_, &skill::Control::unlock)},
        Call{"BreakLock",
             withStatus(control_, [](skill::Control& control,
                                     const skill::Caller&) { return control.breakLock(); })},
    };
    METIER_TRY(setAll(nodes, lock, index, calls));
    for (const auto& [name, item] : {std::pair{"Locked", Item::locked},
                                     {"LockingClient", Item::locking_client},
                                     {"LockingUser", Item::locking_user},
                                     {"RemainingLockTime", Item::remaining_lock_time}}) {
        METIER_ASSIGN(const auto variable, nodes.find(lock, {index, name}));
        METIER_TRY(show(nodes, variable, item));
    }
    return {};
}

Result<void> ControlNode::show(AddressSpace& nodes, const NodeId& variable, Item item) {
    slots_.push_back(std::make_unique<opcua::VariableSlot>(
        opcua::VariableSlot{this, static_cast<std::uint32_t>(item)}));
    return nodes.setHandler(variable, *slots_.back());
}

Result<ControlNode::Values> ControlNode::acquire(const CallContext& context, Inputs inputs) {
    METIER_ASSIGN(const auto lease, inputs[0].as<std::uint32_t>());
    METIER_ASSIGN(const auto action, inputs[1].as<std::int32_t>());
    METIER_ASSIGN(const auto on_loss, ownerLossActionFrom(action));
    return control_->acquire(callerOf(context.session), std::chrono::milliseconds(lease), on_loss)
        .map([](std::uint64_t epoch) { return Values{Value::of(epoch)}; });
}

void ControlNode::sessionClosed(const opcua::Session& session) {
    control_->sessionClosed(session.id.toString());
}

opcua::DataValue ControlNode::read(const opcua::Session& /*session*/, std::uint32_t tag) const {
    const auto value = [this, tag] {
        switch (static_cast<Item>(tag)) {
            case Item::control_owner:
                return Value::of(control_->holder().client_name);
            case Item::control_epoch:
                return Value::of(control_->epoch());
            case Item::lease_remaining:
                return Value::of(milliseconds(control_->leaseRemaining()));
            case Item::locked:
                return Value::of(control_->isLocked());
            case Item::locking_client:
                return Value::of(control_->locker().client_name);
            case Item::locking_user:
                return Value::of(control_->locker().user_name);
            case Item::remaining_lock_time:
                return Value::of(milliseconds(control_->lockRemaining()));
        }
        return Value();
    };
    return {value()};
}

Result<void> ControlNode::write(const opcua::WriteContext& /*writer*/, std::uint32_t /*tag*/,
                                const Value& /*value*/) {
    return fail(Errc::access_denied, "control is taken by its methods");
}

}  // namespace metier::opcua_skill
