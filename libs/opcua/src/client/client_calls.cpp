#include "client/client_calls.hpp"

#include <exception>
#include <utility>

namespace metier::opcua {

ClientCalls::Call& ClientCalls::add(SteadyTime deadline, Finish finish) {
    calls_.push_front({this, std::move(finish), {}, {}});
    auto& call = calls_.front();
    call.self = calls_.begin();
    call.due = due_.emplace(deadline, &call);
    return call;
}

void ClientCalls::drop(Call& call) {
    if (call.finish) {
        due_.erase(call.due);
    }
    calls_.erase(call.self);
}

void ClientCalls::refuse(Call& call, StatusCode status) {
    if (call.finish) {
        end(call, {status, nullptr, false});
    }
    calls_.erase(call.self);
}

void ClientCalls::onResponse(UA_Client* /*client*/, void* call, UA_UInt32 /*request*/,
                             void* response) {
    auto& answered = *static_cast<Call*>(call);
    auto& calls = *answered.calls;
    if (answered.finish) {
        const auto* header = static_cast<UA_ResponseHeader*>(response);  // every response's first
        end(answered, {StatusCode(header->serviceResult), response});
    }
    calls.calls_.erase(answered.self);
}

void ClientCalls::expire(SteadyTime now) {
    while (!due_.empty() && due_.begin()->first <= now) {
        end(*due_.begin()->second, {status::kBadTimeout});
    }
}

void ClientCalls::failAll(StatusCode status) {
    while (!due_.empty()) {
        end(*due_.begin()->second, {status});
    }
}

std::optional<SteadyTime> ClientCalls::nextDeadline() const {
    return due_.empty() ? std::nullopt : std::optional(due_.begin()->first);
}

void ClientCalls::end(Call& call, const Ending& ending) {
    call.calls->due_.erase(call.due);
    const auto finish = std::exchange(call.finish, nullptr);
    try {
        finish(ending);
    } catch (const std::exception&) {  // memory ran out over the response
        finish({status::kBadOutOfMemory});
    }
}

}  // namespace metier::opcua
