#include "metier/client/async_skill.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "device_lock.hpp"
#include "method_values.hpp"
#include "metier/opcua/text.hpp"
#include "questions.hpp"
#include "skill_nodes.hpp"
#include "state_poll.hpp"
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
    TransitionWatch watch{};
    opcua::Subscription stopping{};
    // Shared with the answers that are on their way.
    std::shared_ptr<LockUse> lock_use{};

    Answer<> startByWrites(const skill::StartRequest& request, Done<std::string> done) const;
    Answer<> look(const std::string& id, Done<skill::ExecutionRecord> done) const;

    struct Method {
        const opcua::NodeId& node;
        std::string_view name;
    };
    /// Calls a method and passes the result of `read` for its outputs to `done`.
    template <typename T, typename Read>
    Answer<> send(const Method& method, std::vector<opcua::Value> inputs, Done<T> done,
                  Read read) const {
        if (method.node == opcua::NodeId{}) {
            return opcua::failed(opcua::status::kBadMethodInvalid,
                                 fmt::format("{} has no {}", address.name, method.name));
        }
        return client.callAsync(
            {address.node, method.node, std::move(inputs)},
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

/// One start of a skill that takes no parameters with it.
struct NamelessStart {
    std::string id;
    opcua::MethodCall start;
    std::vector<std::string> names;  // of the parameters, in the order of the writes
    // Has a doubt once Start is answered: what it begins may be over before a subscription shows
    // it.
    std::shared_ptr<TransitionLog> log;
    std::shared_ptr<StatePoll> poll;  // null: there is a subscription
};

Answer<> written(const std::vector<opcua::StatusCode>& statuses, const NamelessStart& start) {
    for (std::size_t i = 0; i < start.names.size(); ++i) {
        if (statuses.at(i).isBad()) {
            return opcua::failed(statuses.at(i), "writing " + start.names.at(i));
        }
    }
    return {};
}

Answer<> callStart(opcua::Client& client, const NamelessStart& start,
                   AsyncSkill::Done<std::string> done) {
    return client.callAsync(start.start, [id = start.id, log = start.log, poll = start.poll,
                                          done = std::move(done)](const auto& answer) {
        if (poll && answer) {
            poll->noteStart();
        }
        done(answer.map([&](const CallResult& /*none*/) { return id; }));
        log->doubt();
    });
}

/// Writes the parameters, then calls Start.
Answer<> writeAndStart(opcua::Client& client, std::vector<opcua::WriteItem> writes,
                       NamelessStart start, AsyncSkill::Done<std::string> done) {
    if (writes.empty()) {
        return callStart(client, start, std::move(done));
    }
    return client.writeManyAsync(
        std::move(writes), [&client, start = std::move(start), done = std::move(done)](
                               const Answer<std::vector<opcua::StatusCode>>& statuses) {
            auto begun =
                statuses ? written(*statuses, start) : Answer<>(tl::unexpected(statuses.error()));
            if (begun) {
                begun = callStart(client, start, done);
            }
            if (!begun) {
                done(tl::unexpected(begun.error()));
            }
        });
}

/// Record of the execution that was started last, as far as state and results show it.
Answer<skill::ExecutionRecord> recordFrom(const std::vector<opcua::DataValue>& values,
                                          const SkillNodes& nodes, const std::string& id) {
    const auto now = programNow(values);
    if (!now) {
        return opcua::failed(opcua::status::kBadTypeMismatch, "CurrentState");
    }
    skill::ExecutionRecord record;
    record.id = id;
    record.state = now->state;
    const bool given_up = now->last == skill::TransitionNumber::suspended_to_ready;
    const bool failed = now->state == skill::State::halted ||
                        now->last == skill::TransitionNumber::halted_to_ready;  // reset since
    if (now->state == skill::State::ready) {
        record.reason = given_up ? skill::Reason::by_client : skill::Reason::finished;
    }
    if (failed) {
        record.reason = skill::Reason::error;
    }
    const auto first = values.size() - nodes.results.size() - 1;
    record.reason_text = opcua::sanitise(values[first].value.as<std::string>().value_or(""));
    for (std::size_t i = 0; i < nodes.results.size(); ++i) {
        record.result[nodes.results[i].field.name] =
            nodes.results[i].received(values[first + 1 + i].value);
    }
    return record;
}

/// Says why an execution has ended where only the skill's event does, which may come later than the
/// state.
struct TextOfEnd {
    opcua::Client& client;
    std::shared_ptr<TransitionLog> log;
    bool events;  // the skill sends them

    /// Passes the record to `done`, now or when the event should have come.
    void addTo(skill::ExecutionRecord record,
               const AsyncSkill::Done<skill::ExecutionRecord>& done) const {
        if (record.reason_text.empty()) {
            record.reason_text = log->textOfLast(record.state);
        }
        const bool may_come = events && record.state == skill::State::halted;
        const auto complete = [record, log = log, done]() mutable {
            record.reason_text = log->textOfLast(record.state);
            done(std::move(record));
        };
        if (!record.reason_text.empty() || !may_come || !client.runAfter(kEventTime, complete)) {
            done(std::move(record));
        }
    }
};

}  // namespace

std::shared_ptr<DeviceLocks> makeDeviceLocks(opcua::Client& client) {
    return std::make_shared<DeviceLocks>(client);
}

Answer<AsyncSkill> AsyncSkill::open(opcua::Client& client, SkillAddress address, Watch watch,
                                    std::shared_ptr<DeviceLocks> locks) {
    METIER_ASSIGN(auto nodes, readSkillNodes(client, address));
    auto impl = std::make_unique<Impl>(Impl{client, std::move(address), std::move(nodes)});
    impl->description = {.name = impl->address.name,
                         .type = impl->address.type_name,
                         .parameters = allOptional(fieldsOf(impl->nodes.parameters)),
                         .results = allOptional(fieldsOf(impl->nodes.results)),
                         .suspendable = impl->nodes.suspendable};
    impl->lock_use = std::make_shared<LockUse>(
        locks ? std::move(locks) : std::make_shared<DeviceLocks>(client), impl->nodes.lock);
    if (auto stopping = watchStopping(client, impl->address.node, std::move(watch.on_stopping))) {
        impl->stopping = std::move(*stopping);
    } else if (stopping.error().code == Errc::connection_lost) {
        return tl::unexpected(stopping.error());
    }
    impl->log->watch(
        {std::move(watch.on_transition), std::move(watch.on_missed), std::move(watch.on_ended)});
    METIER_ASSIGN(impl->watch,
                  watchTransitions(client, impl->address.node, impl->nodes, impl->log));
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
    return impl_->nodes.knowsExecutions();
}

bool AsyncSkill::locksDevice() const noexcept {
    return impl_->nodes.lock.isThere();
}

std::vector<Lack> AsyncSkill::lacks() const {
    return impl_->nodes.lacks();
}

void AsyncSkill::unlock() const {
    impl_->lock_use->giveBack([](const auto& /*any*/) {});
}

Answer<AsyncSkill::Now> AsyncSkill::now() const {
    const auto& nodes = impl_->nodes;
    auto items = programItems(nodes.program);
    const auto first = items.size();
    items.push_back({nodes.reason_text});
    items.push_back({nodes.execution_id});
    METIER_ASSIGN(const auto values, impl_->client.readMany(std::move(items)));
    const auto program = programNow(values);
    if (!program) {
        return opcua::failed(opcua::status::kBadTypeMismatch,
                             impl_->address.name + ": CurrentState");
    }
    return Now{program->state, values[first].value.as<std::string>().value_or(""),
               values[first + 1].value.as<std::string>().value_or("")};
}

Answer<> AsyncSkill::startWith(const skill::StartRequest& request, Done<std::string> done) const {
    if (!knowsExecutions()) {
        return impl_->startByWrites(request, std::move(done));
    }
    return impl_->send<std::string>(
        {impl_->nodes.start_with, "StartWith"}, startWithInputs(request, impl_->nodes),
        std::move(done), [](const std::vector<opcua::Value>& outputs) -> Answer<std::string> {
            return outputs.empty() ? std::string() : outputs.front().as<std::string>().value_or("");
        });
}

Answer<> AsyncSkill::Impl::startByWrites(const skill::StartRequest& request,
                                         Done<std::string> done) const {
    if (request.epoch != 0) {
        return opcua::failed(opcua::status::kBadMethodInvalid,
                             address.name + " has no StartWith: it takes no lease");
    }
    NamelessStart start{
        request.execution_id,
        {address.node, nodes.methods.at(static_cast<std::size_t>(skill::Method::start))},
        {},
        log,
        watch.polling.poll()};
    std::vector<opcua::WriteItem> writes;
    for (const auto& [name, value] : request.parameters) {
        const auto found =
            std::find_if(nodes.parameters.begin(), nodes.parameters.end(),
                         [&name = name](const auto& node) { return node.field.name == name; });
        if (found == nodes.parameters.end()) {
            return opcua::failed(opcua::status::kBadNoMatch,
                                 fmt::format("{} has no parameter '{}'", address.name, name));
        }
        auto sent = found->sent(value);
        if (!sent) {
            return tl::unexpected(failureOf(
                sent.error().code, fmt::format("{}: {}", address.name, sent.error().message)));
        }
        writes.push_back({found->node, std::move(*sent)});
        start.names.push_back(name);
    }
    if (!nodes.lock.isThere()) {
        return writeAndStart(client, std::move(writes), std::move(start), std::move(done));
    }
    // An execution that did not begin needs no lock.
    auto begun = [lock = lock_use, done = std::move(done)](const Answer<std::string>& id) {
        if (!id) {
            lock->giveBack([](const auto& /*any*/) {});
        }
        done(id);
    };
    lock_use->take([&client = client, writes = std::move(writes), start = std::move(start),
                    begun = std::move(begun)](const Answer<>& locked) {
        const auto sent = locked ? writeAndStart(client, writes, start, begun) : Answer<>(locked);
        if (!sent) {
            begun(tl::unexpected(sent.error()));
        }
    });
    return {};
}

Answer<> AsyncSkill::call(skill::Method method, Done<> done) const {
    return impl_->send<void>(
        {impl_->nodes.methods.at(static_cast<std::size_t>(method)), toString(method)}, {},
        std::move(done),
        [poll = impl_->watch.polling.poll()](const std::vector<opcua::Value>& /*none*/) {
            if (poll) {
                poll->hurry();
            }
            return Answer<>();
        });
}

bool AsyncSkill::runsOthers() const noexcept {
    return impl_->nodes.runs_others;
}

Answer<> AsyncSkill::check(const skill::CheckRequest& request,
                           Done<skill::CheckReport> done) const {
    return impl_->send<skill::CheckReport>(
        {impl_->nodes.check, "Check"}, checkInputs(request), std::move(done),
        [name = impl_->address.name](const std::vector<opcua::Value>& outputs) {
            return checkReportFrom(outputs, name);
        });
}

Answer<> AsyncSkill::execution(const std::string& id, Done<skill::ExecutionRecord> done) const {
    if (!knowsExecutions()) {
        return impl_->look(id, std::move(done));
    }
    return impl_->send<skill::ExecutionRecord>(
        {impl_->nodes.get_execution, "GetExecution"}, {opcua::Value::of(id)}, std::move(done),
        [id, results = impl_->description.results,
         name = impl_->address.name](const std::vector<opcua::Value>& outputs) {
            return executionFrom(outputs, id, results, name);
        });
}

Answer<> AsyncSkill::Impl::look(const std::string& id, Done<skill::ExecutionRecord> done) const {
    auto items = programItems(nodes.program);
    items.push_back({nodes.reason_text});
    for (const auto& result : nodes.results) {
        items.push_back({result.node});
    }
    return client.readManyAsync(
        std::move(items), [id, nodes = nodes, text = TextOfEnd{client, log, watch.events},
                           done = std::move(done)](const auto& values) {
            auto record = values ? recordFrom(*values, nodes, id)
                                 : Answer<skill::ExecutionRecord>(tl::unexpected(values.error()));
            if (record) {
                text.addTo(*std::move(record), done);
            } else {
                done(std::move(record));
            }
        });
}

}  // namespace metier::client
