#include "commands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <future>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>
#include <utility>

#include "metier/opcua/text.hpp"
#include "metier/skill/values.hpp"

namespace metier::dashboard {

using client::AsyncSkill;
using nlohmann::json;

namespace {

/// A skill that a request names, and the session by which it is asked.
struct Named {
    ReachedSkill reached;
    std::shared_ptr<TabSession> tab;        // null: a session of the person is used
    std::shared_ptr<SkillSession> session;  // session of the person
    std::shared_ptr<AsyncSkill> skill;
};

std::string serverOf(const std::string& key) {
    return key.substr(0, key.find('/'));
}

/// As the tab that has control.
Result<Named> commandedSkill(Watches& watches, Tabs& tabs, const json& body, const Person& person) {
    METIER_ASSIGN(const auto key, textIn(body, "key"));
    METIER_ASSIGN(const auto tab, textIn(body, "tab"));
    METIER_ASSIGN(auto reached, watches.skill(key));
    METIER_ASSIGN(auto session, tabs.session(tab, person, serverOf(key)));
    METIER_ASSIGN(auto skill, session->session().skill(*reached.skill));
    return Named{std::move(reached), std::move(session), nullptr, std::move(skill)};
}

/// Skill for a command that needs no control. It is sent as the tab if that has control, since the
/// server shows other clients that the skill is not theirs.
Result<Named> askedSkill(Watches& watches, Tabs& tabs, const json& body, Person& person) {
    METIER_ASSIGN(const auto key, textIn(body, "key"));
    METIER_ASSIGN(const auto tab, textOrNone(body, "tab"));
    if (tabs.session(tab, person, serverOf(key))) {
        return commandedSkill(watches, tabs, body, person);
    }
    METIER_ASSIGN(auto reached, watches.skill(key));
    METIER_ASSIGN(auto session, person.session(serverOf(key)));
    METIER_ASSIGN(auto skill, session->skill(*reached.skill));
    return Named{std::move(reached), nullptr, std::move(session), std::move(skill)};
}

opcua::Answer<> callOnce(const client::AsyncSkill& skill, skill::Method method) {
    return awaitAnswer<void>([&](auto done) { return skill.call(method, std::move(done)); });
}

/// Asks again while the device takes its time, for a second after its first answer at most.
opcua::Answer<> resetUntilDone(const client::AsyncSkill& skill) {
    constexpr std::chrono::milliseconds kPause{20};
    auto asked = callOnce(skill, skill::Method::reset);
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(1);
    while (!asked && asked.error().code == Errc::timeout &&
           asked.error().delivery == opcua::Failure::Delivery::answered &&
           std::chrono::steady_clock::now() < deadline) {
        std::this_thread::sleep_for(kPause);
        asked = callOnce(skill, skill::Method::reset);
    }
    return asked;
}

/// Asks again while a composed skill asks the skills that it uses.
opcua::Answer<skill::CheckReport> checkUntilDone(const client::AsyncSkill& skill,
                                                 const skill::ValueMap& values) {
    constexpr std::chrono::milliseconds kPause{20};
    const auto ask = [&] {
        return awaitAnswer<skill::CheckReport>(
            [&](auto done) { return skill.check(skill::CheckRequest{values}, std::move(done)); });
    };
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(15);
    auto report = ask();
    while (!report && report.error().code == Errc::timeout &&
           report.error().delivery == opcua::Failure::Delivery::answered &&
           std::chrono::steady_clock::now() < deadline) {
        std::this_thread::sleep_for(kPause);
        report = ask();
    }
    return report;
}

/// Names of servers, each with that of one that uses it.
using UsedServers = std::map<std::string, std::string>;

struct ChangedControl {
    json done = json::array();
    json failed = json::array();
    json left_out = json::array();
    std::optional<Error> first{};  // first failure
};

/// \param used are left out
ChangedControl changeControl(const std::vector<std::string>& servers, const UsedServers& used,
                             const std::function<Result<void>(const std::string&)>& change) {
    ChangedControl control;
    for (const auto& server : servers) {
        if (const auto user = used.find(server); user != used.end()) {
            control.left_out.push_back({{"server", server}, {"used_by", user->second}});
        } else if (const auto changed = change(server)) {
            control.done.push_back(server);
        } else {
            control.failed.push_back({{"server", server},
                                      {"code", toString(changed.error().code)},
                                      {"message", changed.error().message}});
            control.first = control.first ? control.first : changed.error();
        }
    }
    return control;
}

}  // namespace

Result<skill::ValueMap> parametersIn(const json& body, const skill::SkillDescription& skill) {
    skill::ValueMap values;
    const auto found = body.find("parameters");
    if (found == body.end() || found->is_null()) {
        return values;
    }
    if (!found->is_object()) {
        return fail(Errc::invalid_argument, "parameters: an object expected");
    }
    for (const auto& [name, value] : found->items()) {
        const auto field =
            std::find_if(skill.parameters.begin(), skill.parameters.end(),
                         [&wanted = name](const skill::Field& one) { return one.name == wanted; });
        if (field == skill.parameters.end()) {
            return fail(Errc::not_found, fmt::format("{} has no parameter '{}'", skill.name,
                                                     opcua::sanitise(name.substr(0, 60))));
        }
        METIER_ASSIGN(auto typed, skill::valueFrom(value, field->type, name));
        values[name] = std::move(typed);
    }
    return values;
}

json checkJson(const skill::CheckReport& report) {
    constexpr std::size_t kMost = 200;
    const auto& path = report.joint_path;
    const auto kept = std::min(path.size(), kMost);
    auto preview = json::array();
    for (std::size_t i = 0; i < kept; ++i) {
        const auto row = thinned(i, kept, path.size());
        const double fraction =
            path.size() < 2 ? 0.0 : static_cast<double>(row) / static_cast<double>(path.size() - 1);
        preview.push_back(
            {{"time", rounded(fraction * report.planned_duration)}, {"q", rounded(path[row])}});
    }
    return {{"possible", report.possible},
            {"code", report.possible ? "" : "refused"},
            {"message", report.reason},
            {"duration", rounded(report.planned_duration)},
            {"stopping_time", rounded(report.stopping_time)},
            {"stopping_distance", rounded(report.stopping_distance)},
            {"first_failing_fraction", report.first_failing_fraction},
            {"notes", report.notes},
            {"preview", std::move(preview)}};
}

Reply Commands::control(const json& body, const std::shared_ptr<Person>& person) {
    METIER_ASSIGN(const auto tab, textIn(body, "tab"));
    METIER_ASSIGN(const auto action, textIn(body, "action"));
    METIER_ASSIGN(const auto server, textOrNone(body, "server"));
    if (action != "take" && action != "release") {
        return fail(Errc::invalid_argument, "action: take or release expected");
    }
    const bool takes = action == "take";
    const bool all = server.empty() || server == "all";
    const auto changed = changeControl(
        all ? watches_.servers() : std::vector{server},
        all && takes ? watches_.usedServers() : UsedServers(), [&](const std::string& one) {
            return takes ? tabs_.take(tab, person, one) : tabs_.release(tab, *person, one);
        });
    if (changed.first && changed.done.empty()) {
        return errorReply(*changed.first);
    }
    return {200,
            {{takes ? "taken" : "released", changed.done},
             {"failed", changed.failed},
             {"left_out", changed.left_out}}};
}

Reply Commands::check(const json& body, const std::shared_ptr<Person>& person) {
    METIER_ASSIGN(const auto named, askedSkill(watches_, tabs_, body, *person));
    METIER_ASSIGN(const auto values, parametersIn(body, named.skill->description()));
    const auto report = checkUntilDone(*named.skill, values);
    return report ? Reply{200, checkJson(*report)}
                  : errorReply(explained(report.error(), *named.skill, "Check"));
}

Reply Commands::start(const json& body, const std::shared_ptr<Person>& person) {
    METIER_ASSIGN(const auto named, commandedSkill(watches_, tabs_, body, *person));
    skill::StartRequest request;
    METIER_ASSIGN(request.parameters, parametersIn(body, named.skill->description()));
    METIER_ASSIGN(request.execution_id, textOrNone(body, "execution"));
    METIER_ASSIGN(request.epoch, named.tab->epochOf(named.reached.skill->control));
    const auto id = named.tab->session().start(*named.reached.skill, request);
    return id ? Reply{200, {{"execution", opcua::sanitise(*id)}}}
              : errorReply(explained(id.error(), *named.skill, "Start"));
}

Reply Commands::call(skill::Method method, const json& body,
                     const std::shared_ptr<Person>& person) {
    METIER_ASSIGN(const auto named, commandedSkill(watches_, tabs_, body, *person));
    const auto called = method == skill::Method::reset ? resetUntilDone(*named.skill)
                                                       : callOnce(*named.skill, method);
    return called ? Reply{} : errorReply(explained(called.error(), *named.skill, toString(method)));
}

Reply Commands::haltSkill(const json& body, const std::shared_ptr<Person>& person) {
    METIER_ASSIGN(const auto key, textIn(body, "key"));
    METIER_TRY(watches_.skill(key));
    return haltAll({{serverOf(key), {key}}}, person);
}

Reply Commands::halt(const json& body, const std::shared_ptr<Person>& person) {
    METIER_ASSIGN(const auto server, textOrNone(body, "server"));
    METIER_ASSIGN(const auto arm, textOrNone(body, "arm"));
    const auto skills = skillsOf(server, arm);
    if (skills.empty() && !(server.empty() && arm.empty())) {
        return fail(Errc::not_found,
                    fmt::format("no skill of '{}' to halt", server.empty() ? arm : server));
    }
    return haltAll(skills, person);
}

std::map<std::string, std::vector<std::string>> Commands::skillsOf(const std::string& server,
                                                                   const std::string& arm) const {
    std::map<std::string, std::vector<std::string>> wanted;
    for (const auto& name : watches_.servers()) {
        if (!server.empty() && server != name) {
            continue;
        }
        const auto link = watches_.link(name);
        auto keys = std::vector<std::string>();
        for (const auto& skill : link ? link->offer().skills : json::array()) {
            if (arm.empty() || skill.at("arm") == arm) {
                keys.push_back(skill.at("key").get<std::string>());
            }
        }
        // A server that cannot be reached is included: the answer must show that it did not halt.
        if (!keys.empty() || (!link && arm.empty())) {
            wanted[name] = std::move(keys);
        }
    }
    return wanted;
}

Commands::Halted Commands::haltServer(const std::string& server,
                                      const std::vector<std::string>& keys,
                                      const std::shared_ptr<Person>& person) {
    Halted halted{server};
    const auto link = watches_.link(server);
    if (!link) {
        halted.error = fmt::format("{} is not connected", server);
        return halted;
    }
    // In a lab everybody may halt, so no session of the person is needed.
    auto session = person->isOfLab() ? Result<std::shared_ptr<SkillSession>>(nullptr)
                                     : person->session(server);
    if (!session) {
        halted.error = session.error().message;
        return halted;
    }
    auto& own = *session == nullptr ? link->client() : (*session)->client();
    // A lock of the device keeps all sessions out but the one that started.
    const auto tab = tabs_.sessionOf(*person, server);
    std::vector<std::pair<std::string, std::future<opcua::Answer<opcua::CallResult>>>> asked;
    for (const auto& key : keys) {
        const auto* skill = link->find(key);
        if (skill == nullptr) {
            continue;
        }
        if (skill->halt.isNull()) {
            halted.error = fmt::format("{} has no Halt", key);
            continue;
        }
        if (tab) {
            tab->session().expectHalt(key);
        }
        // With the callback, which may come after this has given up.
        auto promise = std::make_shared<std::promise<opcua::Answer<opcua::CallResult>>>();
        asked.emplace_back(key, promise->get_future());
        auto& client = tab && skill->skill->locksDevice() ? tab->session().client() : own;
        auto sent = client.callAsync({skill->address.node, skill->halt, {}},
                                     [promise](auto told) { promise->set_value(std::move(told)); });
        if (!sent) {
            promise->set_value(tl::unexpected(sent.error()));
        }
    }
    for (auto& [key, answer] : asked) {
        constexpr std::chrono::seconds kLongest{10};
        if (answer.wait_for(kLongest) != std::future_status::ready) {
            halted.error = fmt::format("{} does not answer", server);
            continue;
        }
        const auto told = answer.get();
        if (told || told.error().status == opcua::status::kBadInvalidState) {
            halted.skills.push_back(key);  // else it stands still already
        } else {
            halted.error = opcua::sanitise(fmt::format("{}: {}", key, told.error().message));
        }
    }
    return halted;
}

Reply Commands::haltAll(const std::map<std::string, std::vector<std::string>>& skills,
                        const std::shared_ptr<Person>& person) {
    std::vector<std::future<Halted>> asked;
    for (const auto& [server, keys] : skills) {
        asked.push_back(
            std::async(std::launch::async, [this, &person, server = server, &keys = keys] {
                return haltServer(server, keys, person);
            }));
    }
    auto halted = json::array();
    auto failed = json::array();
    for (auto& answer : asked) {
        const auto one = answer.get();
        for (const auto& key : one.skills) {
            halted.push_back(key);
        }
        if (!one.error.empty()) {
            failed.push_back({{"server", one.server}, {"message", one.error}});
        }
    }
    return {200, {{"halted", halted}, {"failed", failed}}};
}

}  // namespace metier::dashboard
