#pragma once

#include <chrono>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "metier/client/async_skill.hpp"
#include "metier/opcua/client.hpp"
#include "server_link.hpp"

namespace metier::dashboard {

/// A session with one server, and the skills that were used by it.
///
/// Threading: any; waits for the server.
class SkillSession {
public:
    explicit SkillSession(std::unique_ptr<opcua::Client> client) : client_(std::move(client)) {}

    opcua::Client& client() noexcept { return *client_; }
    bool isConnected() const noexcept {
        return client_->state() == opcua::Client::State::connected;
    }
    /// The skill, as this session uses it. Errors: the server's.
    opcua::Answer<std::shared_ptr<client::AsyncSkill>> skill(const LinkedSkill& linked);

private:
    const std::unique_ptr<opcua::Client> client_;  // first: the skills use it
    std::mutex mutex_;
    // Shared with the threads that wait for an answer at this moment.
    std::map<std::string, std::shared_ptr<client::AsyncSkill>> skills_;
};

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
        return opcua::failed(opcua::status::kBadTimeout, "waiting for an answer");
    }
    return answer.get();
}

/// A refusal with the server's own reason, where it gives one.
Error explained(const opcua::Failure& failure, const client::AsyncSkill& skill,
                std::string_view what);

}  // namespace metier::dashboard
