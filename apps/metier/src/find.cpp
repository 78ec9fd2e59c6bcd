#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "candidate.hpp"
#include "commands.hpp"
#include "metier/discovery/search.hpp"
#include "skill_survey.hpp"

namespace metier::app {
namespace {

// Where OPC 10000-12 has the discovery server of a machine.
constexpr const char* kLocalDiscovery = "opc.tcp://127.0.0.1:4840";

struct FindOptions {
    std::string type;
    ArmWishes wishes;
    std::vector<std::string> at;
    std::vector<std::string> discovery;
    bool json = false;
};

discovery::Sighting searchFor(const FindOptions& options) {
    auto asked = options.discovery;
    const bool everywhere = asked.empty() && options.at.empty();
    if (everywhere) {
        asked.emplace_back(kLocalDiscovery);
    }
    auto sighting = discovery::searchServers(
        asked, everywhere ? discovery::Mdns::asked : discovery::Mdns::left_out);
    std::vector<discovery::FoundServer> given;
    for (const auto& url : options.at) {
        given.push_back({url, "", "command line"});
    }
    discovery::merge(sighting.servers, std::move(given));
    return sighting;
}

std::string nameOf(const SurveyedSkill& skill) {
    const auto controller = skill.address.controllerName();
    return controller.empty() ? skill.address.name : controller + "/" + skill.address.name;
}

std::vector<std::string> reasonsOf(const SurveyedSkill& skill, const Verdict& verdict) {
    auto reasons = verdict.reasons;
    reasons.insert(reasons.begin(), fmt::format("type {}", fmt::join(skill.types, " < ")));
    return reasons;
}

/// Prints what was found; counts what fits.
class Findings {
public:
    explicit Findings(const FindOptions& options) : options_(options) {}

    void add(const SurveyedServer& server) {
        if (!server.skills) {
            silent_.push_back({{"url", server.server.url},
                               {"name", server.server.name},
                               {"error", server.skills.error().message}});
            say(server.server, fmt::format("does not answer: {}", server.skills.error().message));
            return;
        }
        for (const auto& skill : *server.skills) {
            add(server.server, skill);
        }
    }
    void addProblem(const Error& error) {
        problems_.push_back(error.message);
        fmt::print(stderr, "metier: {}\n", error.message);
    }

    Exit finish() const {
        if (options_.json) {
            const nlohmann::json all{
                {"candidates", candidates_}, {"silent", silent_}, {"problems", problems_}};
            fmt::print("{}\n", all.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
        } else if (fitting_ == 0) {
            fmt::print("nothing fits\n");
        }
        return fitting_ == 0 ? Exit::failed : Exit::success;
    }

private:
    void say(const discovery::FoundServer& server, const std::string& text) const {
        if (!options_.json) {
            fmt::print("{:<28} {:<12} {}\n", server.url, server.name, text);
        }
    }

    void add(const discovery::FoundServer& server, const SurveyedSkill& skill) {
        const auto verdict = judge(options_.wishes, skill.arm.reach, skill.arm.payload);
        const auto reasons = reasonsOf(skill, verdict);
        fitting_ += verdict.fits ? 1 : 0;
        say(server, fmt::format("{} {}: {}", nameOf(skill), verdict.fits ? "fits" : "does not fit",
                                fmt::join(reasons, ", ")));
        const auto or_null = [](const std::optional<double>& number) {
            return number ? nlohmann::json(*number) : nlohmann::json();
        };
        candidates_.push_back({{"url", server.url},
                               {"server", server.name},
                               {"told_by", server.told_by},
                               {"controller", skill.address.controllerName()},
                               {"skill", skill.address.name},
                               {"types", skill.types},
                               {"reach", or_null(skill.arm.reach)},
                               {"payload", or_null(skill.arm.payload)},
                               {"fits", verdict.fits},
                               {"reasons", reasons}});
    }

    const FindOptions& options_;
    int fitting_ = 0;
    nlohmann::json candidates_ = nlohmann::json::array();
    nlohmann::json silent_ = nlohmann::json::array();
    nlohmann::json problems_ = nlohmann::json::array();
};

Exit runFind(const FindOptions& options) {
    Findings findings(options);
    const auto sighting = searchFor(options);
    for (const auto& problem : sighting.problems) {
        findings.addProblem(problem);
    }
    for (const auto& server : survey(sighting.servers, [&](const SurveyedSkill& skill) {
             return isA(skill, options.type);
         })) {
        findings.add(server);
    }
    return findings.finish();
}

}  // namespace

void addFind(CLI::App& app, Exit& exit) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto options = std::make_shared<FindOptions>();
    auto* command = app.add_subcommand(
        "find", "Find skills of a type over the network, and say what fits and why");
    command
        ->add_option("type", options->type,
                     "Type of the skill, such as JointPtpMoveSkillType or, for all moves, "
                     "MoveSkillType")
        ->required();
    command->add_option("--reach", options->wishes.reach, "Least reach of the arm [m]")
        ->check(CLI::PositiveNumber);
    command->add_option("--payload", options->wishes.payload, "Least payload of the arm [kg]")
        ->check(CLI::PositiveNumber);
    command->add_option("--at", options->at, "Ask these servers: opc.tcp://host:port");
    command->add_option("--discovery", options->discovery,
                        "Ask these discovery servers who there is. Without this and --at: the "
                        "one of this machine, opc.tcp://127.0.0.1:4840, and mDNS");
    command->add_flag("--json", options->json, "Print JSON");
    command->callback([options, &exit] { exit = runFind(*options); });
}

}  // namespace metier::app
