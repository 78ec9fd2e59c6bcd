#pragma once

#include <chrono>
#include <future>
#include <memory>
#include <utility>

#include "metier/opcua/client.hpp"

namespace metier::dashboard {

/// Sends a request of an AsyncSkill and waits for what it is answered, at the latest at the
/// client's time-out and some more.
template <typename T, typename Send>
opcua::Answer<T> awaitAnswer(Send send) {
    constexpr std::chrono::seconds kLongest{10};
    // With the callback, which may come after this has given up.
    auto promise = std::make_shared<std::promise<opcua::Answer<T>>>();
    auto answer = promise->get_future();
    auto sent = send([promise](opcua::Answer<T> told) { promise->set_value(std::move(told)); });
    if (!sent) {
        return tl::unexpected(sent.error());
    }
    if (answer.wait_for(kLongest) != std::future_status::ready) {
        auto late = opcua::failed(opcua::status::kBadTimeout, "waiting for an answer");
        late.value().delivery = opcua::Failure::Delivery::unknown;
        return late;
    }
    return answer.get();
}

}  // namespace metier::dashboard
