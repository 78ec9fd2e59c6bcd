#include "survey.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "arm_json.hpp"
#include "metier/client/skill_references.hpp"
#include "metier/opcua/text.hpp"
#include "metier/opcua_skill/namespaces.hpp"
#include "transitions.hpp"

namespace metier::dashboard {
namespace {

using client::AsyncSkill;
using client::KinematicsNodes;
using client::SkillAddress;
using opcua::Answer;
using opcua::NodeId;

const NodeId kServerArray{0, 2254U};

std::string applicationUri(opcua::Client& client) {
    const auto value = client.read(kServerArray);
    const auto uris = value ? value->as<std::vector<std::string>>()
                            : Result<std::vector<std::string>>(std::vector<std::string>{});
    return uris && !uris->empty() ? opcua::sanitise(uris->front()) : "";
}

/// Time of the last transition, s since 1970 UTC; 0 if the server does not publish it.
double lastTransition(opcua::Client& client, const NodeId& skill) {
    const auto node = client.translate(skill, {{0, "LastTransition"}, {0, "TransitionTime"}});
    const auto value = node ? client.read(*node) : Answer<opcua::Value>();
    const auto time = value ? value->as<UtcTime>() : Result<UtcTime>(UtcTime{});
    return time && *time > UtcTime{} ? secondsOf(*time) : 0.0;
}

}  // namespace

Answer<> Survey::run() {
    auto& client = link_.client();
    METIER_ASSIGN(const auto skills, client::findSkills(client));
    link_.offer_.application_uri = applicationUri(client);
    link_.offer_.uses.insert(context_.server.uses.begin(), context_.server.uses.end());
    for (const auto& address : skills) {
        METIER_TRY(add(address));
    }
    if (!link_.arms_.empty()) {
        link_.offer_.arm = link_.arms_.front().key;
    }
    if (const auto& gripper = context_.server.gripper) {
        link_.offer_.gripper = {
            {"arm", gripper->on.empty() ? nlohmann::json() : nlohmann::json(gripper->on)},
            {"frame", frameJson(gripper->flange_from_jaws)},
            {"stroke", stroke()}};
    }
    subscribeAlarms();
    return {};
}

double Survey::stroke() {
    auto& client = link_.client();
    const auto metier = client.namespaceIndex(opcua_skill::kMetierUri);
    for (const auto& controller : metier ? link_.controllers_ : std::vector<LinkedController>()) {
        const auto node = client.translate(controller.node, {{*metier, "GripperStroke"}});
        const auto value = node ? client.read(*node) : Answer<opcua::Value>();
        if (const auto metres = value ? value->as<double>() : Result<double>(0.0);
            metres && *metres > 0.0) {
            return rounded(*metres);
        }
    }
    return strokeIn(link_.offer_.skills);
}

std::string Survey::uniqueKey(const SkillAddress& address) const {
    const auto key =
        fmt::format("{}/{}/{}", context_.server.name, address.controllerName(), address.name);
    auto unique = key;
    for (int number = 2; link_.find(unique) != nullptr; ++number) {
        unique = fmt::format("{}#{}", key, number);
    }
    return unique;
}

Answer<> Survey::add(const SkillAddress& address) {
    METIER_ASSIGN(auto arm, armOf(address, noteUses(address)));
    auto halt = client::findMethod(link_.client(), address, skill::Method::halt);
    if (!halt && halt.error().status != opcua::status::kBadNoMatch) {
        return tl::unexpected(std::move(halt.error()));
    }
    METIER_ASSIGN(auto control, addController(address));
    LinkedSkill linked{uniqueKey(address), address, std::move(control),
                       halt.value_or(opcua::NodeId()), nullptr};
    METIER_ASSIGN(auto skill, AsyncSkill::open(link_.client(), address,
                                               {transitionsTo(context_.board, linked.key)}));
    link_.offer_.skills.push_back(skillJson(linked.key, context_.server.name, skill, arm));
    linked.skill = std::make_unique<AsyncSkill>(std::move(skill));
    readState(linked);
    link_.skills_.push_back(std::move(linked));
    return {};
}

Answer<std::string> Survey::addController(const SkillAddress& address) {
    const auto* controller = address.controller();
    const auto node = controller == nullptr ? NodeId() : controller->node;
    const auto name = address.controllerName();
    auto key = fmt::format("{}/{}", context_.server.name, name);
    auto& known = link_.controllers_;
    const bool is_known =
        std::any_of(known.begin(), known.end(), [&](const auto& one) { return one.node == node; });
    if (!is_known) {
        METIER_ASSIGN(const bool has_leases, leases(node));
        known.push_back({key, name, node, has_leases});
        context_.board.changeControl(key, [&](ControlState& state) {
            state.server = context_.server.name;
            state.controller = name;
        });
    }
    return key;
}

Answer<bool> Survey::leases(const NodeId& controller) {
    auto& client = link_.client();
    if (controller.isNull()) {
        return false;
    }
    const auto metier = client.namespaceIndex(opcua_skill::kMetierUri);
    if (!metier) {
        return metier.error().code == Errc::not_found ? Answer<bool>(false)
                                                      : tl::unexpected(metier.error());
    }
    const auto method = client.translate(controller, {{*metier, "AcquireControl"}});
    if (!method && method.error().status != opcua::status::kBadNoMatch) {
        return tl::unexpected(method.error());
    }
    return method.has_value();
}

Answer<MovedArm> Survey::armOf(const SkillAddress& address, const std::string& used) {
    const auto* controller = address.controller();
    const auto node = controller == nullptr ? address.node : controller->node;
    if (const auto known = arms_by_controller_.find(node); known != arms_by_controller_.end()) {
        return known->second;
    }
    const auto kinematics = client::findKinematics(link_.client(), address);
    if (!kinematics && kinematics.error().code != Errc::not_found) {
        return tl::unexpected(kinematics.error());
    }
    auto arm = kinematics ? addArm(*kinematics, used) : Answer<MovedArm>(MovedArm{});
    if (arm) {
        arms_by_controller_[node] = *arm;
    }
    return arm;
}

std::string Survey::noteUses(const SkillAddress& address) {
    auto reader = client::ReferenceReader::create(link_.client());
    const auto references = reader ? reader->read(address.node) : Answer<client::SkillReferences>();
    std::string first;
    for (const auto& use : references ? references->uses : std::vector<client::SkillUse>()) {
        const auto used = use.endpoint_url.empty() ? "" : context_.server_at(use.endpoint_url);
        if (used.empty() || used == context_.server.name) {
            continue;
        }
        first = first.empty() ? used : first;
        link_.offer_.uses.insert(used);
    }
    return first;
}

Answer<MovedArm> Survey::addArm(const KinematicsNodes& nodes, const std::string& used) {
    if (const auto known = arms_by_object_.find(nodes.object); known != arms_by_object_.end()) {
        return known->second;
    }
    METIER_ASSIGN(const auto data, client::readKinematics(link_.client(), nodes));
    const auto& name = context_.server.name;
    const auto& configured = context_.server.arm_of;
    const auto& owner = configured.empty() ? used : configured;
    MovedArm arm{owner, data.axisCount(), data.tool_frames};
    if (owner.empty()) {
        arm.key = link_.arms_.empty() ? name : fmt::format("{}/{}", name, nodes.device_name);
        link_.offer_.arms.push_back(
            armJson({arm.key, name, nodes.device_name, context_.server.world_from_base}, data,
                    context_.models));
        link_.arms_.push_back({arm.key, nodes});
    }
    arms_by_object_[nodes.object] = arm;
    return arm;
}

void Survey::readState(const LinkedSkill& linked) {
    const auto now = linked.skill->now();
    if (!now) {
        return;  // the next transition updates it
    }
    const auto since = lastTransition(link_.client(), linked.address.node);
    context_.board.changeSkill(linked.key, [&](SkillState& state) {
        if (state.state != "Unknown") {
            return;  // a transition was quicker
        }
        state.state = toString(now->state);
        state.reason_text = opcua::sanitise(now->reason_text);
        state.execution = opcua::sanitise(now->execution_id);
        state.since = since;
    });
}

void Survey::subscribeAlarms() {
    opcua::EventFilter filter{.fields = {{{0, "Message"}}, {{0, "Severity"}}, {{0, "Time"}}},
                              .of_type = opcua::ids::kSystemEventType};
    auto subscribed = link_.client().subscribeEvents(
        opcua::ids::kServer, std::move(filter),
        [&board = context_.board, server = context_.server.name](const opcua::EventNotice& notice) {
            if (const auto alarm = alarmOf(server, notice)) {
                board.raise(*alarm);
            }
        });
    if (subscribed) {
        link_.alarms_ = std::move(*subscribed);
    }
}

}  // namespace metier::dashboard
