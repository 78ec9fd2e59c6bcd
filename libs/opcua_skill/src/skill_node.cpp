#include "skill_node.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <utility>

#include "diagnostic.hpp"
#include "metier/opcua_skill/arm_places.hpp"
#include "metier/opcua_skill/start_keys.hpp"
#include "metier/opcua_skill/values.hpp"
#include "owner_loss.hpp"
#include "value_part.hpp"

namespace metier::opcua_skill {

namespace {

using opcua::DataValue;
using opcua::LocalizedText;
using opcua::NodeId;
using opcua::Session;
using opcua::Value;

constexpr std::size_t kLongestParent = 256;
constexpr std::uint16_t kInformation = 100;  // severity
/// Numbers of the states of FinishStateMachineType (published 2020).
constexpr std::uint32_t kForceExceeded = 8;
constexpr std::uint32_t kSuccess = 9;

template <typename Name>
LocalizedText textOf(Name name) {
    return {"en", std::string(skill::toString(name))};
}

const skill::Field& fieldOf(const skill::Program& program, NodeRole node_role) {
    const auto& description = program.description();
    return (isOfResult(node_role.kind) ? description.results
                                       : description.parameters)[node_role.field];
}

/// Whether a force over its limit ended the execution that has this result.
bool metForce(const skill::ValueMap& result) {
    const auto found = result.find("ForcesExceeded");
    const auto* force =
        found == result.end() ? nullptr : std::get_if<skill::Vector3>(&found->second);
    return force != nullptr && *force != skill::Vector3{};
}

/// A NodeRole fits into the tag of its Variable.
std::uint32_t tagOf(NodeRole node_role) {
    return static_cast<std::uint32_t>(node_role.kind) << 24U |
           static_cast<std::uint32_t>(node_role.detail) << 16U | node_role.field;
}

NodeRole nodeRoleOf(std::uint32_t tag) {
    return {static_cast<NodeKind>(tag >> 24U), static_cast<std::uint8_t>((tag >> 16U) & 0xFFU),
            static_cast<std::uint16_t>(tag)};
}

Part partIn(NodeRole node_role) {
    return static_cast<Part>(node_role.detail);
}

/// Outputs of Check. EndJointPositions is Null if it is not known which arms move.
std::vector<Value> outputsOf(const skill::CheckReport& report) {
    return {Value::of(report.possible),
            Value::of(report.reason),
            Value::of(report.first_failing_fraction),
            Value::of(report.planned_duration),
            Value::ofRows(report.joint_path),
            Value::of(report.stopping_time),
            Value::of(report.stopping_distance),
            Value::of(report.code),
            report.ends_known ? Value::of(opcua_skill::pairsOf(report.ends, kEndJointPosition))
                              : Value(),
            Value::of(report.notes)};
}

}  // namespace

void Refusals::refused(const Session& session, const SkillNode& skill, std::string text) {
    last_.insert_or_assign(session.id, Entry{&skill, std::move(text)});
}

void Refusals::accepted(const Session& session, const SkillNode& skill) {
    const auto found = last_.find(session.id);
    if (found != last_.end() && found->second.skill == &skill) {
        last_.erase(found);
    }
}

const std::string* Refusals::find(const Session& session, const SkillNode& skill) const {
    const auto found = last_.find(session.id);
    return found == last_.end() || found->second.skill != &skill ? nullptr : &found->second.text;
}

skill::Caller callerOf(const Session& session) {
    return {session.id.toString(), session.application_name, session.user, session.thumbprint};
}

SkillNode::SkillNode(NodeId id, std::unique_ptr<skill::Program> program, SkillContext& context)
    : id_(std::move(id)), context_(context), program_(std::move(program)) {
    program_->attach(*this);
}

SkillNode::~SkillNode() {
    program_->detach(*this);
}

Result<void> SkillNode::bind(opcua::AddressSpace& nodes, const std::vector<BoundNode>& bound) {
    slots_.reserve(bound.size());
    for (const auto& [node, node_role] : bound) {
        METIER_TRY(bindNode(nodes, node, node_role));
    }
    return {};
}

Result<void> SkillNode::bindNode(opcua::AddressSpace& nodes, const NodeId& node,
                                 NodeRole node_role) {
    switch (node_role.kind) {
        case NodeKind::method:
            return bindMethod(nodes, node, static_cast<skill::Method>(node_role.detail));
        case NodeKind::check:
            return nodes.setMethod(node, [this](const opcua::CallContext& context, auto inputs) {
                return check(context.session, inputs);
            });
        case NodeKind::get_execution:
            return nodes.setMethod(
                node,
                [this](const opcua::CallContext& /*context*/, auto inputs) {
                    return getExecution(inputs);
                },
                opcua::MethodEffect::tells);
        case NodeKind::parameter_unit:
        case NodeKind::result_unit:
            return nodes.write(node, Value::of(toOpcua(fieldOf(*program_, node_role).unit)));
        case NodeKind::parameter_range:
        case NodeKind::result_range:
            return nodes.write(node, Value::of(*fieldOf(*program_, node_role).range));
        default:
            if (node_role.kind == NodeKind::parameter && !fieldOf(*program_, node_role).range) {
                limits_.add(nodes, node, node_role);
            }
            slots_.push_back({this, tagOf(node_role)});
            return nodes.setHandler(node, slots_.back());
    }
}

Result<void> SkillNode::bindMethod(opcua::AddressSpace& nodes, const NodeId& node,
                                   skill::Method method) {
    METIER_TRY(nodes.setMethod(
        node, [this, method](const opcua::CallContext& context, std::span<const Value> inputs) {
            return method == skill::Method::start_with
                       ? startWith(context.session, inputs)
                       : call(context.session, method).map([] { return std::vector<Value>(); });
        }));
    return nodes.setExecutable(node, [this, method](const Session& session) {
        return program_->executable(method, callerOf(session));
    });
}

void SkillNode::sessionClosed(const Session& session) {
    program_->sessionClosed(session.id.toString());
    checks_.sessionClosed(session.id);
}

DataValue SkillNode::read(const Session& session, std::uint32_t tag) const {
    const auto node_role = nodeRoleOf(tag);
    switch (node_role.kind) {
        case NodeKind::state:
        case NodeKind::state_id:
        case NodeKind::state_number:
            return {readState(node_role), {}, program_->diagnostic().last_transition_time};
        case NodeKind::transition:
        case NodeKind::transition_id:
        case NodeKind::transition_number:
        case NodeKind::transition_time:
            return readTransition(node_role);
        case NodeKind::sub_state:
        case NodeKind::sub_state_id:
        case NodeKind::sub_state_number:
            return readSubState(node_role);
        case NodeKind::finish:
        case NodeKind::finish_id:
        case NodeKind::finish_number:
            return readFinish(node_role);
        case NodeKind::parameter:
            return {readParameter(node_role)};
        case NodeKind::result:
            return readResult(node_role);
        case NodeKind::diagnostic:
            return {diagnosticItems()[node_role.detail].read(toOpcua(program_->diagnostic()))};
        case NodeKind::reason_text:
            return {Value::of(readReason(session))};
        case NodeKind::name:
            return {Value::of(program_->description().name)};
        case NodeKind::execution_id:
            return {Value::of(program_->executionId())};
        case NodeKind::steps:
            return {Value::of(program_->description().steps)};
        case NodeKind::current_step:
            return {Value::of(program_->step())};
        case NodeKind::progress: {
            const auto* progress = std::get_if<double>(&program_->intermediate());
            return {Value::of(progress == nullptr ? 0.0 : *progress)};
        }
        default:
            return {{}, opcua::status::kBadInternalError};
    }
}

/// Why the session's last command was refused, and in any case why the skill is Halted.
std::string SkillNode::readReason(const Session& session) const {
    const auto& reason = program_->reasonText();
    const auto* refusal = context_.refusals.find(session, *this);
    if (refusal == nullptr) {
        return reason;
    }
    const bool halted = program_->state() == skill::State::halted;
    return !halted || reason.empty() || refusal->find(reason) != std::string::npos
               ? *refusal
               : fmt::format("{}; it is Halted: {}", *refusal, reason);
}

Value SkillNode::readState(NodeRole node_role) const {
    const auto state = program_->state();
    switch (node_role.kind) {
        case NodeKind::state_id:
            return Value::of(stateId(state));
        case NodeKind::state_number:
            return Value::of(static_cast<std::uint32_t>(state));
        default:
            return Value::of(textOf(state));
    }
}

DataValue SkillNode::readTransition(NodeRole node_role) const {
    const auto& last = program_->lastTransition();
    // As a sub-state: a Bad status comes with a value all the same.
    const auto status = last ? opcua::StatusCode() : opcua::status::kBadNoData;
    const auto time = program_->diagnostic().last_transition_time;
    switch (node_role.kind) {
        case NodeKind::transition_id:
            return {Value::of(last ? transitionId(last->number) : NodeId()), status, time};
        case NodeKind::transition_number:
            return {Value::of(last ? static_cast<std::uint32_t>(last->number) : 0U), status, time};
        case NodeKind::transition_time:
            return {Value::of(last ? last->time : UtcTime::min()), status, time};
        default:
            return {Value::of(last ? textOf(last->number) : LocalizedText()), status, time};
    }
}

DataValue SkillNode::readSubState(NodeRole node_role) const {
    const auto sub_state = program_->subState();
    const bool active = static_cast<std::uint8_t>(program_->state()) == node_role.detail &&
                        sub_state != skill::SubState::none;
    // A Bad status comes with a value all the same: 1.4.18 gives an empty one a status of its own.
    const auto status = active ? opcua::StatusCode() : opcua::status::kBadStateNotActive;
    switch (node_role.kind) {
        case NodeKind::sub_state_id:
            return {Value::of(active ? context_.ids.sub_states.at(sub_state) : NodeId()), status};
        case NodeKind::sub_state_number:
            return {Value::of(active ? numberOf(sub_state) : 0U), status};
        default:
            return {Value::of(active ? textOf(sub_state) : LocalizedText()), status};
    }
}

DataValue SkillNode::readFinish(NodeRole node_role) const {
    const auto& last = program_->lastTransition();
    const bool finished = last && last->number == skill::TransitionNumber::running_to_ready;
    const bool halted_by_force = program_->subState() == skill::SubState::halted_force;
    const bool active = finished || halted_by_force;
    const bool by_force = halted_by_force || metForce(program_->finalResult());
    const auto status = active ? opcua::StatusCode() : opcua::status::kBadStateNotActive;
    const auto of = [&](auto success, auto exceeded) {
        const auto& state = by_force ? exceeded : success;
        return active ? state : decltype(success)();
    };
    switch (node_role.kind) {
        case NodeKind::finish_id:
            return {Value::of(of(context_.ids.success, context_.ids.force_exceeded)), status};
        case NodeKind::finish_number:
            return {Value::of(of(kSuccess, kForceExceeded)), status};
        default:
            return {
                Value::of(of(LocalizedText{"en", "Success"}, LocalizedText{"en", "ForceExceeded"})),
                status};
    }
}

Value SkillNode::readParameter(NodeRole node_role) const {
    const auto value = program_->read(fieldOf(*program_, node_role).name);
    return value ? partOf(*value, partIn(node_role)) : Value();
}

DataValue SkillNode::readResult(NodeRole node_role) const {
    const auto& result = program_->finalResult();
    const auto found = result.find(fieldOf(*program_, node_role).name);
    auto value = found == result.end() ? Value() : partOf(found->second, partIn(node_role));
    const auto status = value.isEmpty() ? opcua::status::kBadNoData : opcua::StatusCode();
    return {std::move(value), status};
}

Result<void> SkillNode::write(const opcua::WriteContext& writer, std::uint32_t tag,
                              const Value& value) {
    const auto& session = writer.session;
    const auto node_role = nodeRoleOf(tag);
    if (node_role.kind != NodeKind::parameter) {
        return fail(Errc::access_denied, "only parameters can be written");
    }
    const auto& field = fieldOf(*program_, node_role);
    auto old = program_->read(field.name);
    auto taken = withPart(field, old.value_or(skill::Value()), partIn(node_role), value);
    auto within = taken ? limits_.check(node_role.field, field, *taken) : fail(taken.error());
    if (!within) {
        return remember(session, std::move(within));
    }
    return remember(session, program_->write(callerOf(session), field.name, std::move(*taken),
                                             writer.source_time));
}

Result<void> SkillNode::call(const Session& session, skill::Method method) {
    using skill::Program;
    // In the order of skill::Method, without StartWith, which has arguments.
    constexpr std::array kCommands{&Program::start, &Program::suspend, &Program::resume,
                                   &Program::halt, &Program::reset};
    const auto command = kCommands.at(static_cast<std::size_t>(method));
    return remember(session, std::invoke(command, *program_, callerOf(session)));
}

Result<void> SkillNode::takeGiven(const opcua::KeyValue& given, Given& into) const {
    const auto& name = given.key.name;
    const auto& fields = program_->description().parameters;
    const auto field = std::find_if(fields.begin(), fields.end(),
                                    [&](const auto& candidate) { return candidate.name == name; });
    const bool is_field = field != fields.end();
    const bool is_parent = !is_field && (name == kParentExecution || name == kParentServer);
    if (!is_field && !is_parent) {
        METIER_ASSIGN(const bool is_start, takeStart(given, into));
        if (is_start) {
            return {};
        }
        return fail(Errc::invalid_argument, fmt::format("no parameter {}", name));
    }
    auto taken = fromOpcua(given.value, is_field ? field->type : skill::ValueType::text);
    if (!taken) {
        return fail(taken.error().code, fmt::format("{}: {}", name, taken.error().message));
    }
    if (is_field) {
        const auto index = static_cast<std::uint16_t>(field - fields.begin());
        METIER_TRY(limits_.check(index, *field, *taken));
    }
    if (!into.parameters.emplace(name, std::move(*taken)).second) {
        return fail(Errc::invalid_argument, fmt::format("{} is given twice", name));
    }
    if (is_parent) {
        auto& text = name == kParentServer ? into.parent.server : into.parent.id;
        const auto value = into.parameters.extract(name);
        if (const auto* said = std::get_if<std::string>(&value.mapped())) {
            text = said->substr(0, kLongestParent);
        }
    }
    return {};
}

/// \return whether it is the place of an arm
Result<bool> SkillNode::takeStart(const opcua::KeyValue& given, Given& into) {
    constexpr std::size_t kMostArms = 64;
    const auto& name = given.key.name;
    auto arm = armIn(name, kStartJointPosition);
    if (!arm) {
        return false;
    }
    auto place = given.value.as<std::vector<double>>();
    if (!place) {
        return fail(place.error().code, fmt::format("{}: {}", name, place.error().message));
    }
    if (into.starts.size() == kMostArms) {
        return fail(Errc::out_of_range, fmt::format("{}: over {} arms", name, kMostArms));
    }
    if (!into.starts.emplace(std::move(*arm), std::move(*place)).second) {
        return fail(Errc::invalid_argument, fmt::format("{} is given twice", name));
    }
    return true;
}

Result<SkillNode::Given> SkillNode::givenIn(const Value& pairs) const {
    METIER_ASSIGN(const auto all, pairs.as<std::vector<opcua::KeyValue>>());
    Given given;
    for (const auto& one : all) {
        METIER_TRY(takeGiven(one, given));
    }
    return given;
}

std::vector<opcua::KeyValue> SkillNode::pairsOf(const skill::ValueMap& values) const {
    std::vector<opcua::KeyValue> pairs;
    for (const auto& [name, value] : values) {
        pairs.push_back({{context_.ids.metier, name}, toOpcua(value)});
    }
    return pairs;
}

Result<std::vector<Value>> SkillNode::startWith(const Session& session,
                                                std::span<const Value> inputs) {
    const auto id = inputs[0].as<std::string>();
    auto given = givenIn(inputs[1]);
    if (given && !given->starts.empty()) {
        given = fail(Errc::invalid_argument,
                     fmt::format("no parameter {}; Check takes it", kStartJointPosition));
    }
    const auto action = inputs[2].as<std::int32_t>();
    const auto epoch = inputs[3].as<std::uint64_t>();
    const auto deadline = inputs[4].as<UtcTime>();
    if (!id || !given || !action || !epoch || !deadline) {
        METIER_TRY(remember(session,
                            given ? fail(Errc::type_mismatch, "StartWith") : fail(given.error())));
    }
    const auto on_owner_loss = ownerLossActionFrom(*action);
    METIER_TRY(on_owner_loss ? Result<void>() : remember(session, fail(on_owner_loss.error())));
    auto started = program_->startWith(
        callerOf(session),
        {.execution_id = *id,
         .parameters = std::move(given->parameters),
         .on_owner_loss = *on_owner_loss,
         .epoch = *epoch,
         .deadline = *deadline <= UtcTime{} ? std::optional<UtcTime>{} : *deadline,
         .parent = std::move(given->parent)});
    METIER_TRY(remember(session, started ? Result<void>() : fail(started.error())));
    return std::vector{Value::of(*started)};
}

Result<std::vector<Value>> SkillNode::check(const Session& session, std::span<const Value> inputs) {
    auto given = givenIn(inputs[0]);
    if (!given) {
        return outputsOf({.possible = false,
                          .reason = given.error().message,
                          .code = std::string(toString(given.error().code)),
                          .first_failing_fraction = 0.0});
    }
    METIER_ASSIGN(
        const auto report,
        checks_.answer(session.id, {std::move(given->parameters), std::move(given->starts)},
                       program_->executor(),
                       [&](const skill::CheckRequest& request, skill::CheckDone done) {
                           program_->check(callerOf(session), request, std::move(done));
                       }));
    return outputsOf(report);
}

Result<std::vector<Value>> SkillNode::getExecution(std::span<const Value> inputs) const {
    METIER_ASSIGN(const auto id, inputs[0].as<std::string>());
    METIER_ASSIGN(const auto record, program_->execution(id));
    return std::vector{Value::of(static_cast<std::uint32_t>(record.state)),
                       Value::of(static_cast<std::int32_t>(record.reason)),
                       Value::of(record.reason_text),
                       Value::of(record.start_time),
                       Value::of(record.end_time),
                       Value::of(pairsOf(record.result))};
}

Result<void> SkillNode::remember(const Session& session, Result<void> outcome) {
    if (outcome) {
        context_.refusals.accepted(session, *this);
    } else {
        context_.refusals.refused(session, *this, outcome.error().message);
    }
    return outcome;
}

/// A transition that no call of a client asked for, and that is not simply the end of the work.
void SkillNode::auditOwnAct(const skill::TransitionEvent& event) {
    using skill::Reason;
    if (event.reason == Reason::none || event.reason == Reason::finished ||
        event.reason == Reason::by_client) {
        return;
    }
    context_.server.audit(
        {.object = id_,
         .event = std::string(skill::toString(event.to)),
         .text = fmt::format("{}: {}", skill::toString(event.reason), event.reason_text)});
}

void SkillNode::onTransition(const skill::TransitionEvent& event) {
    auditOwnAct(event);
    raise(context_.emitter, {.source = id_,
                             .source_name = program_->description().name,
                             .time = event.time,
                             .severity = event.severity,
                             .message = {"en", event.message},
                             .fields = transitionValues(event)});
}

void SkillNode::onStopping(const skill::StoppingEvent& event) {
    const auto& name = program_->description().name;
    raise(context_.stopping,
          {.source = id_,
           .source_name = name,
           .time = event.time,
           .severity = kInformation,
           .message = {"en", fmt::format("{}: comes to rest, then {}: {}", name,
                                         skill::toString(event.to), event.reason_text)},
           .fields = stoppingValues(event)});
}

void SkillNode::raise(opcua::EventEmitter& emitter, const opcua::Event& occurrence) {
    if (const auto emitted = emitter.emit(occurrence); !emitted) {
        context_.log->error("no event of {}: {}", id_.toString(), emitted.error().message);
    }
}

}  // namespace metier::opcua_skill
