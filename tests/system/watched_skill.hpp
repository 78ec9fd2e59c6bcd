#pragma once

#include <memory>
#include <stdexcept>
#include <string>

#include "metier/base/queue.hpp"
#include "metier/client/skill_handle.hpp"
#include "metier_program.hpp"

namespace metier::system_tests {

/// A skill and its transitions, for a client that watches or commands.
class Watched {
public:
    Watched(const std::string& url, const std::string& name)
        : client_(connectTo(url)), skill_(openSkill(*client_, name)) {
        skill_.onTransition(
            [this](const skill::TransitionEvent& event) { events_.tryPush(event); });
    }
    ~Watched() { skill_.onTransition({}); }
    Watched(const Watched&) = delete;
    Watched& operator=(const Watched&) = delete;

    client::SkillHandle& operator*() { return skill_; }
    client::SkillHandle* operator->() { return &skill_; }
    opcua::Client& client() { return *client_; }

    /// The next transition to that state, within a minute.
    skill::TransitionEvent awaitEvent(skill::State to) {
        while (auto event = events_.popUntil(inAMinute())) {
            if (event->to == to) {
                return *event;
            }
        }
        throw std::runtime_error(skill_.address().name + ": no transition to " +
                                 std::string(toString(to)));
    }

private:
    Queue<skill::TransitionEvent> events_{1'000};
    std::unique_ptr<opcua::Client> client_;
    client::SkillHandle skill_;
};

}  // namespace metier::system_tests
