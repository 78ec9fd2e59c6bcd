#include "servers.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <future>
#include <optional>
#include <utility>

namespace metier::app {

namespace {

/// Answer of one server to the question for a skill.
struct SkillAnswer {
    std::string url;
    Result<client::SkillAddress> skill;  ///< not_found: it has none; other errors: not known
};

/// Errors: not_found, with the names that it has; others, if it gives no answer, or if several of
/// its controllers have the skill.
Result<client::SkillAddress> skillAt(const std::string& url, const std::string& skill,
                                     const CommandIdentity& identity) {
    const auto client = connectTo(identity, url);
    if (!client) {
        const auto& [code, text] = client.error();
        return fail(code == Errc::not_found ? Errc::connection_lost : code, text);
    }
    return client::findSkill(**client, skill);
}

/// Asks all servers at the same time: one that does not answer delays none.
std::vector<SkillAnswer> askFor(const std::string& skill, const CommandIdentity& identity,
                                const std::vector<opcua::FoundServer>& servers) {
    std::vector<std::future<Result<client::SkillAddress>>> asked;
    for (const auto& server : servers) {
        asked.push_back(std::async(
            std::launch::async, [&, url = server.url] { return skillAt(url, skill, identity); }));
    }
    std::vector<SkillAnswer> answers;
    for (std::size_t i = 0; i < servers.size(); ++i) {
        answers.push_back({servers[i].url, asked[i].get()});
    }
    return answers;
}

/// The only server that has the skill. One that gives no answer may have it, too: nothing is
/// commanded then.
/// Errors: not_found with what each server answered; invalid_argument if several have it; those of
/// a server that gives no answer.
Result<std::string> serverWith(const SkillChoice& choice, const CommandIdentity& identity) {
    METIER_ASSIGN(const auto servers, serversOf(choice.servers));
    std::vector<std::string> with;
    std::string others;
    std::optional<Error> unknown;
    for (const auto& answer : askFor(choice.skill, identity, servers)) {
        if (answer.skill) {
            with.push_back(answer.url);
        } else if (answer.skill.error().code == Errc::not_found) {
            others += fmt::format("; {}", answer.skill.error().message);
        } else {
            unknown = {answer.skill.error().code,
                       fmt::format("{} may have {}, too ({}): name the address of the one that is "
                                   "meant",
                                   answer.url, choice.skill, answer.skill.error().message)};
        }
    }
    if (with.size() > 1) {
        return fail(Errc::invalid_argument,
                    fmt::format("{} servers have {}: name one of {}", with.size(), choice.skill,
                                fmt::join(with, ", ")));
    }
    if (unknown) {
        return fail(*unknown);
    }
    if (with.empty()) {
        return fail(Errc::not_found, fmt::format("no server has {}{}", choice.skill, others));
    }
    return with.front();
}

}  // namespace

SteadyTime deadlineIn(double seconds) {
    return std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::nanoseconds>(
                                                  std::chrono::duration<double>(seconds));
}

Result<std::unique_ptr<opcua::Client>> connectTo(const CommandIdentity& identity,
                                                 const std::string& url, OnLoss on_loss) {
    opcua::ClientOptions options;
    options.application_name = "metier command";
    options.publishing_interval = std::chrono::milliseconds(20);
    if (on_loss == OnLoss::reconnect) {
        options.reconnect.emplace();
    }
    if (const auto secured = identity.secure(options, url); !secured) {
        return fail(secured.error().code, fmt::format("{}: {}", url, secured.error().message));
    }
    auto client = opcua::Client::connect(url, options);
    if (!client) {
        return fail(client.error().code, fmt::format("{}: {}{}", url, client.error().message,
                                                     identity.adviceOn(client.error())));
    }
    identity.noteConnected(options, url);
    return std::move(*client);
}

void showConnection(opcua::Client& client) {
    client.onConnectionChange(
        [](const opcua::ConnectionChange& change) { fmt::print(stderr, "{}\n", textOf(change)); });
}

std::string textOf(const opcua::ConnectionChange& change) {
    using Kind = opcua::ConnectionChange::Kind;
    switch (change.kind) {
        case Kind::lost:
            return fmt::format("connection lost: {}; reconnecting", change.why.message);
        case Kind::back:
            return fmt::format("connection back; server restarted: {}",
                               change.server_restarted ? "yes" : "no");
        case Kind::given_up:
            return fmt::format("connection given up: {}", change.why.message);
    }
    return {};
}

Exit reportOutcome(const opcua::Failure& failure) {
    report(failure);
    if (failure.code == Errc::execution_lost) {
        return Exit::execution_lost;
    }
    return failure.delivery == opcua::Failure::Delivery::unknown ? Exit::unknown : Exit::failed;
}

void sortArguments(SkillChoice& choice) {
    if (choice.skill.empty() && !choice.url.empty() && !isAddress(choice.url)) {
        choice.skill = std::exchange(choice.url, {});
    }
}

void addSkillChoice(CLI::App& command, SkillChoice& choice) {
    command.add_option("url", choice.url,
                       "Address of the server: opc.tcp://host:port; without it: the one that has "
                       "the skill");
    command.add_option("skill", choice.skill,
                       "Name of the skill, or Controller/Name if several have it");
    command.parse_complete_callback([&choice] {
        sortArguments(choice);
        if (choice.skill.empty()) {
            throw CLI::RequiredError("skill");
        }
    });
    command.add_option("--cell", choice.servers.cell,
                       "Without an address: look among the servers of this cell file");
    addServerSearch(command, choice.servers);
}

bool isAddress(const std::string& text) {
    return text.starts_with("opc.tcp://");
}

Result<OpenSkill> openSkill(const CommandIdentity& identity, const SkillChoice& choice,
                            OnLoss on_loss) {
    auto url = choice.url;
    if (url.empty()) {
        METIER_ASSIGN(url, serverWith(choice, identity));
    }
    METIER_ASSIGN(auto client, connectTo(identity, url, on_loss));
    METIER_ASSIGN(auto address, client::findSkill(*client, choice.skill));
    METIER_ASSIGN(auto skill, client::SkillHandle::open(*client, std::move(address)));
    return OpenSkill{std::move(url), std::move(client), std::move(skill)};
}

}  // namespace metier::app
