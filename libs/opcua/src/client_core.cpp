#include "client_core.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace metier::opcua {

namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kLongestIdle{1'000};
constexpr milliseconds kGoodbye{1'000};         // for the server to answer CloseSession
constexpr milliseconds kLateAnswers{60'000};    // kept apart from attacks that long
constexpr std::size_t kMostUnanswered = 2'000;  // besides PublishRequests
constexpr int kMostAttempts = 4;                // an endpoint may send us elsewhere

ClientCore& coreOf(UA_Client* client) {
    return *static_cast<ClientCore*>(UA_Client_getConfig(client)->clientContext);
}

/// What the stack reports when a connection breaks differs by the moment; all mean the same.
Failure lostFailure(std::string_view doing, StatusCode status) {
    return {{Errc::connection_lost,
             fmt::format("{}: the connection is lost ({})", doing, status.name())},
            status,
            {}};
}

EventLoopOptions loopOptions(const ClientOptions& options, const UA_Logger* logger) {
    EventLoopOptions loop;
    loop.connect_limit = options.connect_timeout;
    loop.logger = logger;
    return loop;
}

}  // namespace

ClientCore::ClientCore(ClientOptions options, ClientPurpose purpose)
    : options_(std::move(options)),
      purpose_(purpose),
      loop_(loopOptions(options_, complaints_.logger())),
      subscriptions_(*this) {}

ClientCore::~ClientCore() {
    close();
}

Answer<> ClientCore::connect(const std::string& url) {
    url_ = url;
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
            state_ = Client::State::closed;
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
    if (state_ == Client::State::lost) {
        return tl::unexpected(lostFailure("nothing was sent", status::kBadNotConnected));
    }
    return post(std::move(work));
}

void ClientCore::onConnectionLost(std::function<void(const Failure&)> callback) {
    const auto posted = post([this, callback = std::move(callback)]() mutable {
        if (lost_) {
            later([this, callback = std::move(callback)] { callback(*lost_); });
        } else {
            on_lost_ = std::move(callback);
        }
    });
    static_cast<void>(posted);  // closed: nobody is to be told any more
}

void ClientCore::run() {
    own_thread_ = std::this_thread::get_id();
    begin();
    while (!ending_) {
        iterate(kLongestIdle);
    }
    end();
    own_thread_ = std::thread::id();  // another thread may get this one's
}

void ClientCore::begin() {
    auto* loop = loop_.handle();
    loop->start(loop);
    auto config = makeClientConfig(options_, purpose_, {loop, complaints_.logger()});
    config.clientContext = this;
    config.stateCallback = &onState;
    config.inactivityCallback = &onInactivity;
    client_.reset(UA_Client_newWithConfig(&config));
    connecting_ = &calls_.add(steady_clock::now() + options_.connect_timeout,
                              [this](StatusCode status, void*) { refuse(status); });
    const StatusCode status(purpose_ == ClientPurpose::session
                                ? UA_Client_connectAsync(client_.get(), url_.c_str())
                                : UA_Client_connectSecureChannelAsync(client_.get(), url_.c_str()));
    if (status.isBad()) {
        refuse(status);
    }
}

void ClientCore::iterate(milliseconds longest) {
    const auto now = steady_clock::now();
    const auto next = calls_.nextDeadline().value_or(SteadyTime::max());
    const auto wait = next < now + longest ? std::chrono::ceil<milliseconds>(next - now) : longest;
    if (!loop_.runOnce(std::max(wait, milliseconds::zero()))) {
        lose(status::kBadInternalError);
    }
    calls_.expire(steady_clock::now());
    sayEverything();
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
    calls_.failAll(status::kBadConnectionClosed);
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
        return finish(status::kBadConnectionClosed, nullptr);
    }
    if (deadline <= now) {
        return finish(status::kBadTimeout, nullptr);
    }
    const bool publish = deadline == SteadyTime::max();
    if (!publish && calls_.size() >= kMostUnanswered) {
        return finish(status::kBadResourceUnavailable, nullptr);
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

Failure ClientCore::failure(const Task& task, StatusCode status) const {
    if (lost_) {
        return lostFailure(task.doing, lost_->status);
    }
    Failure failure{errorFrom(status, task.doing), status, {}};
    if (failure.code == Errc::connection_lost) {
        return lostFailure(task.doing, status);
    }
    if (failure.code == Errc::timeout) {
        failure.message += fmt::format(", no answer within {} ms", task.deadline.allowed.count());
    } else if (status == status::kBadResourceUnavailable && calls_.size() >= kMostUnanswered) {
        failure.message += fmt::format(", {} requests are unanswered", calls_.size());
    }
    return failure;
}

void ClientCore::settle(Answer<> outcome) {
    if (connecting_ != nullptr) {
        calls_.drop(*std::exchange(connecting_, nullptr));
        connected_.set_value(std::move(outcome));
    }
}

void ClientCore::refuse(StatusCode status) {
    Failure failure{errorFrom(status, "connecting to " + url_), status, {}};
    if (!complaints_.last().empty()) {
        failure.message += fmt::format(" ({})", complaints_.last());
    }
    settle(tl::unexpected(std::move(failure)));
}

void ClientCore::lose(StatusCode status) {
    if (lost_ || connecting_ != nullptr || ending_) {
        return;
    }
    lost_ = lostFailure(url_, status);
    auto connected = Client::State::connected;
    state_.compare_exchange_strong(connected, Client::State::lost);  // closed stays closed
    calls_.failAll(status);
    subscriptions_.end(status);
    if (on_lost_) {
        later([this, callback = std::exchange(on_lost_, nullptr)] { callback(*lost_); });
    }
}

void ClientCore::stateChanged(UA_SecureChannelState channel, UA_SessionState session,
                              StatusCode status) {
    if (connecting_ != nullptr) {
        connectingChanged(channel, session, status);
    } else if (status.isBad()) {
        lose(status);
    } else if (purpose_ == ClientPurpose::session && session != UA_SESSIONSTATE_ACTIVATED) {
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
        settle({});
    } else if (changed && channel == UA_SECURECHANNELSTATE_OPEN && when_open_) {
        later(when_open_);
    }
}

void ClientCore::onState(UA_Client* client, UA_SecureChannelState channel, UA_SessionState session,
                         UA_StatusCode status) {
    coreOf(client).stateChanged(channel, session, StatusCode(status));
}

void ClientCore::onInactivity(UA_Client* client) {
    auto& core = coreOf(client);
    core.lose(status::kBadTimeout);
    static_cast<void>(core.post([client] { UA_Client_disconnectSecureChannelAsync(client); }));
}

}  // namespace metier::opcua
