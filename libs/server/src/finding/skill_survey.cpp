#include "metier/server/skill_survey.hpp"

#include <algorithm>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "finding/arm_figures.hpp"
#include "metier/base/text.hpp"
#include "metier/opcua/text.hpp"

namespace metier::server {
namespace {

constexpr std::size_t kAtOnce = 32;

opcua::ClientOptions optionsFor(std::chrono::milliseconds limit) {
    opcua::ClientOptions options;
    options.application_name = "metier survey";
    options.connect_timeout = limit;
    options.call_timeout = limit;
    return options;
}

/// A value that a property of a type may have; nothing for others.
std::optional<std::variant<bool, double, std::string>> factIn(const opcua::Value& value) {
    if (const auto truth = value.as<bool>()) {
        return *truth;
    }
    if (const auto number = value.as<double>()) {
        return *number;
    }
    if (const auto text = value.as<std::string>()) {
        return opcua::sanitise(*text);
    }
    return std::nullopt;
}

/// Symbol of the unit of a Variable; empty if it has none.
opcua::Answer<std::string> unitOf(opcua::Client& client, const opcua::NodeId& variable) {
    const auto found = client.translate(variable, {{0, "EngineeringUnits"}});
    if (!found) {
        return std::string();
    }
    METIER_ASSIGN(const auto read, client.read(*found));
    const auto unit = read.as<opcua::EuInformation>();
    return unit ? opcua::sanitise(unit->display_name.text) : std::string();
}

/// Adds the Variables right below a type that have a plain value.
opcua::Answer<> addFacts(opcua::Client& client, const opcua::NodeId& type,
                         std::vector<TypeFact>& facts) {
    METIER_ASSIGN(const auto children,
                  client.browse({.node = type, .node_classes = {opcua::NodeClass::variable}}));
    for (const auto& child : children) {
        const auto& name = child.browse_name.name;
        const bool known = std::any_of(facts.begin(), facts.end(),
                                       [&](const TypeFact& fact) { return fact.name == name; });
        const auto read =
            known ? opcua::Answer<opcua::Value>(opcua::Value()) : client.read(child.target);
        // What has no value at the type is no fact of the type.
        const auto value = read ? factIn(*read) : std::nullopt;
        if (value) {
            METIER_ASSIGN(auto unit, unitOf(client, child.target));
            facts.push_back({opcua::sanitise(name), *value, std::move(unit)});
        }
    }
    return {};
}

/// Questions about the skills of one server; about types and arms once each.
class Questions {
public:
    Questions(opcua::Client& client, const client::ReferenceReader& references)
        : client_(client), references_(references) {}

    opcua::Answer<SurveyedSkill> ask(client::SkillAddress address) {
        auto own = references_.read(address.node);
        METIER_ASSIGN(const auto type_terms,
                      own ? typeTermsOf(address) : tl::unexpected(own.error()));
        SurveyedSkill skill{std::move(address), type_terms->types, std::move(own->terms),
                            type_terms->facts, std::move(own->uses)};
        append(skill.terms, type_terms->terms);
        METIER_ASSIGN(skill.lacks, client::readLacks(client_, skill.address));
        if (const auto* controller = skill.address.controller()) {
            const auto [arm, is_new] = arms_.try_emplace(controller->node);
            if (is_new) {
                arm->second = figuresOfArm(client_, skill.address);
            }
            skill.arm = arm->second;
        }
        return skill;
    }

private:
    /// Names and terms of a type and of all that it is derived from.
    struct TypeTerms {
        std::vector<std::string> types;
        std::vector<std::string> terms;
        std::vector<TypeFact> facts;
    };

    static void append(std::vector<std::string>& terms, const std::vector<std::string>& more) {
        std::copy_if(more.begin(), more.end(), std::back_inserter(terms), [&](const auto& term) {
            return std::find(terms.begin(), terms.end(), term) == terms.end();
        });
    }

    opcua::Answer<const TypeTerms*> typeTermsOf(const client::SkillAddress& address) {
        const auto [type_terms, is_new] = type_terms_.try_emplace(address.type);
        if (!is_new) {
            return &type_terms->second;
        }
        METIER_ASSIGN(const auto types, client::typeChain(client_, address));
        bool below_skill_type = std::any_of(
            types.begin(), types.end(), [](const auto& type) { return type.name == "SkillType"; });
        for (const auto& type : types) {
            below_skill_type = below_skill_type && type.name != "SkillType";
            METIER_ASSIGN(const auto references, references_.read(type.node));
            type_terms->second.types.push_back(type.name);
            append(type_terms->second.terms, references.terms);
            if (below_skill_type) {
                METIER_TRY(addFacts(client_, type.node, type_terms->second.facts));
            }
        }
        return &type_terms->second;
    }

    opcua::Client& client_;
    const client::ReferenceReader& references_;
    std::map<opcua::NodeId, TypeTerms> type_terms_;  // key: type
    std::map<opcua::NodeId, ArmFigures> arms_;       // key: controller
};

opcua::Answer<std::vector<SurveyedSkill>> askSkills(opcua::Client& client) {
    auto found = client::findSkills(client);
    METIER_ASSIGN(const auto references, found ? client::ReferenceReader::create(client)
                                               : tl::unexpected(std::move(found.error())));
    Questions questions(client, references);
    std::vector<SurveyedSkill> skills;
    for (auto& address : *found) {
        METIER_ASSIGN(auto skill, questions.ask(std::move(address)));
        skills.push_back(std::move(skill));
    }
    return skills;
}

/// The questions to one server, which another thread may cut short.
class Interview {
public:
    Result<std::vector<SurveyedSkill>> ask(const std::string& url,
                                           const ConnectionSecurity& security,
                                           std::chrono::milliseconds limit) {
        auto options = optionsFor(limit);
        METIER_TRY(security.secure(options, url));
        auto client = opcua::Client::connect(url, options);
        if (!client) {
            return fail(client.error().code, opcua::sanitise(client.error().message));
        }
        security.noteConnected(options, url);
        {
            const std::lock_guard lock(mutex_);
            if (cut_) {
                return late();
            }
            client_ = std::move(*client);
        }
        auto skills = askSkills(*client_);
        const std::lock_guard lock(mutex_);
        if (skills && !cut_) {
            return std::move(*skills);
        }
        return cut_ ? late() : fail(skills.error().code, opcua::sanitise(skills.error().message));
    }

    void cut() {
        opcua::Client* client = nullptr;
        {
            const std::lock_guard lock(mutex_);
            cut_ = true;
            client = client_.get();
        }
        if (client != nullptr) {
            static_cast<void>(client->close());  // waiting calls end
        }
    }

private:
    static tl::unexpected<Error> late() { return fail(Errc::timeout, "it did not answer in time"); }

    std::mutex mutex_;
    bool cut_ = false;
    std::unique_ptr<opcua::Client> client_;
};

/// Servers that are asked at the same time, each by a thread of its own.
class Round {
public:
    Round(std::vector<opcua::FoundServer> servers, const ConnectionSecurity& security,
          std::chrono::milliseconds limit)
        : servers_(std::move(servers)),
          interviews_(servers_.size()),
          answers_(servers_.size()),
          open_(servers_.size()) {
        for (std::size_t i = 0; i < servers_.size(); ++i) {
            threads_.emplace_back([this, i, &security, limit] {
                auto answer = interviews_[i].ask(servers_[i].url, security, limit);
                const std::lock_guard lock(mutex_);
                answers_[i] = std::move(answer);
                --open_;
                ended_.notify_all();
            });
        }
    }

    std::vector<SurveyedServer> take(std::chrono::steady_clock::time_point deadline) {
        await(deadline);
        threads_.clear();  // all end now
        std::vector<SurveyedServer> result;
        for (std::size_t i = 0; i < servers_.size(); ++i) {
            result.push_back({std::move(servers_[i]), std::move(*answers_[i])});
        }
        return result;
    }

private:
    /// At the deadline those that are left are cut short, all at the same time.
    void await(std::chrono::steady_clock::time_point deadline) {
        std::vector<std::jthread> cutters;
        std::unique_lock lock(mutex_);
        ended_.wait_until(lock, deadline, [this] { return open_ == 0; });
        for (std::size_t i = 0; i < servers_.size(); ++i) {
            if (!answers_[i]) {
                cutters.emplace_back([this, i] { interviews_[i].cut(); });
            }
        }
        lock.unlock();
        cutters.clear();
    }

    std::vector<opcua::FoundServer> servers_;
    std::vector<Interview> interviews_;
    std::vector<std::optional<Result<std::vector<SurveyedSkill>>>> answers_;
    std::size_t open_;
    std::mutex mutex_;
    std::condition_variable ended_;
    std::vector<std::jthread> threads_;
};

}  // namespace

std::vector<SurveyedServer> survey(const std::vector<opcua::FoundServer>& servers,
                                   const ConnectionSecurity& security,
                                   std::chrono::milliseconds limit) {
    std::vector<SurveyedServer> result;
    for (std::size_t begin = 0; begin < servers.size(); begin += kAtOnce) {
        const auto first = servers.begin() + static_cast<std::ptrdiff_t>(begin);
        const auto count = std::min(kAtOnce, servers.size() - begin);
        Round round({first, first + static_cast<std::ptrdiff_t>(count)}, security, limit);
        auto answers = round.take(std::chrono::steady_clock::now() + limit);
        std::move(answers.begin(), answers.end(), std::back_inserter(result));
    }
    return result;
}

namespace {

/// Its words without "and", each followed by a "-".
std::string plain(std::string_view text) {
    std::string result;
    std::string word;
    for (const char letter : inLowerCase(text) + " ") {
        if (letter != '-' && letter != '_' && letter != ' ') {
            word += letter;
            continue;
        }
        if (!word.empty() && word != "and") {
            result += word + "-";
        }
        word.clear();
    }
    return result;
}

}  // namespace

std::optional<std::string> termOf(const SurveyedSkill& skill, const std::string& wish) {
    const auto names = [&wish](const std::string& term) {
        const auto end = term.find_last_of(":/#");
        const auto last =
            plain(std::string_view(term).substr(end == std::string::npos ? 0 : end + 1));
        return inLowerCase(term) == inLowerCase(wish) || (!last.empty() && last == plain(wish));
    };
    const auto found = std::find_if(skill.terms.begin(), skill.terms.end(), names);
    return found == skill.terms.end() ? std::nullopt : std::optional(*found);
}

bool isA(const SurveyedSkill& skill, const std::string& type) {
    const auto matches = [&type](const std::string& name) {
        return name == type || name == type + "Type" || name + "Type" == type;
    };
    return std::any_of(skill.types.begin(), skill.types.end(), matches) ||
           matches(skill.address.name) || matches(skill.address.name + "Type");
}

}  // namespace metier::server
