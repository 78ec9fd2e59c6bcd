#include "watcher.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "../bench_server.hpp"
#include "answers.hpp"

namespace metier::hostile {

namespace {

using system_tests::orThrow;

client::SkillHandle guardedSkill(opcua::Client& client) {
    return orThrow(
        client::SkillHandle::open(client, orThrow(client::findSkill(client, "Guarded"))));
}

/// Options with long time-outs, so that the length of a late answer can be measured.
opcua::ClientOptions patient(opcua::ClientOptions options) {
    options.application_name = "watcher";
    options.call_timeout = std::chrono::seconds(30);
    options.connect_timeout = std::chrono::seconds(30);
    return options;
}

}  // namespace

Watcher::Watcher(const std::string& url, const opcua::ClientOptions& options)
    : client_(orThrow(opcua::Client::connect(url, patient(options)))),
      skill_(guardedSkill(*client_)) {
    orThrow(skill_.halt());
    orThrow(skill_.awaitState(skill::State::halted,
                              std::chrono::steady_clock::now() + std::chrono::seconds(10)));
    skill_.onTransition([this](const skill::TransitionEvent& event) {
        transitions_ += event.from == skill::State::halted ? 1 : 0;
    });
}

std::string Watcher::ask() {
    const auto begin = std::chrono::steady_clock::now();
    const auto state = skill_.state();
    const auto waited = std::chrono::duration_cast<std::chrono::milliseconds>(
        std::chrono::steady_clock::now() - begin);
    longest_ = std::max(longest_, waited);
    if (!state) {
        return "the client that behaves: " + state.error().message;
    }
    if (*state != skill::State::halted || transitions_ != 0) {
        return fmt::format("the guarded skill is {}, and left Halted {} times", toString(*state),
                           transitions_.load());
    }
    return waited > kLongestAnswer ? fmt::format("an answer took {} ms", waited.count()) : "";
}

}  // namespace metier::hostile
