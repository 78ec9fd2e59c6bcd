// Reconnection of a ClientCore after the loss of its connection.
#include <algorithm>
#include <array>
#include <utility>

#include "client/client_core.hpp"
#include "common/convert.hpp"

namespace metier::opcua {

namespace {

using std::chrono::steady_clock;

const NodeId kStartTime{0, 2257U};

/// Refusals of ActivateSession that mean: the server does not have this session any more.
bool refusesSession(StatusCode status) {
    constexpr std::array refusals{status::kBadSessionIdInvalid, status::kBadSessionClosed,
                                  status::kBadSessionNotActivated};
    return std::find(refusals.begin(), refusals.end(), status) != refusals.end();
}

ServerIdentity identityFrom(const UA_ReadResponse& response) {
    const auto start_time = fromNative(response.results[0]).value.as<UtcTime>();
    const auto namespaces = fromNative(response.results[1]).value.as<std::vector<std::string>>();
    return {start_time.value_or(UtcTime{}), namespaces.value_or(std::vector<std::string>{})};
}

}  // namespace

/// The connection broke, or broke again before all was restored.
void ClientCore::interrupt(StatusCode status) {
    const bool was_open = std::exchange(phase_, Phase::waiting) == Phase::open;
    Failure why{errorFrom(status, url_), status, {}};
    why.code = Errc::connection_lost;
    outage_ = why;
    subscriptions_.interrupt(status);
    if (!was_open) {
        calls_.failAll(status);
        return waitAgain(why);
    }
    ++connection_;
    {
        const std::lock_guard lock(state_mutex_);
        why_lost_ = why;
    }
    setState(Client::State::reconnecting);
    schedule_->begin(steady_clock::now());
    calls_.failAll(status);
    tell({.kind = ConnectionChange::Kind::lost, .why = std::move(why)});
}

bool ClientCore::hasSession() const {
    auto session = UA_SESSIONSTATE_CLOSED;
    if (client_) {
        UA_Client_getState(client_.get(), nullptr, &session, nullptr);
    }
    return session == UA_SESSIONSTATE_CREATED || session == UA_SESSIONSTATE_ACTIVATED;
}

void ClientCore::attemptIfDue() {
    if (phase_ != Phase::waiting || ending_ || steady_clock::now() < schedule_->next()) {
        return;
    }
    if (client_ && channelState() != UA_SECURECHANNELSTATE_CLOSED) {
        return loop_.dropOpened();  // the next iteration reports it to the stack
    }
    session_kept_ = hasSession();
    if (!session_kept_) {
        client_.reset();
    }
    phase_ = Phase::attempting;
    connectNow();
}

/// The attempt under way has brought a session and the server's identity, or neither.
void ClientCore::attempted(const Answer<>& outcome) {
    if (outcome) {
        return restore();
    }
    const auto& why = outcome.error();
    if (session_kept_ && refusesSession(why.status)) {
        phase_ = Phase::waiting;
        schedule_->retry(steady_clock::now());  // the stack has dropped the session
    } else if (!session_kept_ && why.code == Errc::access_denied) {
        calls_.failAll(why.status);
        loseForGood(why);
    } else {
        waitAgain(why);
    }
    loop_.post([this] { loop_.dropOpened(); });
}

void ClientCore::waitAgain(const Failure& why) {
    phase_ = Phase::waiting;
    const auto now = steady_clock::now();
    if (schedule_->expired(now)) {
        return loseForGood(why);
    }
    schedule_->failed(now);
}

/// Asks which run of the server this is, if that is of interest; settle() follows.
void ClientCore::identify() {
    if (!reconnects()) {
        return settle({});
    }
    if (std::exchange(identifying_, true)) {
        return;
    }
    later([this] {
        std::array<UA_ReadValueId, 2> items{};
        items[0].nodeId = viewOf(kStartTime);
        items[1].nodeId = viewOf(ids::kNamespaceArray);
        UA_ReadRequest request{};
        request.timestampsToReturn = UA_TIMESTAMPSTORETURN_NEITHER;
        request.nodesToReadSize = items.size();
        request.nodesToRead = items.data();
        for (auto& item : items) {
            item.attributeId = UA_ATTRIBUTEID_VALUE;
        }
        send(request, {"identifying the server", Deadline::in(options_.connect_timeout)},
             [this](auto answer) { identified(answer); });
    });
}

void ClientCore::identified(const Answer<UA_ReadResponse*>& answer) {
    if (!identifying_ || connecting_ == nullptr) {
        return;
    }
    if (!answer || (*answer)->resultsSize != 2) {
        return refuse(answer ? status::kBadUnexpectedError : answer.error().status);
    }
    found_ = identityFrom(**answer);
    if (phase_ == Phase::connecting) {
        server_ = found_;
    }
    settle({});
}

void ClientCore::restore() {
    phase_ = Phase::restoring;
    subscriptions_.resume({.session_kept = session_kept_,
                           .move = NamespaceMove(server_.namespaces, found_.namespaces)},
                          [this] { restored(); });
}

void ClientCore::restored() {
    if (phase_ != Phase::restoring) {
        return;
    }
    const bool told = server_.start_time != UtcTime{} || found_.start_time != UtcTime{};
    const bool restarted = told ? server_.start_time != found_.start_time : !session_kept_;
    server_ = std::move(found_);
    outage_.reset();
    phase_ = Phase::open;
    boot_ += restarted ? 1 : 0;
    ++connection_;
    setState(Client::State::connected);
    tell({.kind = ConnectionChange::Kind::back,
          .server_restarted = restarted,
          .same_session = session_kept_});
}

}  // namespace metier::opcua
