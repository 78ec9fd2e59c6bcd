#pragma once

#include <gmock/gmock.h>

#include <chrono>
#include <memory>
#include <string>

#include "metier/client/skill_finder.hpp"
#include "metier/client/skill_handle.hpp"
#include "metier/skill/lambda_skill.hpp"
#include "served_skills.hpp"

namespace metier::system_tests {

namespace served = opcua_skill::testing;

/// Longest wait for anything of a server in this process.
inline SteadyTime soon() {
    return std::chrono::steady_clock::now() + std::chrono::seconds(10);
}

/// Skills of an arm with two axes, driven by the test's hand, on a server in this process; clients
/// find them by browsing.
class ServedContract : public served::ServedSkills {
protected:
    client::SkillHandle openSkill(opcua::Client& client, const std::string& name);
    /// A handle on a client that stays connected until the end of the test.
    client::SkillHandle openSkill(const std::string& name);

    /// Runs work as the application around a Program does, and waits for it.
    template <typename Work>
    void onServer(Work work) {
        const auto done = server().call(std::move(work));
        ASSERT_TRUE(done) << done.error().message;
    }

    std::string textAt(const served::ServedSkill& skill, std::string_view path);

    opcua::Client& client();

private:
    std::unique_ptr<opcua::Client> client_;
};

/// Outcome of a handle's call: the StatusCode's name.
template <typename T>
std::string statusOf(const opcua::Answer<T>& answer) {
    return answer ? "Good" : answer.error().status.name();
}

}  // namespace metier::system_tests
