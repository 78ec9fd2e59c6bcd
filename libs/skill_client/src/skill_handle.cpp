#include "metier/skill_client/skill_handle.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "metier/opcua_skill/values.hpp"
#include "skill_nodes.hpp"
#include "transition_log.hpp"

namespace metier::skill_client {
namespace {

using opcua::Answer;
using opcua::Failure;
using skill::Method;
using skill::State;
using skill::TransitionEvent;

constexpr const char* kDeviceNamespace = "https://fortiss.org/UA/Device/";

constexpr std::size_t kCheckOutputs = 5;
constexpr std::size_t kExecutionOutputs = 6;

opcua::Value pairsOf(const skill::ValueMap& values) {
    std::vector<opcua::KeyValue> pairs;
    for (const auto& [name, value] : values) {
        pairs.push_back({{0, name}, opcua_skill::toOpcua(value)});
    }
    return opcua::Value::of(pairs);
}

bool endsExecution(const TransitionEvent& event) {
    return event.to == State::ready || event.to == State::halted;
}

std::vector<skill::Field> fieldsOf(const std::vector<FieldNode>& nodes) {
    std::vector<skill::Field> fields;
    for (const auto& node : nodes) {
        fields.push_back(node.field);
    }
    return fields;
}

/// As OPC UA calls it: `Double`, `Double[]`, `3DFrame`.
std::string typeNameOf(skill::ValueType type) {
    switch (type) {
        case skill::ValueType::null:
            return "Null";
        case skill::ValueType::boolean:
            return "Boolean";
        case skill::ValueType::int32:
            return "Int32";
        case skill::ValueType::uint32:
            return "UInt32";
        case skill::ValueType::uint64:
            return "UInt64";
        case skill::ValueType::number:
            return "Double";
        case skill::ValueType::text:
            return "String";
        case skill::ValueType::frame:
            return "3DFrame";
        case skill::ValueType::vector3:
            return "3DVector";
        case skill::ValueType::numbers:
            return "Double[]";
        case skill::ValueType::texts:
            return "String[]";
        case skill::ValueType::ranges:
            return "Range[]";
        case skill::ValueType::frames:
            return "3DFrame[]";
    }
    return "";
}

const FieldNode* findField(const std::vector<FieldNode>& nodes, std::string_view name) {
    const auto found = std::find_if(nodes.begin(), nodes.end(),
                                    [&](const auto& node) { return node.field.name == name; });
    return found == nodes.end() ? nullptr : &*found;
}

Errc errcFor(skill::Reason reason) {
    switch (reason) {
        case skill::Reason::by_client:
            return Errc::cancelled;
        case skill::Reason::device_lost:
            return Errc::connection_lost;
        case skill::Reason::limit_violated:
        case skill::Reason::force_exceeded:
            return Errc::limit_violated;
        default:
            return Errc::device_fault;
    }
}

/// A server that does not yet list the namespace has no extra event fields: any index will do.
std::uint16_t deviceNamespace(opcua::Client& client) {
    return client.namespaceIndex(kDeviceNamespace).value_or(1);
}

}  // namespace

struct SkillHandle::Impl {
    opcua::Client& client;
    SkillAddress address;
    SkillNodes nodes;
    std::vector<skill::Field> parameters{};
    std::vector<skill::Field> results{};
    // Shared with the subscription's callback, which may run while this object moves.
    std::shared_ptr<TransitionLog> log = std::make_shared<TransitionLog>();
    opcua::Subscription subscription{};

    Failure refused(Failure failure, std::string_view doing) const {
        std::string text = fmt::format("{} {}: {}", address.name, doing, failure.status.name());
        const auto reason = reasonText();
        if (!reason.empty()) {
            text += ": " + reason;
        }
        failure.message = std::move(text);
        return failure;
    }

    /// A wrong type is refused before the skill hears of it: its text would be of an older refusal.
    Failure wrongType(Failure failure, const FieldNode& node, const skill::Value& given) const {
        failure.message =
            fmt::format("{} refused {}: {}: {}: {} expected, {} given", address.name,
                        node.field.name, failure.status.name(), node.field.name,
                        typeNameOf(node.field.type), opcua_skill::toOpcua(given).typeName());
        return failure;
    }

    std::string reasonText() const {
        if (nodes.reason_text == opcua::NodeId{}) {
            return {};
        }
        const auto value = client.read(nodes.reason_text);
        return value ? value->as<std::string>().value_or("") : "";
    }

    Answer<const FieldNode*> parameter(std::string_view name) const {
        if (const auto* node = findField(nodes.parameters, name)) {
            return node;
        }
        std::vector<std::string> known;
        for (const auto& field : parameters) {
            known.push_back(field.name);
        }
        return tl::unexpected(
            Failure{{Errc::not_found, fmt::format("{} has no parameter '{}'; it has: {}",
                                                  address.name, name, fmt::join(known, ", "))},
                    opcua::status::kBadNoMatch,
                    {}});
    }

    Answer<std::vector<opcua::Value>> callMetier(const opcua::NodeId& method, std::string_view name,
                                                 std::vector<opcua::Value> inputs);
    skill::ValueMap resultsIn(const opcua::Value& pairs) const;
    Answer<skill::ValueMap> awaitOutcome(std::uint64_t from, SteadyTime deadline);
    Answer<skill::ValueMap> readResults() const;
};

Answer<SkillHandle> SkillHandle::open(opcua::Client& client, SkillAddress address) {
    auto nodes = readSkillNodes(client, address);
    if (!nodes) {
        return tl::unexpected(nodes.error());
    }
    auto impl = std::make_unique<Impl>(Impl{client, std::move(address), std::move(*nodes)});
    impl->parameters = fieldsOf(impl->nodes.parameters);
    impl->results = fieldsOf(impl->nodes.results);
    auto subscription = client.subscribeEvents(
        impl->address.node, transitionFilter(deviceNamespace(client)),
        [log = impl->log](const opcua::EventNotice& notice) { log->add(notice); });
    if (!subscription) {
        return tl::unexpected(subscription.error());
    }
    impl->subscription = std::move(*subscription);
    return SkillHandle(std::move(impl));
}

SkillHandle::SkillHandle(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SkillHandle::SkillHandle(SkillHandle&&) noexcept = default;
SkillHandle& SkillHandle::operator=(SkillHandle&&) noexcept = default;
SkillHandle::~SkillHandle() = default;

const SkillAddress& SkillHandle::address() const noexcept {
    return impl_->address;
}

const std::vector<skill::Field>& SkillHandle::parameters() const noexcept {
    return impl_->parameters;
}

const std::vector<skill::Field>& SkillHandle::results() const noexcept {
    return impl_->results;
}

Answer<> SkillHandle::set(std::string_view name, const skill::Value& value) {
    const auto node = impl_->parameter(name);
    if (!node) {
        return tl::unexpected(node.error());
    }
    auto written = impl_->client.write((*node)->node, opcua_skill::toOpcua(value));
    if (!written && written.error().status == opcua::status::kBadTypeMismatch) {
        return tl::unexpected(impl_->wrongType(written.error(), **node, value));
    }
    if (!written) {
        return tl::unexpected(impl_->refused(written.error(), fmt::format("refused {}", name)));
    }
    return {};
}

Answer<> SkillHandle::setAsync(std::string_view name, const skill::Value& value, UtcTime meant_for,
                               std::function<void(Answer<>)> done) {
    const auto node = impl_->parameter(name);
    if (!node) {
        return tl::unexpected(node.error());
    }
    return impl_->client.writeAsync({(*node)->node, opcua_skill::toOpcua(value), meant_for},
                                    std::move(done));
}

Answer<> SkillHandle::call(Method method) {
    const auto& node = impl_->nodes.methods.at(static_cast<std::size_t>(method));
    auto result = impl_->client.call(impl_->address.node, node);
    if (!result) {
        return tl::unexpected(
            impl_->refused(result.error(), fmt::format("refused {}", toString(method))));
    }
    return {};
}

Answer<std::vector<opcua::Value>> SkillHandle::Impl::callMetier(const opcua::NodeId& method,
                                                                std::string_view name,
                                                                std::vector<opcua::Value> inputs) {
    if (method == opcua::NodeId{}) {
        return tl::unexpected(
            Failure{{Errc::not_supported, fmt::format("{} has no {}", address.name, name)},
                    opcua::status::kBadMethodInvalid,
                    {}});
    }
    auto result = client.call(address.node, method, std::move(inputs));
    if (!result) {
        return tl::unexpected(refused(result.error(), fmt::format("refused {}", name)));
    }
    return std::move(result->outputs);
}

Answer<std::string> SkillHandle::startWith(const skill::StartRequest& request) {
    auto outputs = impl_->callMetier(
        impl_->nodes.methods.at(static_cast<std::size_t>(Method::start_with)), "StartWith",
        {opcua::Value::of(request.execution_id), pairsOf(request.parameters),
         opcua::Value::of(static_cast<std::int32_t>(request.on_owner_loss)),
         opcua::Value::of(request.epoch), opcua::Value::of(request.deadline.value_or(UtcTime{}))});
    if (!outputs) {
        return tl::unexpected(outputs.error());
    }
    return outputs->empty() ? std::string() : outputs->front().as<std::string>().value_or("");
}

Answer<skill::CheckReport> SkillHandle::check(const skill::ValueMap& parameters) {
    const auto outputs = impl_->callMetier(impl_->nodes.check, "Check", {pairsOf(parameters)});
    if (!outputs) {
        return tl::unexpected(outputs.error());
    }
    if (outputs->size() != kCheckOutputs) {
        return opcua::failed(opcua::status::kBadUnexpectedError, impl_->address.name + " Check");
    }
    skill::CheckReport report;
    report.possible = (*outputs)[0].as<bool>().value_or(false);
    report.reason = (*outputs)[1].as<std::string>().value_or("");
    report.first_failing_fraction = (*outputs)[2].as<double>().value_or(0.0);
    report.planned_duration = (*outputs)[3].as<double>().value_or(0.0);
    report.joint_path = (*outputs)[4].asRows().value_or(std::vector<std::vector<double>>{});
    return report;
}

Answer<skill::ExecutionRecord> SkillHandle::execution(const std::string& id) {
    const auto outputs =
        impl_->callMetier(impl_->nodes.get_execution, "GetExecution", {opcua::Value::of(id)});
    if (!outputs) {
        return tl::unexpected(outputs.error());
    }
    if (outputs->size() != kExecutionOutputs) {
        return opcua::failed(opcua::status::kBadUnexpectedError,
                             impl_->address.name + " GetExecution");
    }
    skill::ExecutionRecord record;
    record.id = id;
    record.state = static_cast<State>((*outputs)[0].as<std::uint32_t>().value_or(0));
    record.reason = static_cast<skill::Reason>((*outputs)[1].as<std::int32_t>().value_or(0));
    record.reason_text = (*outputs)[2].as<std::string>().value_or("");
    record.start_time = (*outputs)[3].as<UtcTime>().value_or(UtcTime{});
    record.end_time = (*outputs)[4].as<UtcTime>().value_or(UtcTime{});
    record.result = impl_->resultsIn((*outputs)[5]);
    return record;
}

skill::ValueMap SkillHandle::Impl::resultsIn(const opcua::Value& pairs) const {
    skill::ValueMap values;
    for (const auto& [key, value] :
         pairs.as<std::vector<opcua::KeyValue>>().value_or(std::vector<opcua::KeyValue>{})) {
        if (const auto* node = findField(nodes.results, key.name)) {
            values[key.name] =
                opcua_skill::fromOpcua(value, node->field.type).value_or(skill::Value{});
        }
    }
    return values;
}

Answer<> SkillHandle::start() {
    return call(Method::start);
}
Answer<> SkillHandle::suspend() {
    return call(Method::suspend);
}
Answer<> SkillHandle::resume() {
    return call(Method::resume);
}
Answer<> SkillHandle::halt() {
    return call(Method::halt);
}
Answer<> SkillHandle::reset() {
    return call(Method::reset);
}

Answer<bool> SkillHandle::executable(Method method) {
    return impl_->client.readUserExecutable(
        impl_->nodes.methods.at(static_cast<std::size_t>(method)));
}

Answer<State> SkillHandle::state() {
    const auto value = impl_->client.read(impl_->nodes.state_number);
    if (!value) {
        return tl::unexpected(value.error());
    }
    const auto number = value->as<std::uint32_t>();
    if (!number || *number < static_cast<std::uint32_t>(State::halted) ||
        *number > static_cast<std::uint32_t>(State::suspended)) {
        return opcua::failed(opcua::status::kBadTypeMismatch,
                             impl_->address.name + ": CurrentState/Number");
    }
    return static_cast<State>(*number);
}

Answer<skill::ValueMap> SkillHandle::Impl::readResults() const {
    std::vector<opcua::ReadItem> items;
    for (const auto& result : nodes.results) {
        items.push_back({result.node});
    }
    skill::ValueMap values;
    if (items.empty()) {
        return values;
    }
    const auto read = client.readMany(std::move(items));
    if (!read) {
        return tl::unexpected(read.error());
    }
    for (std::size_t i = 0; i < nodes.results.size(); ++i) {
        const auto& field = nodes.results[i].field;
        values[field.name] =
            opcua_skill::fromOpcua((*read)[i].value, field.type).value_or(skill::Value{});
    }
    return values;
}

Answer<skill::ValueMap> SkillHandle::result() {
    return impl_->readResults();
}

std::string SkillHandle::reasonText() {
    return impl_->reasonText();
}

Answer<> SkillHandle::awaitState(State wanted, SteadyTime deadline) {
    // Transitions from here on are waited for; the state read after it covers those before.
    const auto from = impl_->log->next();
    const auto now = state();
    if (!now) {
        return tl::unexpected(now.error());
    }
    if (*now == wanted) {
        return {};
    }
    const auto found = impl_->log->await(
        from, deadline, [wanted](const TransitionEvent& event) { return event.to == wanted; });
    if (!found) {
        return tl::unexpected(found.error());
    }
    return {};
}

Answer<TransitionEvent> SkillHandle::awaitEnd(SteadyTime deadline) {
    auto found = impl_->log->await(impl_->log->next(), deadline, endsExecution);
    if (!found) {
        return tl::unexpected(found.error());
    }
    return std::move(found->event);
}

Answer<skill::ValueMap> SkillHandle::Impl::awaitOutcome(std::uint64_t from, SteadyTime deadline) {
    const auto started = log->await(from, deadline, [](const TransitionEvent& event) {
        return event.number == skill::TransitionNumber::ready_to_running;
    });
    if (!started) {
        return tl::unexpected(started.error());
    }
    const auto& id = started->event.execution_id;
    const auto ended = log->await(started->number + 1, deadline, [&](const auto& event) {
        return endsExecution(event) && event.execution_id == id;
    });
    if (!ended) {
        return tl::unexpected(ended.error());
    }
    const auto& event = ended->event;
    if (event.to == State::halted) {
        return tl::unexpected(
            Failure{{errcFor(event.reason), fmt::format("{} was halted ({}): {}", address.name,
                                                        toString(event.reason), event.reason_text)},
                    opcua::statusFrom(errcFor(event.reason)),
                    {}});
    }
    return readResults();
}

Answer<skill::ValueMap> SkillHandle::run(const skill::ValueMap& values, SteadyTime deadline) {
    for (const auto& [name, value] : values) {
        if (auto written = set(name, value); !written) {
            return tl::unexpected(written.error());
        }
    }
    const auto from = impl_->log->next();
    if (auto started = start(); !started) {
        return tl::unexpected(started.error());
    }
    return orHalt(impl_->awaitOutcome(from, deadline));
}

Answer<skill::ValueMap> SkillHandle::runWith(const skill::StartRequest& request,
                                             SteadyTime deadline) {
    const auto from = impl_->log->next();
    if (auto started = startWith(request); !started) {
        return tl::unexpected(started.error());
    }
    return orHalt(impl_->awaitOutcome(from, deadline));
}

Answer<skill::ValueMap> SkillHandle::orHalt(Answer<skill::ValueMap> outcome) {
    if (!outcome && outcome.error().code == Errc::timeout) {
        // The work has lost its client's interest: it must not go on alone.
        if (const auto halted = halt(); !halted) {
            outcome.error().message += "; " + halted.error().message;
        }
    }
    return outcome;
}

void SkillHandle::onTransition(std::function<void(const TransitionEvent&)> callback) {
    impl_->log->onTransition(std::move(callback));
}

}  // namespace metier::skill_client
