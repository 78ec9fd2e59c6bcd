#include "client/client_core.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "common/convert.hpp"

namespace metier::opcua {

namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kLongestIdle{1'000};
constexpr milliseconds kGoodbye{1'000};         // longest wait for the answer to CloseSession
constexpr milliseconds kLateAnswers{60'000};    // kept apart from attacks that long
constexpr std::size_t kMostUnanswered = 2'000;  // besides PublishRequests
constexpr int kMostAttempts = 4;                // an endpoint may send us elsewhere

ClientCore& coreOf(UA_Client* client) {
    return *static_cast<ClientCore*>(UA_Client_getConfig(client)->clientContext);
}

/// Makes one failure for all codes with which the stack reports a broken connection: they differ by
/// the moment.
Failure lostFailure(std::string_view doing, StatusCode status,
                    Failure::Delivery delivery = Failure::Delivery::not_sent) {
    return {{Errc::connection_lost,
             fmt::format("{}: the connection is lost ({})", doing, status.name())},
            status,
            {},
            delivery};
}

/// Whether the server answered; if not, its action is unknown.
bool isAnswer(const ClientCalls::Ending& ending) {
    return ending.response != nullptr && errcFrom(ending.status) != Errc::connection_lost;
}

Failure::Delivery deliveryOf(const ClientCalls::Ending& ending) {
    using Delivery = Failure::Delivery;
    if (!ending.sent) {
        return Delivery::not_sent;
    }
    return isAnswer(ending) ? Delivery::answered : Delivery::unknown;
}

EventLoopOptions loopOptions(const ClientOptions& options, const UA_Logger* logger) {
    EventLoopOptions loop;
    loop.connect_limit = options.connect_timeout;
    loop.logger = logger;
    return loop;
}

ClientOptions withPresentIdentity(ClientOptions options) {
    if (!options.security || options.security->identity_folder.empty()) {
        return options;
    }
    if (auto present = security::loadIdentity(options.security->identity_folder)) {
        options.security->identity = std::move(*present);
    } else {
        spdlog::warn("connecting with the certificate known before: {}", present.error().message);
    }
    return options;
}

}  // namespace

ClientCore::ClientCore(ClientOptions options, ConnectionKind kind)
    : options_(withPresentIdentity(std::move(options))),
      kind_(kind),
      loop_(loopOptions(options_, complaints_.logger())),
      subscriptions_(*this) {
    if (options_.reconnect && kind_ == ConnectionKind::session) {
        schedule_.emplace(*options_.reconnect);
    }
}

ClientCore::~ClientCore() {
    close();
}

Answer<> ClientCore::connect(const std::string& url) {
    url_ = url;
    if (options_.security) {
        auto peers = PeerCheck::create(options_.security->trust_folder, {});
        if (!peers) {
            return failed(status::kBadResourceUnavailable, peers.error().message);
        }
        peers_ = std::move(*peers);
        peers_->keepUntrusted();
    }
    auto outcome = connected_.get_future();
    thread_ = std::jthread([this] { run(); });
    const auto deadline = Deadline::in(options_.connect_timeout + kGoodbye);
    auto answer = outcome.wait_until(deadline.at) == std::future_status::ready
                      ? outcome.get()
                      : failed(status::kBadTimeout, "connecting to " + url);
    if (!answer) {
        close();
    }
    return answer;
}

void ClientCore::close() {
    {
        const std::lock_guard lock(gate_);
        if (!closed_) {
            closed_ = true;
            setState(Client::State::closed);
            loop_.post([this] { ending_ = true; });
        }
    }
    const std::lock_guard lock(joining_);
    if (thread_.joinable()) {
        thread_.join();
    }
}

Deadline ClientCore::deadline(Timeout timeout) const {
    return Deadline::in(timeout.value_or(options_.call_timeout));
}

Answer<> ClientCore::post(std::function<void()> work) {
    const std::lock_guard lock(gate_);
    if (closed_) {
        return tl::unexpected(lostFailure("the client is closed", status::kBadConnectionClosed));
    }
    loop_.post(std::move(work));
    return {};
}

Answer<> ClientCore::request(std::function<void()> work) {
    const auto connection = connection_.load();  // before the state, which is older then
    const auto state = state_.load();
    if (state == Client::State::lost || state == Client::State::reconnecting) {
        return tl::unexpected(lostFailure("nothing was sent", status::kBadNotConnected));
    }
    return post([this, connection, work = std::move(work)] { runRequest(connection, work); });
}

void ClientCore::runRequest(std::uint64_t connection, const std::function<void()>& work) {
    request_of_ = connection;
    work();
    request_of_.reset();
}

std::optional<Failure> ClientCore::whyLost() const {
    const std::lock_guard lock(state_mutex_);
    return why_lost_;
}

bool ClientCore::awaitChange(SteadyTime deadline) const {
    std::unique_lock lock(state_mutex_);
    return state_changed_.wait_until(lock, deadline,
                                     [this] { return state_ != Client::State::reconnecting; });
}

void ClientCore::setState(Client::State state) {
    {
        const std::lock_guard lock(state_mutex_);
        if (state_ != Client::State::closed) {  // closed is final
            state_ = state;
        }
    }
    state_changed_.notify_all();
}

Answer<> ClientCore::runAfter(std::chrono::nanoseconds delay, std::function<void()> work) {
    return post([this, due = steady_clock::now() + delay, work = std::move(work)]() mutable {
        delayed_.emplace(due, std::move(work));
    });
}

void ClientCore::onConnectionLost(std::function<void(const Failure&)> callback) {
    const auto posted = post([this, callback = std::move(callback)]() mutable {
        if (phase_ == Phase::over) {
            later([callback = std::move(callback), why = *outage_] { callback(why); });
        } else {
            on_lost_ = std::move(callback);
        }
    });
    static_cast<void>(posted);  // closed: there is no listener any more
}

void ClientCore::onConnectionChange(std::function<void(const ConnectionChange&)> callback) {
    const auto posted = post(
        [this, callback = std::move(callback)]() mutable { on_change_ = std::move(callback); });
    static_cast<void>(posted);  // closed: there is no listener any more
}

void ClientCore::tell(ConnectionChange change) {
    change.time = std::chrono::time_point_cast<UtcTime::duration>(std::chrono::system_clock::now());
    later([this, change = std::move(change)] {
        if (on_change_ && !ending_) {
            on_change_(change);
        }
    });
}

void ClientCore::run() {
    own_thread_ = std::this_thread::get_id();
    connectNow();
    while (!ending_) {
        iterate(kLongestIdle);
    }
    end();
    own_thread_ = std::thread::id();  // another thread may get this one's
}

/// Lets the stack connect, with the client that it has or a new one.
void ClientCore::connectNow() {
    connecting_ = &calls_.add(steady_clock::now() + options_.connect_timeout,
                              [this](const ClientCalls::Ending& ending) { refuse(ending.status); });
    if (!client_) {
        auto* loop = loop_.handle();
        loop->start(loop);  // a client of the stack stops it when it ends
        auto config =
            makeClientConfig(options_, kind_, {loop, complaints_.logger(), peers_.get(), url_});
        if (!config) {
            settle(failed(status::kBadInvalidArgument, config.error().message));
            return;
        }
        config->clientContext = this;
        config->stateCallback = &onState;
        config->inactivityCallback = &onInactivity;
        client_.reset(UA_Client_newWithConfig(&*config));
    }
    UA_Client_getConfig(client_.get())->noReconnect = false;
    channel_ = UA_SECURECHANNELSTATE_CLOSED;
    attempts_ = 0;
    identifying_ = false;
    const StatusCode status(kind_ == ConnectionKind::session
                                ? UA_Client_connectAsync(client_.get(), url_.c_str())
                                : UA_Client_connectSecureChannelAsync(client_.get(), url_.c_str()));
    if (status.isBad()) {
        refuse(status);
    }
}

void ClientCore::iterate(milliseconds longest) {
    const auto now = steady_clock::now();
    const auto next = nextDue();
    const auto wait = next < now + longest ? std::chrono::ceil<milliseconds>(next - now) : longest;
    if (!loop_.runOnce(std::max(wait, milliseconds::zero()))) {
        lose(status::kBadInternalError);
    }
    calls_.expire(steady_clock::now());
    runDelayed(steady_clock::now());
    attemptIfDue();
    sayEverything();
}

SteadyTime ClientCore::nextDue() const {
    auto next = calls_.nextDeadline().value_or(SteadyTime::max());
    if (!delayed_.empty()) {
        next = std::min(next, delayed_.begin()->first);
    }
    return phase_ == Phase::waiting && !ending_ ? std::min(next, schedule_->next()) : next;
}

/// Runs what is due until then, between two iterations of the loop.
void ClientCore::runDelayed(SteadyTime until) {
    const auto end = delayed_.upper_bound(until);
    for (auto due = delayed_.begin(); due != end; due = delayed_.erase(due)) {
        later(std::move(due->second));
    }
}

void ClientCore::sayEverything() {
    while (!call_outs_.empty()) {
        const auto now = std::exchange(call_outs_, {});
        for (const auto& call_out : now) {
            call_out();
        }
    }
}

void ClientCore::end() {
    connecting_ = nullptr;
    phase_ = Phase::over;
    outage_ = lostFailure("the client is closed", status::kBadConnectionClosed);
    calls_.failAll(status::kBadConnectionClosed);
    runDelayed(SteadyTime::max());
    subscriptions_.end(status::kBadConnectionClosed);
    sayEverything();
    UA_Client_disconnectAsync(client_.get());
    const auto deadline = steady_clock::now() + kGoodbye;
    while (channelState() != UA_SECURECHANNELSTATE_CLOSED && steady_clock::now() < deadline) {
        iterate(std::chrono::ceil<milliseconds>(deadline - steady_clock::now()));
    }
    client_.reset();
    sayEverything();
}

UA_SecureChannelState ClientCore::channelState() const {
    auto state = UA_SECURECHANNELSTATE_CLOSED;
    UA_Client_getState(client_.get(), &state, nullptr, nullptr);
    return state;
}

void ClientCore::sendMessage(const Message& message, SteadyTime deadline,
                             ClientCalls::Finish finish) {
    const auto now = steady_clock::now();
    if (ending_) {
        return finish({status::kBadConnectionClosed, nullptr, false});
    }
    if (request_of_ && (*request_of_ != connection_ || phase_ != Phase::open)) {
        return finish({status::kBadNotConnected, nullptr, false});
    }
    if (deadline <= now) {
        return finish({status::kBadTimeout, nullptr, false});
    }
    const bool publish = deadline == SteadyTime::max();
    if (!publish && calls_.size() >= kMostUnanswered) {
        return finish({status::kBadResourceUnavailable, nullptr, false});
    }
    auto& header = *static_cast<UA_RequestHeader*>(message.request);
    const auto kept = publish ? 10 * kLateAnswers
                              : std::chrono::ceil<milliseconds>(deadline - now) + kLateAnswers;
    header.timeoutHint = static_cast<UA_UInt32>(kept.count());
    auto& call = calls_.add(deadline, std::move(finish));
    const StatusCode status(__UA_Client_AsyncService(client_.get(), message.request,
                                                     message.request_type, &ClientCalls::onResponse,
                                                     message.response_type, &call, nullptr));
    if (status.isBad()) {
        calls_.refuse(call, status);
    }
}

Failure ClientCore::failure(const Task& task, const ClientCalls::Ending& ending) const {
    const auto status = ending.status;
    const bool lost = !isAnswer(ending) && (outage_ || errcFrom(status) == Errc::connection_lost);
    auto failure = lost ? lostFailure(task.doing, outage_ ? outage_->status : status)
                        : Failure{errorFrom(status, task.doing), status, {}};
    failure.delivery = deliveryOf(ending);
    if (failure.code == Errc::timeout) {
        failure.message += fmt::format(", no answer within {} ms", task.deadline.allowed.count());
    } else if (status == status::kBadResourceUnavailable && calls_.size() >= kMostUnanswered) {
        failure.message += fmt::format(", {} requests are unanswered", calls_.size());
    }
    if (task.effect == Effect::commands && failure.delivery == Failure::Delivery::unknown) {
        failure.message += "; unknown whether it was carried out";
    }
    return failure;
}

void ClientCore::settle(Answer<> outcome) {
    if (connecting_ == nullptr) {
        return;
    }
    calls_.drop(*std::exchange(connecting_, nullptr));
    if (phase_ == Phase::connecting) {
        phase_ = outcome ? Phase::open : Phase::over;
        if (!outcome) {
            outage_ = outcome.error();
        }
        connected_.set_value(std::move(outcome));
    } else {
        attempted(outcome);
    }
}

void ClientCore::refuse(StatusCode status) {
    Failure failure{
        errorFrom(status, "connecting to " + url_), status, {}, Failure::Delivery::not_sent};
    const auto& why = peers_ != nullptr && !peers_->lastRefusal().empty() ? peers_->lastRefusal()
                                                                          : complaints_.last();
    if (!why.empty()) {
        failure.message += fmt::format(" ({})", why);
    }
    settle(tl::unexpected(std::move(failure)));
}

void ClientCore::lose(StatusCode status) {
    if (ending_ || (phase_ != Phase::open && phase_ != Phase::restoring)) {
        return;
    }
    if (reconnects()) {
        interrupt(status);
    } else {
        phase_ = Phase::over;
        outage_ = lostFailure(url_, status);
        calls_.failAll(status);
        loseForGood(*outage_);
    }
    loop_.post([this] { loop_.dropOpened(); });
}

void ClientCore::loseForGood(const Failure& why) {
    phase_ = Phase::over;
    outage_ = why;
    {
        const std::lock_guard lock(state_mutex_);
        why_lost_ = why;
    }
    setState(Client::State::lost);
    subscriptions_.end(why.status);
    if (on_lost_) {
        later([callback = std::exchange(on_lost_, nullptr), why] { callback(why); });
    }
    tell({.kind = ConnectionChange::Kind::given_up, .why = why});
}

void ClientCore::stateChanged(UA_SecureChannelState channel, UA_SessionState session,
                              StatusCode status) {
    if (connecting_ != nullptr) {
        connectingChanged(channel, session, status);
    } else if (status.isBad()) {
        lose(status);
    } else if (kind_ == ConnectionKind::session && session != UA_SESSIONSTATE_ACTIVATED) {
        lose(status::kBadConnectionClosed);
    }
}

void ClientCore::connectingChanged(UA_SecureChannelState channel, UA_SessionState session,
                                   StatusCode status) {
    const bool changed = std::exchange(channel_, channel) != channel;
    if (changed && channel == UA_SECURECHANNELSTATE_CONNECTING) {
        ++attempts_;
    }
    if (status.isBad()) {
        refuse(status);
    } else if (attempts_ > kMostAttempts) {
        refuse(status::kBadConnectionClosed);
    } else if (session == UA_SESSIONSTATE_ACTIVATED) {
        UA_Client_getConfig(client_.get())->noReconnect = true;
        identify();
    } else if (changed && channel == UA_SECURECHANNELSTATE_OPEN && when_open_ &&
               isAsSecureAsWanted()) {
        later(when_open_);
    }
}

/// The stack asks for the Endpoints without security first.
bool ClientCore::isAsSecureAsWanted() const {
    auto mode = UA_MESSAGESECURITYMODE_INVALID;
    const auto code = UA_Client_getConnectionAttribute_scalar(
        client_.get(), UA_QualifiedName{0, viewOf("securityMode")},
        &UA_TYPES[UA_TYPES_MESSAGESECURITYMODE], &mode);
    return !options_.security ||
           (code == UA_STATUSCODE_GOOD && mode == UA_MESSAGESECURITYMODE_SIGNANDENCRYPT);
}

void ClientCore::onState(UA_Client* client, UA_SecureChannelState channel, UA_SessionState session,
                         UA_StatusCode status) {
    coreOf(client).stateChanged(channel, session, StatusCode(status));
}

void ClientCore::onInactivity(UA_Client* client) {
    auto& core = coreOf(client);
    core.lose(status::kBadTimeout);
}

}  // namespace metier::opcua
