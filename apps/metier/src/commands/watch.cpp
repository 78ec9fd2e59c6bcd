#include <fmt/chrono.h>
#include <fmt/format.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <numeric>
#include <utility>

#include "metier/client/skill_handle.hpp"
#include "metier/link/stop_signal.hpp"
#include "metier/link/wake_event.hpp"
#include "servers.hpp"

namespace metier::app {
namespace {

using client::SkillHandle;
using skill::TransitionEvent;

struct WatchOptions {
    SkillChoice choice;
    int count = 0;
    bool json = false;
};

std::string timeOf(UtcTime time) {
    const auto whole = std::chrono::floor<std::chrono::milliseconds>(time);
    const auto milliseconds = whole.time_since_epoch().count() % 1000;
    return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z",
                       fmt::gmtime(std::chrono::system_clock::to_time_t(whole)), milliseconds);
}

std::string lineOf(const std::string& skill, const TransitionEvent& event) {
    return fmt::format("{} {:<28} {:>9} -> {:<9} {} {}", timeOf(event.time), skill,
                       toString(event.from), toString(event.to), toString(event.reason),
                       event.reason_text);
}

std::string jsonOf(const std::string& url, const std::string& skill, const TransitionEvent& event) {
    return nlohmann::json{{"time", timeOf(event.time)},
                          {"server", url},
                          {"skill", skill},
                          {"from", toString(event.from)},
                          {"to", toString(event.to)},
                          {"execution", event.execution_id},
                          {"reason", toString(event.reason)},
                          {"text", event.reason_text}}
        .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string jsonOf(const std::string& url, const opcua::ConnectionChange& change) {
    using Kind = opcua::ConnectionChange::Kind;
    const bool back = change.kind == Kind::back;
    nlohmann::json line{{"time", timeOf(change.time)},
                        {"server", url},
                        {"connection", back                        ? "back"
                                       : change.kind == Kind::lost ? "lost"
                                                                   : "given up"}};
    if (back) {
        line["server_restarted"] = change.server_restarted;
    } else {
        line["text"] = change.why.message;
    }
    return line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// Prints transitions until it has printed enough of them, and what becomes of the connection.
/// add() on the threads of the clients.
class Printer {
public:
    explicit Printer(const WatchOptions& options) : options_(options), left_(options.count) {}

    void add(const std::string& url, const std::string& skill, const TransitionEvent& event) {
        const std::lock_guard lock(mutex_);
        if (options_.count > 0 && left_ <= 0) {
            return;
        }
        print(options_.json ? jsonOf(url, skill, event) : lineOf(skill, event));
        if (--left_ == 0 && options_.count > 0) {
            done_ = true;
            news_.ring();
        }
    }
    void add(const std::string& url, const opcua::ConnectionChange& change) {
        const std::lock_guard lock(mutex_);
        print(options_.json ? jsonOf(url, change)
                            : fmt::format("{} {}: {}", timeOf(change.time), url, textOf(change)));
        if (change.kind == opcua::ConnectionChange::Kind::given_up) {
            given_up_ = true;
            news_.ring();
        }
        if (change.server_restarted) {
            restarted_ = true;
            news_.ring();
        }
    }

    /// Waits until enough was printed, a signal came, or the connection was given up, which is a
    /// failure. `look_again` is called after each restart of a server.
    Exit wait(const link::StopSignal& signal, const std::function<void()>& look_again) {
        while (!done_ && !given_up_ && !signal.came()) {
            news_.wait(signal);
            if (restarted_.exchange(false)) {
                look_again();
            }
        }
        return given_up_ ? Exit::failed : Exit::success;
    }

private:
    static void print(const std::string& line) {
        fmt::print("{}\n", line);
        std::fflush(stdout);
    }

    const WatchOptions& options_;
    std::mutex mutex_;  // guards left_ and the order of lines
    int left_;
    std::atomic<bool> done_ = false;
    std::atomic<bool> given_up_ = false;
    std::atomic<bool> restarted_ = false;
    link::WakeEvent news_;
};

/// A server whose skills are watched.
struct WatchedServer {
    std::unique_ptr<opcua::Client> client;
    std::vector<SkillHandle> skills{};  // end before their client
};

/// Opens the skills of a server that are to be watched. Errors: those of the server.
Result<WatchedServer> open(const std::string& url, const WatchOptions& options, Printer& printer,
                           const CommandIdentity& identity) {
    METIER_ASSIGN(auto client, connectTo(identity, url, OnLoss::reconnect));
    client->onConnectionChange(
        [&printer, url](const opcua::ConnectionChange& change) { printer.add(url, change); });
    METIER_ASSIGN(const auto addresses, client::findSkills(*client));
    WatchedServer server{std::move(client)};
    for (const auto& address : addresses) {
        if (!options.choice.skill.empty() && address.name != options.choice.skill) {
            continue;
        }
        METIER_ASSIGN(auto handle, SkillHandle::open(*server.client, address));
        handle.onTransition([&printer, url, name = address.name](const TransitionEvent& event) {
            printer.add(url, name, event);
        });
        server.skills.push_back(std::move(handle));
    }
    return server;
}

/// Opens the named server, or all that are found; of those, one that does not answer is reported
/// and left out.
Result<std::vector<WatchedServer>> openAll(const WatchOptions& options, Printer& printer,
                                           const CommandIdentity& identity) {
    std::vector<WatchedServer> watched;
    if (!options.choice.url.empty()) {
        METIER_ASSIGN(auto server, open(options.choice.url, options, printer, identity));
        watched.push_back(std::move(server));
        return watched;
    }
    METIER_ASSIGN(const auto urls, addressesOf(options.choice.servers));
    for (const auto& url : urls) {
        if (auto server = open(url, options, printer, identity)) {
            watched.push_back(std::move(*server));
        } else {
            report(server.error());
        }
    }
    return watched;
}

std::size_t numberOfSkills(const std::vector<WatchedServer>& servers) {
    return std::accumulate(
        servers.begin(), servers.end(), std::size_t{0},
        [](std::size_t sum, const auto& one) { return sum + one.skills.size(); });
}

void lookAgain(std::vector<WatchedServer>& servers) {
    for (auto& server : servers) {
        for (auto& handle : server.skills) {
            if (const auto found = handle.refresh(); !found) {
                report(found.error());
            }
        }
    }
}

Result<Exit> runWatch(const WatchOptions& options, const CommandIdentity& identity) {
    const link::StopSignal signal;
    Printer printer(options);
    METIER_ASSIGN(auto servers, openAll(options, printer, identity));
    const auto skills = numberOfSkills(servers);
    if (skills == 0) {
        return fail(Errc::not_found,
                    fmt::format("{}: no skill '{}'",
                                options.choice.url.empty() ? "these servers" : options.choice.url,
                                options.choice.skill));
    }
    fmt::print(stderr, "watching {} skills; Ctrl-C ends it\n", skills);
    return printer.wait(signal, [&servers] { lookAgain(servers); });
}

}  // namespace

void addWatch(CLI::App& app, CommandContext& context) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto options = std::make_shared<WatchOptions>();
    auto* command = app.add_subcommand("watch",
                                       "Print every transition of the skills of servers, and each "
                                       "loss and return of a connection");
    command->add_option("url", options->choice.url,
                        "Address of the server: opc.tcp://host:port; without it: all servers");
    command->add_option("skill", options->choice.skill, "Only of the skill of this name");
    command->add_option("--cell", options->choice.servers.cell,
                        "Without an address: the servers of this cell file");
    addServerSearch(*command, options->choice.servers);
    command->add_option("--count", options->count, "End after so many transitions; 0: at Ctrl-C")
        ->check(CLI::NonNegativeNumber);
    command->add_flag("--json", options->json, "Print one JSON object per line");
    command->callback([options, &context] {
        sortArguments(options->choice);
        context.exit = exitOf(runWatch(*options, context.identity));
    });
}

}  // namespace metier::app
