#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <string>

#include "metier/client/skill_handle.hpp"
#include "metier/opcua/client.hpp"

namespace metier::hostile {

/// A client that behaves well, and the skill that it has brought to Halted for good.
class Watcher {
public:
    /// Throws if it cannot.
    Watcher(const std::string& url, const opcua::ClientOptions& options);

    opcua::Client& client() { return *client_; }
    /// Asks for the state of the skill, and measures how long that takes.
    /// \return what is wrong, or empty
    std::string ask();
    std::chrono::milliseconds longestWait() const { return longest_; }

private:
    std::unique_ptr<opcua::Client> client_;
    client::SkillHandle skill_;
    std::chrono::milliseconds longest_{};
    std::atomic<int> transitions_{0};
};

}  // namespace metier::hostile
