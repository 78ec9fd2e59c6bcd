#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "command_context.hpp"
#include "metier/composition/definition_file.hpp"
#include "metier/opcua/search.hpp"
#include "metier/opcua/text.hpp"
#include "metier/server/candidate.hpp"
#include "metier/server/property_wish.hpp"
#include "metier/server/skill_survey.hpp"
#include "printable.hpp"
#include "server_search.hpp"

namespace metier::app {
namespace {

struct FindOptions {
    std::string task;         // a type, a term, or a composition file
    composition::Use role{};  // that candidates are for, of a composition file
    server::ArmFigures wishes;
    std::vector<std::string> properties;
    std::vector<server::PropertyWish> property_wishes;
    std::vector<std::string> at;
    std::vector<std::string> discovery;
    bool json = false;
};

opcua::Sighting searchFor(const FindOptions& options) {
    const bool only_named = options.discovery.empty() && !options.at.empty();
    auto sighting = only_named ? opcua::Sighting{} : app::searchFor(options.discovery);
    std::vector<opcua::FoundServer> given;
    for (const auto& url : options.at) {
        given.push_back({url, "", "command line"});
    }
    opcua::merge(sighting.servers, std::move(given));
    return sighting;
}

std::string nameOf(const server::SurveyedSkill& skill) {
    const auto controller = skill.address.controllerName();
    return controller.empty() ? skill.address.name : controller + "/" + skill.address.name;
}

/// Why a skill is a candidate, and how it is as to each wish.
std::vector<std::string> reasonsOf(const server::SurveyedSkill& skill,
                                   const std::optional<std::string>& term,
                                   const server::Verdict& verdict) {
    std::vector<std::string> reasons;
    if (term) {
        reasons.push_back(fmt::format("term {}", *term));
    }
    reasons.push_back(fmt::format("type {}", fmt::join(skill.types, " < ")));
    reasons.insert(reasons.end(), verdict.reasons.begin(), verdict.reasons.end());
    if (!skill.lacks.empty()) {
        reasons.push_back(textOf(skill.lacks));
    }
    return reasons;
}

/// Terms of the skills of a server, each once.
std::vector<std::string> termsOf(const std::vector<server::SurveyedSkill>& skills) {
    std::set<std::string> terms;
    for (const auto& skill : skills) {
        terms.insert(skill.terms.begin(), skill.terms.end());
    }
    return {terms.begin(), terms.end()};
}

nlohmann::json orNull(const std::optional<double>& number) {
    return number ? nlohmann::json(*number) : nlohmann::json();
}

/// Adds to a verdict whether the skill is of the server and controller that a role asks for.
void judgePlace(const composition::Use& role, const opcua::FoundServer& server,
                const client::SkillAddress& skill, server::Verdict& verdict) {
    const auto want = [&](const std::string& what, const std::string& wanted, bool fits) {
        if (!wanted.empty()) {
            verdict.fits = verdict.fits && fits;
            verdict.reasons.push_back(fmt::format("{} {}{}", what, fits ? "" : "not ", wanted));
        }
    };
    want("server", role.server, role.server == server.name || role.server == server.url);
    want("controller", role.controller, role.controller == skill.controllerName());
}

/// Prints what was found; counts what fits.
class Findings {
public:
    Findings(const FindOptions& options, const std::vector<server::SurveyedServer>& servers)
        : options_(options), servers_(servers) {}

    int fitting() const noexcept { return fitting_; }
    const nlohmann::json& candidates() const noexcept { return candidates_; }

    void addServers() {
        for (std::size_t server = 0; server < servers_.size(); ++server) {
            if (servers_[server].skills) {
                addAnswer(server);
            } else {
                addSilent(servers_[server].server, servers_[server].skills.error().message);
            }
        }
    }
    /// Candidates alone.
    void addCandidates() {
        for (std::size_t server = 0; server < servers_.size(); ++server) {
            if (servers_[server].skills) {
                static_cast<void>(addCandidatesOf(server));
            }
        }
    }
    void addProblem(const Error& error) {
        problems_.push_back(error.message);
        fmt::print(stderr, "metier: {}\n", printable(error.message));
    }

    Exit finish() const {
        if (options_.json) {
            const nlohmann::json all{{"candidates", candidates_},
                                     {"others", others_},
                                     {"silent", silent_},
                                     {"problems", problems_}};
            fmt::print("{}\n", all.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
        } else if (fitting_ == 0) {
            fmt::print("nothing fits\n");
        }
        return fitting_ == 0 ? Exit::failed : Exit::success;
    }

private:
    void say(const opcua::FoundServer& server, const std::string& text) const {
        if (!options_.json) {
            fmt::print("{:<28} {:<12} {}\n", server.url, server.name, opcua::sanitise(text));
        }
    }

    void addSilent(const opcua::FoundServer& server, const std::string& error) {
        silent_.push_back({{"url", server.url}, {"name", server.name}, {"error", error}});
        say(server, fmt::format("does not answer: {}", error));
    }

    void addAnswer(std::size_t server) {
        if (!addCandidatesOf(server)) {
            addOther(servers_[server].server, termsOf(*servers_[server].skills));
        }
    }

    /// \return whether there is any
    bool addCandidatesOf(std::size_t server) {
        const auto& skills = *servers_[server].skills;
        bool any = false;
        for (std::size_t skill = 0; skill < skills.size(); ++skill) {
            auto term = server::termOf(skills[skill], options_.task);
            if (term || server::isA(skills[skill], options_.task)) {
                addCandidate(server, skill, term);
                any = true;
            }
        }
        return any;
    }

    void addOther(const opcua::FoundServer& server, const std::vector<std::string>& terms) {
        others_.push_back({{"url", server.url}, {"name", server.name}, {"terms", terms}});
        say(server,
            fmt::format("does not fit: no {}, its terms: {}", options_.task,
                        terms.empty() ? "none" : fmt::format("{}", fmt::join(terms, ", "))));
    }

    void addCandidate(std::size_t index, std::size_t skill_index,
                      const std::optional<std::string>& term) {
        const auto& server = servers_[index].server;
        const auto& skill = (*servers_[index].skills)[skill_index];
        const auto figures = server::figuresOf(servers_, index, skill_index);
        auto verdict = server::judge(options_.wishes, figures);
        auto of_properties = server::judgeProperties(options_.property_wishes, skill);
        verdict.fits = verdict.fits && of_properties.fits;
        verdict.reasons.insert(verdict.reasons.end(), of_properties.reasons.begin(),
                               of_properties.reasons.end());
        judgePlace(options_.role, server, skill.address, verdict);
        const auto reasons = reasonsOf(skill, term, verdict);
        fitting_ += verdict.fits ? 1 : 0;
        say(server, fmt::format("{} {}: {}", nameOf(skill), verdict.fits ? "fits" : "does not fit",
                                fmt::join(reasons, ", ")));
        candidates_.push_back({{"url", server.url},
                               {"server", server.name},
                               {"told_by", server.reported_by},
                               {"controller", skill.address.controllerName()},
                               {"skill", skill.address.name},
                               {"types", skill.types},
                               {"terms", skill.terms},
                               {"term", term ? nlohmann::json(*term) : nlohmann::json()},
                               {"reach", orNull(figures.reach.value)},
                               {"reach_note", figures.reach.note},
                               {"payload", orNull(figures.payload.value)},
                               {"payload_note", figures.payload.note},
                               {"fits", verdict.fits},
                               {"reasons", reasons}});
    }

    const FindOptions& options_;
    const std::vector<server::SurveyedServer>& servers_;
    int fitting_ = 0;
    nlohmann::json candidates_ = nlohmann::json::array();
    nlohmann::json others_ = nlohmann::json::array();
    nlohmann::json silent_ = nlohmann::json::array();
    nlohmann::json problems_ = nlohmann::json::array();
};

bool isFile(const std::string& task) {
    return std::filesystem::path(task).extension() == ".toml";
}

/// A step of a composition that runs a used skill.
struct CallStep {
    std::string path;  ///< names of the step and of those around it: "take/grasp"
    std::string use;
};

/// The steps that run used skills, in the order of the file.
void addCalls(const composition::Step& step, const std::string& around,
              std::vector<CallStep>& calls) {
    const bool named = !around.empty() && !step.name.empty();
    const auto path = named ? around + "/" + step.name : around + step.name;
    if (step.kind == composition::StepKind::call) {
        calls.push_back({step.name.empty() ? step.key : path, step.use});
    }
    for (const auto* inner : {&step.steps, &step.otherwise}) {
        for (const auto& one : *inner) {
            addCalls(one, path, calls);
        }
    }
}

std::string placeOf(const nlohmann::json& candidate) {
    const auto controller = candidate.at("controller").get<std::string>();
    return fmt::format("{}{}{} ({})", controller, controller.empty() ? "" : "/",
                       candidate.at("skill").get<std::string>(),
                       candidate.at("url").get<std::string>());
}

/// Steps of a composition, each with all who could do it.
class Plan {
public:
    /// \param fitting candidates that fit, by the alias of the use
    Plan(const composition::Definition& definition,
         std::map<std::string, std::vector<nlohmann::json>> fitting)
        : fitting_(std::move(fitting)) {
        addCalls(definition.root, "", calls_);
        for (const auto& use : definition.uses) {
            nobody_[use.alias] = use.optional ? "nobody: it is left out" : "nobody";
        }
    }

    nlohmann::json json() const {
        auto steps = nlohmann::json::array();
        for (const auto& [path, use] : calls_) {
            auto by = nlohmann::json::array();
            for (const auto& candidate : fitting_.at(use)) {
                by.push_back({{"url", candidate.at("url")},
                              {"server", candidate.at("server")},
                              {"controller", candidate.at("controller")},
                              {"skill", candidate.at("skill")}});
            }
            steps.push_back({{"step", path}, {"role", use}, {"by", by}});
        }
        return steps;
    }
    void print() const {
        fmt::print("steps:\n");
        for (const auto& [path, use] : calls_) {
            std::vector<std::string> by;
            for (const auto& candidate : fitting_.at(use)) {
                by.push_back(placeOf(candidate));
            }
            fmt::print(
                "{:<28} {:<12} {}\n", path, use,
                by.empty() ? nobody_.at(use) : printable(fmt::format("{}", fmt::join(by, " or "))));
        }
    }

private:
    std::vector<CallStep> calls_;
    std::map<std::string, std::vector<nlohmann::json>> fitting_;  // by the alias of the use
    std::map<std::string, std::string> nobody_;                   // text of a use that nothing fits
};

std::vector<nlohmann::json> fittingOf(const nlohmann::json& candidates) {
    std::vector<nlohmann::json> fitting;
    std::copy_if(candidates.begin(), candidates.end(), std::back_inserter(fitting),
                 [](const auto& candidate) { return candidate.at("fits").template get<bool>(); });
    return fitting;
}

/// The skills that could take the roles of a composition file, and its steps.
Result<Exit> findRoles(const FindOptions& options, const composition::Definition& definition,
                       const std::vector<server::SurveyedServer>& servers) {
    bool all = true;
    auto roles = nlohmann::json::array();
    std::map<std::string, std::vector<nlohmann::json>> fitting;
    for (const auto& use : definition.uses) {
        auto asked = options;
        asked.task = use.type;
        asked.wishes = {use.reach ? use.reach : options.wishes.reach,
                        use.payload ? use.payload : options.wishes.payload};
        asked.role = use;
        if (!options.json) {
            fmt::print("{}: {}\n", use.alias, use.type);
        }
        Findings found(asked, servers);
        found.addCandidates();
        all = all && (use.optional || found.fitting() > 0);
        if (!options.json && found.fitting() == 0) {
            fmt::print("nothing fits{}\n", use.optional ? "; its steps are left out" : "");
        }
        fitting[use.alias] = fittingOf(found.candidates());
        roles.push_back({{"role", use.alias},
                         {"type", use.type},
                         {"optional", use.optional},
                         {"candidates", found.candidates()}});
    }
    const Plan plan(definition, std::move(fitting));
    if (options.json) {
        const nlohmann::json answer{{"skill", definition.name},
                                    {"possible", all},
                                    {"roles", roles},
                                    {"steps", plan.json()}};
        fmt::print("{}\n", answer.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    } else {
        plan.print();
    }
    return all ? Exit::success : Exit::failed;
}

Result<Exit> runFind(FindOptions& options, const CommandIdentity& identity) {
    for (const auto& property : options.properties) {
        METIER_ASSIGN(auto wish, asUsage(server::parsePropertyWish(property)));
        options.property_wishes.push_back(std::move(wish));
    }
    std::optional<composition::Definition> definition;
    if (isFile(options.task)) {
        METIER_ASSIGN(definition, asUsage(composition::loadDefinition(options.task)));
    }
    const auto sighting = searchFor(options);
    const auto servers = server::survey(sighting.servers, identity);
    if (definition) {
        for (const auto& problem : sighting.problems) {
            fmt::print(stderr, "metier: {}\n", printable(problem.message));
        }
        return findRoles(options, *definition, servers);
    }
    Findings findings(options, servers);
    for (const auto& problem : sighting.problems) {
        findings.addProblem(problem);
    }
    findings.addServers();
    return findings.finish();
}

}  // namespace

void addFind(CLI::App& app, CommandContext& context) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto options = std::make_shared<FindOptions>();
    auto* command = app.add_subcommand(
        "find", "Find skills for a task over the network, and say what fits and why");
    command
        ->add_option("task", options->task,
                     "What the skill is for, by a dictionary entry, such as pick-and-place, or its "
                     "type, such as JointPtpMoveSkillType or, for all moves, MoveSkillType; or a "
                     "composition file, FILE.toml: what fits each skill that it uses")
        ->required();
    command->add_option("--reach", options->wishes.reach, "Least reach of the arm [m]")
        ->check(CLI::PositiveNumber);
    command->add_option("--payload", options->wishes.payload, "Least payload of the arm [kg]")
        ->check(CLI::PositiveNumber);
    command->add_option("--property", options->properties,
                        "Property of the skill's type: NAME, NAME=VALUE, NAME>=NUMBER or "
                        "NAME<=NUMBER, in the property's own unit");
    command->add_option("--at", options->at, "Ask these servers: opc.tcp://host:port");
    command->add_option("--discovery", options->discovery,
                        "Ask these discovery servers who there is. Without this and --at: the "
                        "one of this machine, opc.tcp://127.0.0.1:4840, and mDNS");
    command->add_flag("--json", options->json, "Print JSON");
    command->callback(
        [options, &context] { context.exit = exitOf(runFind(*options, context.identity)); });
}

}  // namespace metier::app
