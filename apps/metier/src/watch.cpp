#include <fmt/chrono.h>
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "metier/skill_client/skill_handle.hpp"
#include "servers.hpp"
#include "stop_signal.hpp"
#include "wake_event.hpp"

namespace metier::app {
namespace {

using skill::TransitionEvent;
using skill_client::SkillHandle;

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
        .dump();
}

/// Prints transitions until it has printed enough of them. add() on the client's thread.
class Printer {
public:
    explicit Printer(const WatchOptions& options) : options_(options), left_(options.count) {}

    void add(const std::string& skill, const TransitionEvent& event) {
        if (options_.count > 0 && left_ <= 0) {
            return;
        }
        fmt::print("{}\n", options_.json ? jsonOf(skill, event) : lineOf(skill, event));
        std::fflush(stdout);
        if (--left_ == 0 && options_.count > 0) {
            enough_.ring();
        }
    }

    /// Until enough was printed or a signal came.
    void wait(const StopSignal& signal) { enough_.wait(signal); }

private:
    const WatchOptions& options_;
    int left_;
    WakeEvent enough_;
};

Exit runWatch(const WatchOptions& options) {
    const StopSignal signal;
    auto client = connectTo(options.url);
    if (!client) {
        return report(client.error());
    }
    const auto skills = skill_client::findSkills(**client);
    if (!skills) {
        return report(skills.error());
    }
    Printer printer(options);
    std::vector<SkillHandle> handles;
    for (const auto& address : *skills) {
        if (!options.skill.empty() && address.name != options.skill) {
            continue;
        }
        auto handle = SkillHandle::open(**client, address);
        if (!handle) {
            return report(handle.error());
        }
        handle->onTransition([&printer, name = address.name](const TransitionEvent& event) {
            printer.add(name, event);
        });
        handles.push_back(std::move(*handle));
    }
    if (handles.empty()) {
        return report(
            {Errc::not_found, fmt::format("{}: no skill '{}'", options.url, options.skill)});
    }
    fmt::print(stderr, "watching {} skills; Ctrl-C ends it\n", handles.size());
    printer.wait(signal);
    handles.clear();
    return Exit::success;
}

}  // namespace

void addWatch(CLI::App& app, Exit& exit) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto options = std::make_shared<WatchOptions>();
    auto* command = app.add_subcommand("watch", "Print every transition of a server's skills");
    command->add_option("url", options->url, "Address of the server: opc.tcp://host:port")
        ->required();
    command->add_option("skill", options->skill, "Only of the skill of this name");
    command->add_option("--count", options->count, "End after so many transitions; 0: at Ctrl-C")
        ->check(CLI::NonNegativeNumber);
    command->add_flag("--json", options->json, "Print one JSON object per line");
    command->callback([options, &exit] { exit = runWatch(*options); });
}

}  // namespace metier::app
