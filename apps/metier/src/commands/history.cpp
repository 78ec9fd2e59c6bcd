// Records of servers: a list of executions, and all details of one.
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "command_context.hpp"
#include "metier/link/stop_signal.hpp"
#include "metier/records/json.hpp"
#include "metier/records/kept_store.hpp"
#include "metier/records/trace.hpp"
#include "printable.hpp"
#include "recorded.hpp"
#include "time_text.hpp"

namespace metier::app {
namespace {

using records::ExecutionRow;
using records::Store;

constexpr auto kFollowEvery = std::chrono::milliseconds(250);
constexpr auto kRetry = std::chrono::seconds(1);

struct HistoryOptions {
    std::string records;
    records::Filter filter;
    records::Page page{.before = 0, .count = 20};
    std::string since;
    std::string until;
    std::string id;
    std::string file;
    bool follow = false;
    bool json = false;
};

Result<std::optional<UtcTime>> timeOf(const std::string& text) {
    if (text.empty()) {
        return std::optional<UtcTime>();
    }
    METIER_ASSIGN(const auto time, parseTime(text, std::chrono::system_clock::now()));
    return std::optional(time);
}

Result<records::Filter> filterOf(const HistoryOptions& options) {
    auto filter = options.filter;
    METIER_ASSIGN(filter.from, timeOf(options.since));
    METIER_ASSIGN(filter.until, timeOf(options.until));
    return filter;
}

std::string durationOf(const ExecutionRow& e) {
    return e.isOver()
               ? fmt::format("{:.3f} s", std::chrono::duration<double>(e.ended - e.started).count())
               : "-";
}

/// "Halted (Error): axis 2: ..."
std::string outcomeOf(const ExecutionRow& e) {
    auto text = e.state;
    if (!e.reason.empty()) {
        text += fmt::format(" ({})", e.reason);
    }
    return e.reason_text.empty() ? text : text + ": " + e.reason_text;
}

std::string serverOf(const ExecutionRow& e) {
    return e.server_name.empty() ? e.server : e.server_name;
}

/// A line of the list.
void printLine(const ExecutionRow& e, const HistoryOptions& options) {
    if (options.json) {
        fmt::print("{}\n", printable(records::toJson(e)));
        return;
    }
    const auto line = fmt::format("{:>8}  {}  {:>11}  {:<14} {:<26} {:<10} {}", e.number,
                                  records::timeText(e.started), durationOf(e), serverOf(e), e.skill,
                                  e.user.empty() ? "-" : e.user, outcomeOf(e));
    fmt::print("{}\n", printable(line));
}

void printHeading(const HistoryOptions& options) {
    if (!options.json) {
        fmt::print("{:>8}  {:<24}  {:>11}  {:<14} {:<26} {:<10} {}\n", "number", "started (UTC)",
                   "duration", "server", "skill", "user", "state");
    }
}

Result<Exit> runList(const HistoryOptions& options) {
    METIER_ASSIGN(const auto filter, filterOf(options));
    METIER_ASSIGN(const auto store, Store::open(options.records));
    METIER_ASSIGN(const auto listing, store->list(filter, options.page));
    printHeading(options);
    for (const auto& execution : listing.executions) {
        printLine(execution, options);
    }
    if (listing.more) {
        fmt::print(stderr, "more: --before {}\n", listing.executions.back().number);
    }
    return Exit::success;
}

/// Prints executions that come or change, also after the store was away for a while.
class Follower {
public:
    Follower(const HistoryOptions& options, records::Filter filter)
        : options_(options), filter_(std::move(filter)), store_(options.records) {}

    /// One look.
    Result<void> look() {
        return store_.use([this](Store& store) {
            auto done = revision_ < 0 ? printLast(store) : printChanges(store);
            std::fflush(stdout);
            return done;
        });
    }

private:
    Result<void> printChanges(Store& store) {
        METIER_ASSIGN(const auto changes, store.changes(revision_, filter_));
        revision_ = changes.revision;
        for (const auto& execution : changes.executions) {
            printLine(execution, options_);
        }
        return {};
    }
    /// The last ones, oldest first, to begin with.
    Result<void> printLast(Store& store) {
        METIER_ASSIGN(const auto revision, store.latestRevision());
        METIER_ASSIGN(auto last, store.list(filter_, options_.page));
        std::reverse(last.executions.begin(), last.executions.end());
        for (const auto& execution : last.executions) {
            printLine(execution, options_);
        }
        revision_ = revision;
        return {};
    }

    const HistoryOptions& options_;
    const records::Filter filter_;
    records::KeptStore store_;
    std::int64_t revision_ = -1;
};

/// Whether the reader of the output has closed it: without output nothing else would show that.
bool isOutputClosed() {
    pollfd output{STDOUT_FILENO, 0, 0};
    return poll(&output, 1, 0) > 0 && (output.revents & POLLERR) != 0;
}

Result<Exit> runFollow(const HistoryOptions& options) {
    const link::StopSignal signal;
    METIER_ASSIGN(auto filter, filterOf(options));
    printHeading(options);
    Follower follower(options, std::move(filter));
    std::string told;
    do {
        const auto looked = follower.look();
        const auto problem = looked ? std::string() : looked.error().message;
        // A file that no server has written yet may still appear.
        if (!looked && looked.error().code != Errc::not_found &&
            looked.error().code != Errc::resource_unavailable &&
            looked.error().code != Errc::timeout && looked.error().code != Errc::connection_lost) {
            return fail(looked.error());
        }
        if (problem != std::exchange(told, problem) && !problem.empty()) {
            fmt::print(stderr, "metier: {}; waiting\n", printable(problem));
        }
    } while (!isOutputClosed() && !signal.waitUntil(std::chrono::steady_clock::now() +
                                                    (told.empty() ? kFollowEvery : kRetry)));
    return Exit::success;
}

void printField(const char* name, const std::string& value) {
    if (!value.empty()) {
        fmt::print("  {:<14} {}\n", name, printable(value));
    }
}

void printTransitions(const records::Details& details) {
    for (const auto& t : details.transitions) {
        const std::chrono::duration<double> time(t.time - details.execution.started);
        auto line = fmt::format("{:>10.3f} s  {} to {}", time.count(), t.from, t.to);
        for (const auto* more : {&t.sub_state, &t.step, &t.reason, &t.reason_text}) {
            line += more->empty() ? "" : ", " + *more;
        }
        fmt::print("  {}\n", printable(line));
    }
}

void printDetails(const records::Details& details) {
    const auto& e = details.execution;
    fmt::print("execution {} ({})\n", e.number, printable(e.id));
    printField("skill", e.controller.empty() ? e.skill : e.controller + "/" + e.skill);
    printField("server", fmt::format("{} ({})", serverOf(e), e.server));
    printField("device", e.device);
    printField("started", records::timeText(e.started));
    printField("ended", e.isOver() ? records::timeText(e.ended) : "under way");
    printField("duration", durationOf(e));
    printField("state", outcomeOf(e));
    printField("user", e.user);
    printField("client", e.client_name);
    printField("session", e.session);
    printField("certificate", e.thumbprint);
    printField("parent", e.parent);
    printField("parent server", e.parent_server);
    printField("parameters", e.parameters);
    printField("check", e.check);
    printField("result", e.result);
    printField("missed cycles", std::to_string(e.missed_cycles));
    printField("path", fmt::format("{} samples", details.path.size()));
    printField("intermediate", fmt::format("{} results", details.intermediates.size()));
    fmt::print("transitions, after the start:\n");
    printTransitions(details);
    fmt::print("{}", details.children.empty() ? "" : "started:\n");
    for (const auto& child : details.children) {
        printLine(child, {});
    }
}

Result<Exit> runShow(const HistoryOptions& options) {
    METIER_ASSIGN(const auto store, Store::open(options.records));
    METIER_ASSIGN(const auto execution, store->find(options.id));
    METIER_ASSIGN(const auto details, records::detailsOf(*store, execution.number));
    if (options.json) {
        fmt::print("{}\n", printable(records::toJson(details)));
    } else {
        printDetails(details);
    }
    return Exit::success;
}

Result<Exit> runExport(const HistoryOptions& options) {
    METIER_ASSIGN(const auto store, Store::open(options.records));
    METIER_ASSIGN(const auto count, store->exportTo(options.file));
    fmt::print("{} executions are in {}\n", count, printable(options.file));
    return Exit::success;
}

void addFilter(CLI::App& command, HistoryOptions& options) {
    auto& filter = options.filter;
    command.add_option("--server", filter.server, "Of this server: name or ApplicationUri");
    command.add_option("--skill", filter.skill, "Of this skill");
    command.add_option("--state", filter.state, "In this state: Running, Ready, Halted, Lost");
    command.add_option("--reason", filter.reason, "For this reason, as Finished or ByClient");
    command.add_option("--user", filter.user, "Started by this user");
    command.add_option("--parent", filter.parent, "Started by the execution of this id");
    command.add_option("--text", filter.text, "With this text in its names or its reason");
    command.add_option("--since", options.since,
                       "Started since: 2026-11-22T09:30 (UTC), or 30m, 8h, 7d ago");
    command.add_option("--until", options.until, "Started before, in the same form");
    command
        .add_option("--before", options.page.before,
                    "The next page: what comes after the execution of this number")
        ->check(CLI::NonNegativeNumber);
    within(command.add_option("--count", options.page.count, "How many"), 1, 10'000);
}

Result<Exit> runTrace(const HistoryOptions& options) {
    METIER_ASSIGN(const auto store, Store::open(options.records));
    METIER_ASSIGN(const auto execution, store->find(options.id));
    METIER_ASSIGN(const auto trace, records::chromeTrace(*store, execution.number));
    fmt::print("{}\n", printable(trace));
    return Exit::success;
}

}  // namespace

void addHistory(CLI::App& app, CommandContext& context) {
    // Shared by CLI11, which fills it, and the callbacks, which read it.
    auto options = std::make_shared<HistoryOptions>();
    auto* command =
        app.add_subcommand("history", "Executions that servers have recorded, newest first");
    addRecords(*command, options->records);
    addFilter(*command, *options);
    command->add_flag("--follow", options->follow,
                      "Print the last ones, oldest first, then each that begins, changes its state "
                      "or ends, until Ctrl-C");
    command->add_flag("--json", options->json, "Print one JSON object per line");
    auto* show = command->add_subcommand("show", "All that is known of one execution");
    show->add_option("ID", options->id, "Its number or its id")->required();
    auto* copy = command->add_subcommand(
        "export", "Write a copy of all records into a new SQLite file, also while servers record");
    copy->add_option("FILE", options->file, "The new file")->required();
    command->callback([options, show, copy, &context] {
        context.exit = exitOf(show->parsed()    ? runShow(*options)
                              : copy->parsed()  ? runExport(*options)
                              : options->follow ? runFollow(*options)
                                                : runList(*options));
    });
}

void addTrace(CLI::App& app, CommandContext& context) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto options = std::make_shared<HistoryOptions>();
    auto* command = app.add_subcommand(
        "trace",
        "Print a recorded execution and all that it started as Chrome trace JSON, for "
        "chrome://tracing or ui.perfetto.dev");
    command->add_option("ID", options->id, "Its number or its id")->required();
    addRecords(*command, options->records);
    command->callback([options, &context] { context.exit = exitOf(runTrace(*options)); });
}

}  // namespace metier::app
