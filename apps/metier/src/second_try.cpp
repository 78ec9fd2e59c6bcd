#include "second_try.hpp"

#include <thread>

#include "metier/client/skill_finder.hpp"
#include "servers.hpp"

namespace metier::app {
namespace {

constexpr std::chrono::milliseconds kBetweenResets{200};

}  // namespace

Result<void> resetUntilReady(client::SkillHandle& skill, std::chrono::milliseconds longest) {
    const auto deadline = std::chrono::steady_clock::now() + longest;
    for (;;) {
        METIER_ASSIGN(const auto state, skill.state());
        if (state != skill::State::halted) {
            return {};
        }
        const auto reset = skill.reset();
        if (!reset && std::chrono::steady_clock::now() + kBetweenResets > deadline) {
            return fail(reset.error().code, "Reset: " + reset.error().message);
        }
        if (!reset) {
            std::this_thread::sleep_for(kBetweenResets);
        }
    }
}

void resetAllHalted(const CommandIdentity& identity, const std::vector<std::string>& urls,
                    std::chrono::milliseconds longest) {
    for (const auto& url : urls) {
        const auto client = connectTo(identity, url);
        const auto skills = client ? client::findSkills(**client)
                                   : opcua::Answer<std::vector<client::SkillAddress>>();
        if (!client || !skills) {
            continue;
        }
        for (const auto& address : *skills) {
            auto skill = client::SkillHandle::open(**client, address);
            if (skill) {
                // The next start says why, if it was in vain.
                static_cast<void>(resetUntilReady(*skill, longest));
            }
        }
    }
}

}  // namespace metier::app
