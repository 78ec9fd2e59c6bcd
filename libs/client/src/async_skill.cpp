#include "metier/client/async_skill.hpp"

#include <fmt/format.h>

#include <utility>

#include "method_values.hpp"
#include "skill_nodes.hpp"
#include "transition_log.hpp"

namespace metier::client {

using opcua::Answer;
using opcua::CallResult;

struct AsyncSkill::Impl {
    opcua::Client& client;
    SkillAddress address;
    SkillNodes nodes;
    skill::SkillDescription description{};
    // Shared with the subscription's callback, which may run while this object moves.
    std::shared_ptr<TransitionLog> log = std::make_shared<TransitionLog>();
    opcua::Subscription subscription{};
    opcua::Subscription stopping{};

    /// Calls a method and passes the result of `read` for its outputs to `done`.
    template <typename T, typename Read>
    Answer<> send(const opcua::NodeId& method, std::string_view name,
                  std::vector<opcua::Value> inputs, Done<T> done, Read read) const {
        if (method == opcua::NodeId{}) {
            return opcua::failed(opcua::status::kBadMethodInvalid,
                                 fmt::format("{} has no {}", address.name, name));
        }
        return client.callAsync(
            {address.node, method, std::move(inputs)},
            [done = std::move(done), read = std::move(read)](Answer<CallResult> result) {
                if (result) {
                    done(read(result->outputs));
                } else {
                    done(tl::unexpected(std::move(result.error())));
                }
            });
    }
};

namespace {

skill::Fields allOptional(std::vector<skill::Field> fields) {
    for (auto& field : fields) {
        field.optional = true;
    }
    return fields;
}

}  // namespace

Answer<AsyncSkill> AsyncSkill::open(opcua::Client& client, SkillAddress address, Watch watch) {
    METIER_ASSIGN(auto nodes, readSkillNodes(client, address));
    auto impl = std::make_unique<Impl>(Impl{client, std::move(address), std::move(nodes)});
    impl->description = {.name = impl->address.name,
                         .type = impl->address.type_name,
                         .parameters = allOptional(fieldsOf(impl->nodes.parameters)),
                         .results = allOptional(fieldsOf(impl->nodes.results)),
                         .suspendable = impl->nodes.suspendable};
    if (auto stopping = watchStopping(client, impl->address.node, std::move(watch.on_stopping))) {
        impl->stopping = std::move(*stopping);
    } else if (stopping.error().code == Errc::connection_lost) {
        return tl::unexpected(stopping.error());
    }
    impl->log->watch(
        {std::move(watch.on_transition), std::move(watch.on_missed), std::move(watch.on_ended)});
    METIER_ASSIGN(impl->subscription, watchTransitions(client, impl->address.node, impl->log));
    return AsyncSkill(std::move(impl));
}

AsyncSkill::AsyncSkill(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
AsyncSkill::AsyncSkill(AsyncSkill&&) noexcept = default;
AsyncSkill& AsyncSkill::operator=(AsyncSkill&&) noexcept = default;
AsyncSkill::~AsyncSkill() = default;

const SkillAddress& AsyncSkill::address() const noexcept {
    return impl_->address;
}

const skill::SkillDescription& AsyncSkill::description() const noexcept {
    return impl_->description;
}

bool AsyncSkill::knowsExecutions() const noexcept {
    return !impl_->nodes.start_with.isNull() && !impl_->nodes.get_execution.isNull();
}

Answer<AsyncSkill::Now> AsyncSkill::now() const {
    const auto& nodes = impl_->nodes;
    METIER_ASSIGN(
        const auto values,
        impl_->client.readMany({{nodes.state_number}, {nodes.reason_text}, {nodes.execution_id}}));
    const auto number = values[0].value.as<std::uint32_t>();
    if (!number) {
        return opcua::failed(opcua::status::kBadTypeMismatch,
                             impl_->address.name + ": CurrentState/Number");
    }
    return Now{static_cast<skill::State>(*number), values[1].value.as<std::string>().value_or(""),
               values[2].value.as<std::string>().value_or("")};
}

Answer<> AsyncSkill::startWith(const skill::StartRequest& request, Done<std::string> done) const {
    return impl_->send<std::string>(
        impl_->nodes.start_with, "StartWith", startWithInputs(request, impl_->nodes),
        std::move(done), [](const std::vector<opcua::Value>& outputs) -> Answer<std::string> {
            return outputs.empty() ? std::string() : outputs.front().as<std::string>().value_or("");
        });
}

Answer<> AsyncSkill::call(skill::Method method, Done<> done) const {
    return impl_->send<void>(impl_->nodes.methods.at(static_cast<std::size_t>(method)),
                             toString(method), {}, std::move(done),
                             [](const std::vector<opcua::Value>& /*none*/) { return Answer<>(); });
}

Answer<> AsyncSkill::check(const skill::ValueMap& parameters, Done<skill::CheckReport> done) const {
    return impl_->send<skill::CheckReport>(
        impl_->nodes.check, "Check", {pairsOf(parameters)}, std::move(done),
        [name = impl_->address.name](const std::vector<opcua::Value>& outputs) {
            return checkReportFrom(outputs, name);
        });
}

Answer<> AsyncSkill::execution(const std::string& id, Done<skill::ExecutionRecord> done) const {
    return impl_->send<skill::ExecutionRecord>(
        impl_->nodes.get_execution, "GetExecution", {opcua::Value::of(id)}, std::move(done),
        [id, results = impl_->description.results,
         name = impl_->address.name](const std::vector<opcua::Value>& outputs) {
            return executionFrom(outputs, id, results, name);
        });
}

}  // namespace metier::client
