#include "metier/client/skill_handle.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <chrono>
#include <thread>
#include <utility>
#include <variant>

#include "method_values.hpp"
#include "metier/opcua/text.hpp"
#include "metier/opcua_skill/values.hpp"
#include "questions.hpp"
#include "skill_handle_impl.hpp"

namespace metier::client {
namespace {

using opcua::Answer;
using opcua::Failure;
using skill::Method;
using skill::State;
using skill::TransitionEvent;

// Longest time for which a device with an unfinished Reset is asked for the outcome, and the pause
// between.
constexpr auto kResetTime = std::chrono::seconds(1);
constexpr auto kResetPause = std::chrono::milliseconds(10);
// Longer than a composed skill asks the skills that it uses.
constexpr auto kCheckTime = std::chrono::seconds(15);
constexpr auto kCheckPause = std::chrono::milliseconds(10);

/// As OPC UA calls it: `Double`, `Double[]`, `3DFrame`.
std::string typeNameOf(skill::ValueType type) {
    // In the order of ValueType.
    static constexpr std::array kNames{"Null",     "Boolean", "Int32",    "UInt32",   "UInt64",
                                       "Double",   "String",  "3DFrame",  "3DVector", "Double[]",
                                       "String[]", "Range[]", "3DFrame[]"};
    static_assert(kNames.size() == std::variant_size_v<skill::Value>);
    return kNames[static_cast<std::size_t>(type)];
}

}  // namespace

Answer<> SkillHandle::Impl::readNodes() {
    METIER_ASSIGN(auto read, readSkillNodes(client, address));
    nodes = std::move(read);
    parameters = fieldsOf(nodes.parameters);
    results = fieldsOf(nodes.results);
    lock_use = std::make_shared<LockUse>(std::make_shared<DeviceLocks>(client), nodes.lock);
    return {};
}

Answer<> SkillHandle::Impl::subscribe() {
    watch = {};
    METIER_ASSIGN(watch, watchTransitions(client, address.node, nodes, log));
    return {};
}

Answer<> SkillHandle::Impl::refresh() {
    const auto now = client.boot();
    if (now == boot) {
        return {};
    }
    const auto controller = address.controllerName();
    METIER_ASSIGN(
        auto found,
        findSkill(client, controller.empty() ? address.name
                                             : fmt::format("{}/{}", controller, address.name)));
    const bool moved = found.node != address.node;
    address = std::move(found);
    METIER_TRY(readNodes());
    METIER_TRY(moved || watch.polling.poll() ? subscribe() : Answer<>());
    boot = now;
    return {};
}

Failure SkillHandle::Impl::refused(Failure failure, std::string_view what) const {
    if (failure.delivery != Failure::Delivery::answered) {
        failure.message = fmt::format("{} {}: {}", address.name, what, failure.message);
        return failure;
    }
    const auto reason = reasonText();
    failure.message = fmt::format("{} refused {}: {}{}{}", address.name, what,
                                  failure.status.name(), reason.empty() ? "" : ": ", reason);
    return failure;
}

Failure SkillHandle::Impl::wrongType(Failure failure, const FieldNode& node,
                                     const skill::Value& given) const {
    failure.message =
        fmt::format("{} refused {}: {}: {}: {} expected, {} given", address.name, node.field.name,
                    failure.status.name(), node.field.name, typeNameOf(node.field.type),
                    opcua_skill::toOpcua(given).typeName());
    return failure;
}

Answer<opcua::Value> SkillHandle::Impl::sent(const FieldNode& node,
                                             const skill::Value& value) const {
    auto converted = node.sent(value);
    if (!converted) {
        return tl::unexpected(
            failureOf(converted.error().code,
                      fmt::format("{}: {}", address.name, converted.error().message)));
    }
    return std::move(*converted);
}

std::string SkillHandle::Impl::reasonText() const {
    if (nodes.reason_text == opcua::NodeId{}) {
        return {};
    }
    const auto value = client.read(nodes.reason_text);
    return value ? opcua::sanitise(value->as<std::string>().value_or("")) : "";
}

Answer<const FieldNode*> SkillHandle::Impl::parameter(std::string_view name) const {
    for (const auto& node : nodes.parameters) {
        if (node.field.name == name) {
            return &node;
        }
    }
    std::vector<std::string> known;
    for (const auto& field : parameters) {
        known.push_back(field.name);
    }
    return tl::unexpected(failureOf(Errc::not_found,
                                    fmt::format("{} has no parameter '{}'; it has: {}",
                                                address.name, name, fmt::join(known, ", ")),
                                    opcua::status::kBadNoMatch));
}

Answer<SkillHandle> SkillHandle::open(opcua::Client& client, SkillAddress address) {
    auto impl = std::make_unique<Impl>(Impl{client, std::move(address), client.boot()});
    METIER_TRY(impl->readNodes());
    METIER_TRY(impl->subscribe());
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

bool SkillHandle::knowsExecutions() const noexcept {
    return impl_->nodes.knowsExecutions();
}

bool SkillHandle::locksDevice() const noexcept {
    return impl_->nodes.lock.isThere();
}

std::vector<Lack> SkillHandle::lacks() const {
    return impl_->nodes.lacks();
}

bool SkillHandle::takesParents() const noexcept {
    return knowsExecutions() && !impl_->nodes.records.isNull();
}

Answer<> SkillHandle::refresh() {
    return impl_->refresh();
}

Answer<> SkillHandle::set(std::string_view name, const skill::Value& value) {
    METIER_TRY(impl_->refresh());
    METIER_ASSIGN(const auto node, impl_->parameter(name));
    METIER_ASSIGN(auto sent, impl_->sent(*node, value));
    const auto written = impl_->client.writeMany({{node->node, std::move(sent), {}, impl_->boot}});
    if (!written) {
        return tl::unexpected(impl_->refused(written.error(), name));
    }
    const auto status = written->front();
    if (!status.isBad()) {
        return {};
    }
    const auto refusal = opcua::failed(status, "").value();
    return tl::unexpected(status == opcua::status::kBadTypeMismatch
                              ? impl_->wrongType(refusal, *node, value)
                              : impl_->refused(refusal, name));
}

Answer<> SkillHandle::setAsync(std::string_view name, const skill::Value& value,
                               std::optional<UtcTime> meant_for,
                               std::function<void(Answer<>)> done) {
    METIER_ASSIGN(const auto node, impl_->parameter(name));
    METIER_ASSIGN(auto sent, impl_->sent(*node, value));
    return impl_->client.writeAsync({node->node, std::move(sent), meant_for, impl_->boot},
                                    std::move(done));
}

Answer<> SkillHandle::call(Method method) {
    METIER_TRY(impl_->refresh());
    METIER_ASSIGN(const auto node, impl_->methodNode(method));
    const auto ask = [&] {
        return impl_->client.call(opcua::MethodCall{impl_->address.node, node, {}, impl_->boot});
    };
    const bool begins = method == Method::start || method == Method::resume;
    const auto result = begins ? impl_->begin(ask) : ask();
    return result ? Answer<>() : tl::unexpected(impl_->refused(result.error(), toString(method)));
}

Answer<std::vector<opcua::Value>> SkillHandle::Impl::callMetier(opcua::NodeId SkillNodes::*method,
                                                                std::string_view name,
                                                                std::vector<opcua::Value> inputs) {
    METIER_TRY(refresh());
    if (nodes.*method == opcua::NodeId{}) {
        return tl::unexpected(failureOf(Errc::not_supported,
                                        fmt::format("{} has no {}", address.name, name),
                                        opcua::status::kBadMethodInvalid));
    }
    auto result =
        client.call(opcua::MethodCall{address.node, nodes.*method, std::move(inputs), boot});
    if (!result) {
        return tl::unexpected(refused(result.error(), name));
    }
    return std::move(result->outputs);
}

Answer<opcua::NodeId> SkillHandle::Impl::methodNode(Method method) const {
    const auto& node = nodes.methods.at(static_cast<std::size_t>(method));
    if (node.isNull()) {
        return tl::unexpected(failureOf(Errc::not_supported,
                                        fmt::format("{} has no {}", address.name, toString(method)),
                                        opcua::status::kBadMethodInvalid));
    }
    return node;
}

Answer<std::string> SkillHandle::Impl::startByWrites(SkillHandle& handle,
                                                     const skill::StartRequest& request) {
    if (request.epoch != 0 || request.on_owner_loss != skill::OwnerLossAction::skill_default) {
        return tl::unexpected(failureOf(
            Errc::not_supported,
            fmt::format("{} has no StartWith: its server does not stop it when its client is lost",
                        address.name),
            opcua::status::kBadMethodInvalid));
    }
    METIER_TRY(lock());
    auto begun = [&]() -> Answer<> {
        for (const auto& [name, value] : request.parameters) {
            METIER_TRY(handle.set(name, value));
        }
        return handle.start();
    }();
    if (!begun) {
        unlock();
        return tl::unexpected(std::move(begun.error()));
    }
    return request.execution_id.empty() ? newExecutionId() : request.execution_id;
}

Answer<> SkillHandle::Impl::lock() const {
    auto taken = awaitDone([this](LockUse::Done done) { lock_use->take(std::move(done)); });
    if (!taken) {
        taken.error().message =
            fmt::format("{} was not started: {}", address.name, taken.error().message);
    }
    return taken;
}

void SkillHandle::Impl::unlock() const {
    static_cast<void>(awaitDone([this](const LockUse::Done& done) { lock_use->giveBack(done); }));
}

Answer<std::string> SkillHandle::startWith(const skill::StartRequest& request) {
    METIER_TRY(impl_->refresh());
    if (!knowsExecutions()) {
        return impl_->startByWrites(*this, request);
    }
    METIER_ASSIGN(const auto outputs, impl_->begin([&] {
        return impl_->callMetier(&SkillNodes::start_with, "StartWith",
                                 startWithInputs(request, impl_->nodes));
    }));
    return outputs.empty() ? std::string() : outputs.front().as<std::string>().value_or("");
}

Answer<skill::CheckReport> SkillHandle::check(const skill::ValueMap& parameters,
                                              const skill::ArmPositions& starts) {
    const auto inputs = checkInputs({parameters, starts});
    const auto deadline = std::chrono::steady_clock::now() + kCheckTime;
    for (;;) {
        const auto outputs = impl_->callMetier(&SkillNodes::check, "Check", inputs);
        if (outputs) {
            return checkReportFrom(*outputs, impl_->address.name);
        }
        const bool goes_on = outputs.error().code == Errc::timeout &&
                             outputs.error().delivery == Failure::Delivery::answered;
        if (!goes_on || std::chrono::steady_clock::now() >= deadline) {
            return tl::unexpected(outputs.error());
        }
        std::this_thread::sleep_for(kCheckPause);
    }
}

Answer<skill::ExecutionRecord> SkillHandle::execution(const std::string& id) {
    return impl_->execution(id);
}

Answer<skill::ExecutionRecord> SkillHandle::Impl::execution(const std::string& id) {
    METIER_ASSIGN(const auto outputs,
                  callMetier(&SkillNodes::get_execution, "GetExecution", {opcua::Value::of(id)}));
    return executionFrom(outputs, id, results, address.name);
}

Answer<> SkillHandle::reset() {
    const auto deadline = std::chrono::steady_clock::now() + kResetTime;
    for (;;) {
        auto asked = call(Method::reset);
        const bool goes_on = !asked && asked.error().code == Errc::timeout &&
                             asked.error().delivery == Failure::Delivery::answered;
        const auto now = std::chrono::steady_clock::now();
        if (!goes_on || now >= deadline || awaitState(State::ready, now + kResetPause)) {
            return goes_on && now < deadline ? Answer<>() : asked;
        }
    }
}

Answer<bool> SkillHandle::executable(Method method) {
    METIER_TRY(impl_->refresh());
    const auto node = impl_->methodNode(method);
    return node ? impl_->client.readUserExecutable(*node) : Answer<bool>(false);
}

Answer<State> SkillHandle::state() {
    return impl_->state();
}

Answer<State> SkillHandle::Impl::state() {
    METIER_TRY(refresh());
    METIER_ASSIGN(const auto now, look());
    return now.state;
}

Answer<ProgramNow> SkillHandle::Impl::look() const {
    METIER_ASSIGN(const auto values, client.readMany(programItems(nodes.program)));
    if (const auto now = programNow(values)) {
        return *now;
    }
    return opcua::failed(opcua::status::kBadTypeMismatch, address.name + ": CurrentState");
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
    METIER_ASSIGN(const auto read, client.readMany(std::move(items)));
    for (std::size_t i = 0; i < nodes.results.size(); ++i) {
        values[nodes.results[i].field.name] = nodes.results[i].received(read[i].value);
    }
    return values;
}

Answer<skill::ValueMap> SkillHandle::result() {
    METIER_TRY(impl_->refresh());
    return impl_->readResults();
}

std::string SkillHandle::reasonText() {
    return impl_->reasonText();
}

void SkillHandle::onTransition(std::function<void(const TransitionEvent&)> callback) {
    impl_->log->watch({.on_transition = std::move(callback)});
}

}  // namespace metier::client
