#include <fmt/chrono.h>
#include <fmt/format.h>

#include <atomic>
#include <memory>
#include <nlohmann/json.hpp>

#include "metier/client/skill_handle.hpp"
#include "metier/link/stop_signal.hpp"
#include "metier/link/wake_event.hpp"
#include "servers.hpp"

namespace metier::app {
namespace {

using client::SkillHandle;
using skill::TransitionEvent;

struct WatchOptions {
    std::string url;
    std::string skill;
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

std::string jsonOf(const std::string& skill, const TransitionEvent& event) {
    return nlohmann::json{{"time", timeOf(event.time)},      {"skill", skill},
                          {"from", toString(event.from)},    {"to", toString(event.to)},
                          {"execution", event.execution_id}, {"reason", toString(event.reason)},
                          {"text", event.reason_text}}
        .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string jsonOf(const opcua::ConnectionChange& change) {
    using Kind = opcua::ConnectionChange::Kind;
    const bool back = change.kind == Kind::back;
    nlohmann::json line{{"time", timeOf(change.time)},
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
/// add() on the client's thread.
class Printer {
public:
    explicit Printer(const WatchOptions& options) : options_(options), left_(options.count) {}

    void add(const std::string& skill, const TransitionEvent& event) {
        if (options_.count > 0 && left_ <= 0) {
            return;
        }
        print(options_.json ? jsonOf(skill, event) : lineOf(skill, event));
        if (--left_ == 0 && options_.count > 0) {
            done_ = true;
            news_.ring();
        }
    }
    void add(const opcua::ConnectionChange& change) {
        print(options_.json ? jsonOf(change)
                            : fmt::format("{} {}", timeOf(change.time), textOf(change)));
        given_up_ = change.kind == opcua::ConnectionChange::Kind::given_up;
        if (given_up_ || change.server_restarted) {
            restarted_ = change.server_restarted;
            news_.ring();
        }
    }

    /// Waits until enough was printed, a signal came, or the connection was given up, which is a
    /// failure. `look_again` is called after each restart of the server.
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
    int left_;
    std::atomic<bool> done_ = false;
    std::atomic<bool> given_up_ = false;
    std::atomic<bool> restarted_ = false;
    link::WakeEvent news_;
};

/// Opens what is to be watched. Errors: those of the server; not_found.
Result<std::vector<SkillHandle>> openAll(opcua::Client& client, const WatchOptions& options,
                                         Printer& printer) {
    METIER_ASSIGN(const auto skills, client::findSkills(client));
    std::vector<SkillHandle> handles;
    for (const auto& address : skills) {
        if (!options.skill.empty() && address.name != options.skill) {
            continue;
        }
        METIER_ASSIGN(auto handle, SkillHandle::open(client, address));
        handle.onTransition([&printer, name = address.name](const TransitionEvent& event) {
            printer.add(name, event);
        });
        handles.push_back(std::move(handle));
    }
    if (handles.empty()) {
        return fail(Errc::not_found, fmt::format("{}: no skill '{}'", options.url, options.skill));
    }
    return handles;
}

void lookAgain(std::vector<SkillHandle>& handles) {
    for (auto& handle : handles) {
        if (const auto found = handle.refresh(); !found) {
            report(found.error());
        }
    }
}

Result<Exit> runWatch(const WatchOptions& options, const CommandIdentity& identity) {
    const link::StopSignal signal;
    Printer printer(options);
    METIER_ASSIGN(const auto client, connectTo(identity, options.url, OnLoss::reconnect));
    client->onConnectionChange(
        [&printer](const opcua::ConnectionChange& change) { printer.add(change); });
    METIER_ASSIGN(auto handles, openAll(*client, options, printer));
    fmt::print(stderr, "watching {} skills; Ctrl-C ends it\n", handles.size());
    return printer.wait(signal, [&handles] { lookAgain(handles); });
}

}  // namespace

void addWatch(CLI::App& app, CommandContext& context) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto options = std::make_shared<WatchOptions>();
    auto* command = app.add_subcommand(
        "watch",
        "Print every transition of a server's skills, and each loss and return of the connection");
    command->add_option("url", options->url, "Address of the server: opc.tcp://host:port")
        ->required();
    command->add_option("skill", options->skill, "Only of the skill of this name");
    command->add_option("--count", options->count, "End after so many transitions; 0: at Ctrl-C")
        ->check(CLI::NonNegativeNumber);
    command->add_flag("--json", options->json, "Print one JSON object per line");
    command->callback(
        [options, &context] { context.exit = exitOf(runWatch(*options, context.identity)); });
}

}  // namespace metier::app
