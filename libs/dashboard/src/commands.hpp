#pragma once

#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "board.hpp"
#include "people.hpp"
#include "reply.hpp"
#include "tabs.hpp"
#include "watches.hpp"

namespace metier::dashboard {

/// Commands of people to servers. Each function handles one request of the API: it takes the
/// request's body and the sender, and returns the answer.
///
/// Threading: any; each waits for the servers that it asks, with deadlines.
class Commands {
public:
    /// `watches` and `tabs` must outlive this.
    Commands(Watches& watches, Tabs& tabs) : watches_(watches), tabs_(tabs) {}

    /// {tab, server or all, action: take or release}. Taking all leaves out servers that others
    /// use: who has control of an arm's server keeps the component that moves it from streaming.
    Reply control(const nlohmann::json& body, const std::shared_ptr<Person>& person);
    /// {tab, key, parameters}; needs no control, as nothing moves.
    Reply check(const nlohmann::json& body, const std::shared_ptr<Person>& person);
    /// {tab, key, parameters, execution?}
    Reply start(const nlohmann::json& body, const std::shared_ptr<Person>& person);
    /// {tab, key}: Suspend, Resume or Reset.
    Reply call(skill::Method method, const nlohmann::json& body,
               const std::shared_ptr<Person>& person);
    /// {key}: Halt of one skill; needs no control.
    Reply haltSkill(const nlohmann::json& body, const std::shared_ptr<Person>& person);
    /// {server?, arm?}: Halt of every skill of a server, of every skill that moves an arm, or of
    /// all. All servers are asked at the same time.
    Reply halt(const nlohmann::json& body, const std::shared_ptr<Person>& person);

private:
    struct Halted {
        std::string server;
        std::vector<std::string> skills{};  ///< keys of those that took it
        std::string error{};                ///< empty: none
    };

    Halted haltServer(const std::string& server, const std::vector<std::string>& keys,
                      const std::shared_ptr<Person>& person);
    /// Keys of the skills that a Halt is for, by server.
    std::map<std::string, std::vector<std::string>> skillsOf(const std::string& server,
                                                             const std::string& arm) const;
    Reply haltAll(const std::map<std::string, std::vector<std::string>>& skills,
                  const std::shared_ptr<Person>& person);

    Watches& watches_;
    Tabs& tabs_;
};

/// The parameters in a request, for that skill. Errors: not_found, type_mismatch, invalid_argument.
Result<skill::ValueMap> parametersIn(const nlohmann::json& body,
                                     const skill::SkillDescription& skill);

/// Result of a Check: verdict, duration [s] and the planned joint path, thinned out.
nlohmann::json checkJson(const skill::CheckReport& report);

}  // namespace metier::dashboard
