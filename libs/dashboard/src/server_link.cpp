#include "server_link.hpp"

#include <algorithm>
#include <utility>

#include "metier/opcua/text.hpp"
#include "metier/opcua_skill/namespaces.hpp"
#include "metier/opcua_skill/safety_state_kind.hpp"
#include "survey.hpp"

namespace metier::dashboard {
namespace {

using namespace std::chrono_literals;
using opcua::Answer;

constexpr auto kJoints = 33ms;  // 30 Hz
constexpr auto kStates = 100ms;
constexpr auto kSlow = 500ms;

}  // namespace

Answer<std::shared_ptr<ServerLink>> ServerLink::open(
    const LinkContext& context, opcua::ClientOptions options,
    std::function<void(const opcua::Failure&)> on_lost) {
    options.publishing_interval = kJoints;
    METIER_ASSIGN(auto client, opcua::Client::connect(context.server.url, std::move(options)));
    std::shared_ptr<ServerLink> link(new ServerLink(std::move(client)));  // NOLINT: private
    link->client_->onConnectionLost(std::move(on_lost));
    link->board_ = &context.board;
    link->server_ = context.server.name;
    METIER_TRY(Survey(context, *link).run());
    return link;
}

const LinkedSkill* ServerLink::find(const std::string& key) const {
    const auto found = std::find_if(skills_.begin(), skills_.end(),
                                    [&](const LinkedSkill& skill) { return skill.key == key; });
    return found == skills_.end() ? nullptr : &*found;
}

void ServerLink::showLive(bool shown) {
    live_.clear();
    if (!shown) {
        return;
    }
    for (const auto& arm : arms_) {
        showArm(arm);
    }
    for (const auto& controller : controllers_) {
        showController(controller);
    }
    for (const auto& skill : skills_) {
        showSkill(skill);
    }
}

opcua::NodeId ServerLink::below(const opcua::NodeId& object,
                                std::vector<opcua::QualifiedName> path) {
    return client_->translate(object, std::move(path)).value_or(opcua::NodeId());
}

/// Subscribes to a Variable. One that the server lacks, or does not let us read, is not shown.
template <typename T>
void ServerLink::subscribe(const opcua::NodeId& node, std::chrono::milliseconds interval,
                           std::function<void(const T&, UtcTime)> callback) {
    if (node.isNull()) {
        return;
    }
    auto subscribed =
        client_->subscribeData(node, {.sampling_interval = interval},
                               [callback = std::move(callback)](const opcua::DataValue& now) {
                                   if (const auto value = now.value.as<T>()) {
                                       callback(*value, now.source_time);
                                   }
                               });
    if (subscribed) {
        live_.push_back(std::move(*subscribed));
    }
}

template <typename T>
void ServerLink::subscribeLive(const opcua::NodeId& node, std::chrono::milliseconds interval,
                               std::function<void(LiveValues&, const T&, UtcTime)> change) {
    subscribe<T>(node, interval,
                 [&board = *board_, change = std::move(change)](const T& value, UtcTime time) {
                     board.changeLive([&](LiveValues& live) { change(live, value, time); });
                 });
}

void ServerLink::showArm(const Arm& arm) {
    using Numbers = std::vector<double>;
    const auto& key = arm.key;
    subscribeLive<Numbers>(arm.nodes.actual_joint_position, kJoints,
                           [key](LiveValues& live, const Numbers& joints, UtcTime time) {
                               if (!joints.empty()) {
                                   live.setJoints(key, joints, time);
                               }
                           });
    subscribeLive<Numbers>(arm.nodes.commanded_joint_position, kJoints,
                           [key](LiveValues& live, const Numbers& joints, UtcTime /*time*/) {
                               live.setOfArm(key, "c", rounded(joints));
                           });
    subscribeLive<Numbers>(
        arm.nodes.flange_force, kJoints,
        [key](LiveValues& live, const Numbers& force, UtcTime) { live.setForce(key, force); });
    subscribeLive<Numbers>(
        arm.nodes.flange_torque, kJoints,
        [key](LiveValues& live, const Numbers& torque, UtcTime) { live.setTorque(key, torque); });
    showCycles(arm);
}

void ServerLink::showCycles(const Arm& arm) {
    const auto& key = arm.key;
    subscribeLive<std::int32_t>(
        arm.nodes.safety_state, kStates,
        [key](LiveValues& live, std::int32_t kind, UtcTime /*time*/) {
            live.setOfArm(key, "safety", std::string(nameOf(opcua_skill::SafetyStateKind(kind))));
        });
    subscribeLive<double>(arm.nodes.cycle_jitter, kStates,
                          [key](LiveValues& live, double seconds, UtcTime /*time*/) {
                              live.setOfArm(key, "jitter", rounded(seconds));
                          });
    subscribeLive<std::uint64_t>(arm.nodes.missed_cycles, kSlow,
                                 [key](LiveValues& live, std::uint64_t missed, UtcTime /*time*/) {
                                     live.setOfArm(key, "missed", missed);
                                 });
}

void ServerLink::showController(const LinkedController& controller) {
    const auto metier = client_->namespaceIndex(opcua_skill::kMetierUri);
    if (!metier) {
        return;
    }
    auto& board = *board_;
    subscribe<std::string>(
        below(controller.node, {{*metier, "ControlOwner"}}), kStates,
        [&board, key = controller.key](const std::string& name, UtcTime /*time*/) {
            board.changeControl(key,
                                [&](ControlState& state) { state.owner = opcua::sanitise(name); });
        });
    subscribe<double>(below(controller.node, {{*metier, "LeaseRemaining"}}), kSlow,
                      [&board, key = controller.key](double left, UtcTime time) {
                          board.changeControl(key, [&](ControlState& state) {
                              state.lease_ms = rounded(left);
                              state.until =
                                  left > 0.0 ? secondsOf(time) + rounded(left) / 1e3 : 0.0;
                          });
                      });
    showGripper(controller.node, *metier);
}

void ServerLink::showGripper(const opcua::NodeId& object, std::uint16_t metier) {
    subscribeLive<bool>(below(object, {{metier, "PartHeld"}}), kStates,
                        [key = server_](LiveValues& live, bool held, UtcTime /*time*/) {
                            live.setOfGripper(key, "held", held);
                        });
    subscribeLive<double>(below(object, {{metier, "GripperWidth"}}), kJoints,
                          [key = server_](LiveValues& live, double width, UtcTime /*time*/) {
                              live.setOfGripper(key, "width", rounded(width));
                          });
    subscribeLive<double>(below(object, {{metier, "GripperForce"}}), kStates,
                          [key = server_](LiveValues& live, double force, UtcTime /*time*/) {
                              live.setOfGripper(key, "force", rounded(force));
                          });
}

void ServerLink::showSkill(const LinkedSkill& skill) {
    const auto metier = client_->namespaceIndex(opcua_skill::kMetierUri);
    if (!metier) {
        return;
    }
    auto& board = *board_;
    const auto& node = skill.address.node;
    const auto onText = [&board, key = skill.key](std::string SkillState::*part,
                                                  const std::string& text) {
        board.changeSkill(key, [&](SkillState& state) {
            if (state.state == "Running" || part != &SkillState::sub_state) {
                state.*part = opcua::sanitise(text);
            }
        });
    };
    subscribe<opcua::LocalizedText>(
        below(node, {{*metier, "RunningSubStates"}, {0, "CurrentState"}}), kStates,
        [onText](const opcua::LocalizedText& text, UtcTime /*time*/) {
            if (!text.text.empty()) {
                onText(&SkillState::sub_state, text.text);
            }
        });
    subscribe<std::string>(
        below(node, {{*metier, "CurrentStep"}}), kStates,
        [onText](const std::string& text, UtcTime /*time*/) { onText(&SkillState::step, text); });
    subscribe<double>(below(node, {{*metier, "Progress"}}), kStates,
                      [&board, key = skill.key](double part, UtcTime /*time*/) {
                          board.changeSkill(
                              key, [&](SkillState& state) { state.progress = rounded(part); });
                      });
}

}  // namespace metier::dashboard
