#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "commands.hpp"

namespace metier::dashboard {

using nlohmann::json;

namespace {

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

}  // namespace metier::dashboard
