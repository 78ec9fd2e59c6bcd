#include "metier/opcua/client.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <future>
#include <type_traits>
#include <utility>

#include "client/client_core.hpp"
#include "client/client_requests.hpp"

namespace metier::opcua {

namespace {

constexpr std::chrono::seconds kLongestCallback{5};
// The client's thread ends a call at its deadline, and knows whether it was sent.
constexpr std::chrono::milliseconds kLongestTurn{100};

tl::unexpected<Failure> timedOut(Deadline deadline) {
    auto failure = failed(status::kBadTimeout, "the call");
    failure.value().message += fmt::format(
        ", no answer within {} ms; unknown whether it was "
        "carried out",
        deadline.allowed.count());
    failure.value().delivery = Failure::Delivery::unknown;
    return failure;
}

tl::unexpected<Failure> waitInCallback() {
    return failed(status::kBadInvalidState, "a call that waits, from a callback of its client");
}

/// Waits for what `start` begins: it gets a Done<T> and says whether the request was taken.
template <typename T, typename Start>
Answer<T> waitFor(const ClientCore& core, Deadline deadline, const Start& start) {
    if (core.onOwnThread()) {
        return waitInCallback();
    }
    // Shared with the request, which may outlive this wait.
    auto outcome = std::make_shared<std::promise<Answer<T>>>();
    auto answer = outcome->get_future();
    const auto started =
        start(Done<T>([outcome](Answer<T> done) { outcome->set_value(std::move(done)); }));
    if (!started) {
        return tl::unexpected(started.error());
    }
    if (answer.wait_until(deadline.at + kLongestTurn) != std::future_status::ready) {
        return timedOut(deadline);
    }
    return answer.get();
}

/// Starts a request with `items` and waits for its answer.
template <typename Items, typename T>
Answer<T> ask(ClientCore& core, Timeout timeout,
              Answer<> (*start)(ClientCore&, Items, Deadline, Done<T>),
              std::type_identity_t<Items> items) {
    const auto deadline = core.deadline(timeout);
    return waitFor<T>(core, deadline, [&](auto done) {
        return start(core, std::move(items), deadline, std::move(done));
    });
}

Answer<> asAnswer(const Answer<std::vector<StatusCode>>& written, const NodeId& node) {
    if (!written) {
        return tl::unexpected(written.error());
    }
    return written->front().isBad() ? failed(written->front(), "writing " + node.toString())
                                    : Answer<>();
}

Answer<> checkReconnect(const ReconnectOptions& options) {
    if (options.shortest_pause <= std::chrono::milliseconds::zero() ||
        options.longest_pause < options.shortest_pause) {
        return failed(status::kBadInvalidArgument,
                      fmt::format("pauses of {} ms to {} ms between attempts to reconnect",
                                  options.shortest_pause.count(), options.longest_pause.count()));
    }
    if (!(options.jitter >= 0.0 && options.jitter <= 1.0)) {
        return failed(status::kBadInvalidArgument,
                      fmt::format("a jitter of {}, must be 0 to 1", options.jitter));
    }
    return {};
}

Answer<> checkOptions(const std::string& url, const ClientOptions& options) {
    const auto shortest = std::min({options.connect_timeout, options.session_timeout,
                                    options.call_timeout, options.publishing_interval});
    if (shortest <= std::chrono::milliseconds::zero()) {
        return failed(status::kBadInvalidArgument,
                      fmt::format("a time of {} ms, must be over 0", shortest.count()));
    }
    if (!url.starts_with("opc.tcp://")) {
        return failed(status::kBadInvalidArgument, fmt::format("no opc.tcp:// URL: {}", url));
    }
    return options.reconnect ? checkReconnect(*options.reconnect) : Answer<>();
}

}  // namespace

Client::Client(std::shared_ptr<ClientCore> core) : core_(std::move(core)) {}

Client::~Client() {
    core_->close();
}

Answer<std::unique_ptr<Client>> Client::connect(const std::string& url, ClientOptions options) {
    METIER_TRY(checkOptions(url, options));
    auto core = std::make_shared<ClientCore>(std::move(options), ConnectionKind::session);
    METIER_TRY(core->connect(url));
    return std::unique_ptr<Client>(new Client(std::move(core)));
}

Answer<> Client::close() {
    if (core_->onOwnThread()) {
        return failed(status::kBadInvalidState, "closing a client from one of its callbacks");
    }
    core_->close();
    return {};
}

Client::State Client::state() const noexcept {
    return core_->state();
}

std::optional<Failure> Client::whyLost() const {
    return core_->whyLost();
}

std::uint64_t Client::boot() const noexcept {
    return core_->boot();
}

Answer<> Client::awaitConnected(SteadyTime deadline) {
    if (core_->onOwnThread()) {
        return waitInCallback();
    }
    const bool changed = core_->awaitChange(deadline);
    if (state() == State::connected) {
        return {};
    }
    auto why = failed(changed ? status::kBadConnectionClosed : status::kBadTimeout,
                      "waiting for the connection");
    why.value().delivery = Failure::Delivery::not_sent;
    if (const auto cause = whyLost()) {
        why.value().message += "; lost: " + cause->message;
    }
    return why;
}

void Client::onConnectionChange(std::function<void(const ConnectionChange&)> callback) {
    core_->onConnectionChange(std::move(callback));
}

void Client::onConnectionLost(std::function<void(const Failure&)> callback) {
    core_->onConnectionLost(std::move(callback));
}

Answer<> Client::runAfter(std::chrono::nanoseconds delay, std::function<void()> work) {
    return core_->runAfter(delay, std::move(work));
}

Answer<Value> Client::read(const NodeId& node, AttributeId attribute, Timeout timeout) {
    METIER_ASSIGN(auto values, readMany({{node, attribute}}, timeout));
    auto& value = values.front();
    if (value.status.isBad()) {
        return failed(value.status, "reading " + node.toString());
    }
    return std::move(value.value);
}

Answer<std::vector<DataValue>> Client::readMany(std::vector<ReadItem> items, Timeout timeout) {
    return ask(*core_, timeout, startRead, std::move(items));
}

Answer<> Client::write(NodeId node, Value value, std::optional<UtcTime> source_time,
                       Timeout timeout) {
    return asAnswer(writeMany({{node, std::move(value), source_time}}, timeout), node);
}

Answer<std::vector<StatusCode>> Client::writeMany(std::vector<WriteItem> items, Timeout timeout) {
    return ask(*core_, timeout, startWrite, std::move(items));
}

Answer<CallResult> Client::call(MethodCall method_call, Timeout timeout) {
    return ask(*core_, timeout, startCall, std::move(method_call));
}

Answer<CallResult> Client::call(NodeId object, NodeId method, std::vector<Value> inputs) {
    return call(MethodCall{std::move(object), std::move(method), std::move(inputs)});
}

Answer<std::vector<Reference>> Client::browse(BrowseQuery query, Timeout timeout) {
    return ask(*core_, timeout, startBrowse, std::move(query));
}

Answer<NodeId> Client::translate(const NodeId& start, std::vector<QualifiedName> names,
                                 Timeout timeout) {
    auto targets = translateMany({{start, std::move(names)}}, timeout);
    return targets ? std::move(targets->front())
                   : Answer<NodeId>(tl::unexpected(std::move(targets.error())));
}

Answer<std::vector<Answer<NodeId>>> Client::translateMany(std::vector<RelativePath> paths,
                                                          Timeout timeout) {
    return ask(*core_, timeout, startTranslate, std::move(paths));
}

Answer<std::vector<std::string>> Client::namespaceArray(Timeout timeout) {
    METIER_ASSIGN(const auto value, read(ids::kNamespaceArray, AttributeId::value, timeout));
    auto uris = value.as<std::vector<std::string>>();
    if (!uris) {
        return tl::unexpected(Failure{uris.error(), status::kBadTypeMismatch, {}});
    }
    return std::move(*uris);
}

Answer<std::uint16_t> Client::namespaceIndex(std::string_view uri, Timeout timeout) {
    METIER_ASSIGN(const auto uris, namespaceArray(timeout));
    const auto found = std::find(uris.begin(), uris.end(), uri);
    if (found == uris.end()) {
        return failed(status::kBadNotFound, fmt::format("the namespace {}", uri));
    }
    return static_cast<std::uint16_t>(found - uris.begin());
}

Answer<bool> Client::readUserExecutable(const NodeId& method, Timeout timeout) {
    METIER_ASSIGN(const auto value, read(method, AttributeId::user_executable, timeout));
    const auto executable = value.as<bool>();
    if (!executable) {
        return tl::unexpected(Failure{executable.error(), status::kBadTypeMismatch, {}});
    }
    return *executable;
}

Answer<> Client::writeAsync(WriteItem item, std::function<void(Answer<>)> done, Timeout timeout) {
    auto node = item.node;
    return startWrite(*core_, {std::move(item)}, core_->deadline(timeout),
                      [node = std::move(node), done = std::move(done)](const auto& written) {
                          done(asAnswer(written, node));
                      });
}

Answer<> Client::writeManyAsync(std::vector<WriteItem> items,
                                std::function<void(Answer<std::vector<StatusCode>>)> done,
                                Timeout timeout) {
    return startWrite(*core_, std::move(items), core_->deadline(timeout), std::move(done));
}

Answer<> Client::readManyAsync(std::vector<ReadItem> items,
                               std::function<void(Answer<std::vector<DataValue>>)> done,
                               Timeout timeout) {
    return startRead(*core_, std::move(items), core_->deadline(timeout), std::move(done));
}

Answer<> Client::callAsync(MethodCall method_call, std::function<void(Answer<CallResult>)> done,
                           Timeout timeout) {
    return startCall(*core_, std::move(method_call), core_->deadline(timeout), std::move(done));
}

Answer<Subscription> Client::subscribeEvents(NodeId notifier, EventFilter filter,
                                             std::function<void(const EventNotice&)> callback,
                                             Timeout timeout) {
    if (filter.fields.empty()) {
        return failed(status::kBadInvalidArgument, "subscribing to events without fields");
    }
    return subscribe(EventItem{std::move(notifier), std::move(filter), std::move(callback)},
                     timeout);
}

Answer<Subscription> Client::subscribeData(NodeId variable, DataFilter filter,
                                           std::function<void(const DataValue&)> callback,
                                           Timeout timeout) {
    return subscribe(DataItem{std::move(variable), filter, std::move(callback)}, timeout);
}

template <typename Item>
Answer<Subscription> Client::subscribe(Item item, Timeout timeout) {
    const auto deadline = core_->deadline(timeout);
    Subscription subscription(core_, core_->subscriptions().newHandle());
    const auto added = waitFor<void>(*core_, deadline, [&](auto done) {
        return core_->request(
            [core = core_.get(), handle = subscription.handle_, item = std::move(item), deadline,
             done = std::move(done)] { core->subscriptions().add(handle, item, deadline, done); });
    });
    if (!added) {
        return tl::unexpected(added.error());
    }
    return subscription;
}

Subscription::Subscription(std::shared_ptr<ClientCore> core, std::uint32_t handle)
    : core_(std::move(core)), handle_(handle) {}

Subscription::~Subscription() {
    end();
}

Subscription::Subscription(Subscription&& other) noexcept
    : core_(std::move(other.core_)), handle_(other.handle_) {}

Subscription& Subscription::operator=(Subscription&& other) noexcept {
    if (this != &other) {
        end();
        core_ = std::move(other.core_);
        handle_ = other.handle_;
    }
    return *this;
}

void Subscription::end() noexcept {
    const auto core = std::exchange(core_, nullptr);
    if (!core) {
        return;
    }
    if (core->onOwnThread()) {
        return core->subscriptions().remove(handle_);
    }
    // Shared with the work, which may begin after this wait.
    auto removed = std::make_shared<std::promise<void>>();
    const auto posted = core->post([core = core.get(), handle = handle_, removed] {
        core->subscriptions().remove(handle);
        removed->set_value();
    });
    if (posted) {
        removed->get_future().wait_for(kLongestCallback);
    }
}

}  // namespace metier::opcua
