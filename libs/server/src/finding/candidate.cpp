#include "metier/server/candidate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string_view>
#include <utility>

namespace metier::server {
namespace {

constexpr std::string_view kLocalHost = "//localhost:";

/// The same for addresses that differ in form only.
std::string plainUrl(std::string url) {
    while (url.ends_with('/')) {
        url.pop_back();
    }
    if (const auto host = url.find(kLocalHost); host != std::string::npos) {
        url.replace(host, kLocalHost.size(), "//127.0.0.1:");
    }
    return url;
}

std::string nameOf(const opcua::FoundServer& server) {
    return server.name.empty() ? server.url : fmt::format("{}, {}", server.name, server.url);
}

/// Walks from a skill to all that it uses, and on.
class Walk {
public:
    explicit Walk(const std::vector<SurveyedServer>& servers) : servers_(servers) {}

    void from(std::size_t server, std::size_t skill) {
        reach({server, skill});
        while (!open_.empty()) {
            const auto place = open_.back();
            open_.pop_back();
            visit(place);
        }
    }

    KnownFigures result() const { return {.reach = told(reach_), .payload = told(payload_)}; }

private:
    using Place = std::pair<std::size_t, std::size_t>;  // server, skill

    struct Figure {
        std::optional<double> least;
        std::string least_of;
        std::string unknown;  // why, if it is
    };

    void reach(const Place& place) {
        if (seen_.insert(place).second) {
            open_.push_back(place);
        }
    }

    void visit(const Place& place) {
        const auto& server = servers_[place.first];
        const auto& skill = (*server.skills)[place.second];
        const bool has_arm = skill.arm.reach || skill.arm.payload;
        if (has_arm || (skill.uses.empty() && isA(skill, "MoveSkillType"))) {
            if (arms_.emplace(place.first, skill.address.controllerName()).second) {
                take(skill.arm.reach, server.server, reach_);
                take(skill.arm.payload, server.server, payload_);
            }
            return;
        }
        for (const auto& use : skill.uses) {
            follow(use, place.first);
        }
    }

    static void take(std::optional<double> value, const opcua::FoundServer& server,
                     Figure& figure) {
        if (!value) {
            figure.unknown = fmt::format("{} does not publish it", nameOf(server));
        } else if (!figure.least || *value < *figure.least) {
            figure.least = value;
            figure.least_of = nameOf(server);
        }
    }

    void follow(const client::SkillUse& use, std::size_t user) {
        const auto server = use.endpoint_url.empty() ? user : serverAt(use.endpoint_url);
        if (server == servers_.size()) {
            loseSight(fmt::format("{} was not asked", use.endpoint_url));
        } else if (!servers_[server].skills) {
            loseSight(fmt::format("{} does not answer", nameOf(servers_[server].server)));
        } else if (const auto skill = skillOf(server, use);
                   skill < servers_[server].skills->size()) {
            reach({server, skill});
        } else {
            loseSight(fmt::format("{} has no {}", nameOf(servers_[server].server), use.name));
        }
    }

    void loseSight(const std::string& why) {
        reach_.unknown = why;
        payload_.unknown = why;
    }

    std::size_t serverAt(const std::string& url) const {
        const auto found =
            std::find_if(servers_.begin(), servers_.end(), [&](const SurveyedServer& server) {
                return plainUrl(server.server.url) == plainUrl(url);
            });
        return static_cast<std::size_t>(found - servers_.begin());
    }

    std::size_t skillOf(std::size_t server, const client::SkillUse& use) const {
        const auto& skills = *servers_[server].skills;
        const auto found = std::find_if(skills.begin(), skills.end(), [&](const auto& skill) {
            return use.endpoint_url.empty()
                       ? skill.address.node == use.node
                       : skill.address.name == use.name &&
                             (use.controller.empty() ||
                              skill.address.controllerName() == use.controller);
        });
        return static_cast<std::size_t>(found - skills.begin());
    }

    KnownFigure told(const Figure& figure) const {
        if (!figure.unknown.empty()) {
            return {std::nullopt, figure.unknown};
        }
        if (!figure.least) {
            return {};
        }
        return {figure.least, arms_.size() == 1 ? fmt::format("of {}", figure.least_of)
                                                : fmt::format("of {}, the least of {} arms",
                                                              figure.least_of, arms_.size())};
    }

    const std::vector<SurveyedServer>& servers_;
    std::set<Place> seen_;
    std::vector<Place> open_;
    std::set<std::pair<std::size_t, std::string>> arms_;  // by server and controller
    Figure reach_;
    Figure payload_;
};

/// Name and unit of a figure, for messages.
struct Name {
    std::string_view name;
    std::string_view unit;
};

void judgeOne(const Name& figure, std::optional<double> wish, const KnownFigure& told,
              Verdict& verdict) {
    if (!wish) {
        return;
    }
    const auto note = told.note.empty() ? "" : fmt::format(" ({})", told.note);
    if (!told.value) {
        verdict.fits = false;
        verdict.reasons.push_back(fmt::format("{} unknown{}", figure.name, note));
        return;
    }
    const bool enough = *told.value >= *wish;
    verdict.fits = verdict.fits && enough;
    verdict.reasons.push_back(fmt::format("{} {:.3g} {} {} {:.3g} {}{}", figure.name, *told.value,
                                          figure.unit, enough ? ">=" : "<", *wish, figure.unit,
                                          note));
}

}  // namespace

KnownFigures figuresOf(const std::vector<SurveyedServer>& servers, std::size_t server,
                       std::size_t skill) {
    const auto& asked = (*servers[server].skills)[skill];
    if (asked.uses.empty() || asked.arm.reach || asked.arm.payload) {
        return {.reach = {asked.arm.reach, ""}, .payload = {asked.arm.payload, ""}};
    }
    Walk walk(servers);
    walk.from(server, skill);
    return walk.result();
}

Verdict judge(const ArmFigures& wishes, const KnownFigures& figures) {
    Verdict verdict;
    judgeOne({"reach", "m"}, wishes.reach, figures.reach, verdict);
    judgeOne({"payload", "kg"}, wishes.payload, figures.payload, verdict);
    return verdict;
}

}  // namespace metier::server
