#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "commands.hpp"
#include "metier/audit/audit_log.hpp"
#include "metier/opcua/text.hpp"

namespace metier::app {
namespace {

namespace fs = std::filesystem;

struct AuditOptions {
    std::vector<std::string> files;
    std::string state;
    std::string since;
    std::string event;
    bool json = false;
};

/// Whether it is a part that verify() of another file comes to.
bool followsAnother(const fs::path& file, const std::vector<fs::path>& files) {
    return std::any_of(files.begin(), files.end(), [&](const fs::path& first) {
        const auto parts = audit::partsOf(first);
        return first != file && std::find(parts.begin(), parts.end(), file) != parts.end();
    });
}

/// The first file of each log below a state folder.
Result<std::vector<fs::path>> logsIn(const fs::path& state) {
    std::vector<fs::path> files;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(state / "audit", error)) {
        if (entry.path().extension() == ".log") {
            files.push_back(entry.path());
        }
    }
    if (error) {
        return fail(Errc::not_found,
                    fmt::format("{}: {}", (state / "audit").string(), error.message()));
    }
    std::sort(files.begin(), files.end());
    const auto all = files;
    std::erase_if(files, [&](const fs::path& file) { return followsAnother(file, all); });
    return files;
}

Result<std::vector<fs::path>> chosenLogs(const AuditOptions& options) {
    if (options.files.empty() == options.state.empty()) {
        return fail(Errc::invalid_argument, "give audit logs, or --state with a folder of them");
    }
    return options.state.empty() ? Result<std::vector<fs::path>>(std::vector<fs::path>(
                                       options.files.begin(), options.files.end()))
                                 : logsIn(options.state);
}

Exit runVerify(const AuditOptions& options) {
    const auto logs = chosenLogs(options);
    if (!logs) {
        return reportUsage(logs.error());
    }
    auto exit = Exit::success;
    for (const auto& log : *logs) {
        const auto verified = audit::verify(log);
        if (!verified) {
            report(verified.error());
            exit = Exit::failed;
            continue;
        }
        fmt::print("{}: {} entries, {} to {}, last chain value {}\n", log.string(),
                   verified->entries, verified->first_time, verified->last_time,
                   verified->last_chain);
        if (verified->first_number == 1) {
            continue;
        }
        fmt::print(stderr, "{}: begins with entry {}; what came before was not looked at\n",
                   log.string(), verified->first_number);
        exit = options.state.empty() ? exit : Exit::failed;
    }
    return exit;
}

std::string textIn(const nlohmann::ordered_json& entry, const char* name) {
    return entry.is_object() && entry.contains(name) && entry[name].is_string()
               ? entry[name].get<std::string>()
               : std::string();
}

/// The line for a person; what is not an entry as it is. Always printable.
std::string shown(const std::string& line, const nlohmann::ordered_json& entry) {
    if (!entry.is_object()) {
        return opcua::sanitise(line);
    }
    std::string text = fmt::format("{} {}", textIn(entry, "time"), textIn(entry, "event"));
    for (const auto& [name, value] : entry.items()) {
        if (name != "n" && name != "time" && name != "event" && name != "chain") {
            text += fmt::format(" {}={}", name,
                                value.is_string() ? value.get<std::string>() : value.dump());
        }
    }
    return opcua::sanitise(text);
}

bool isWanted(const nlohmann::ordered_json& entry, const AuditOptions& options) {
    // Times of one form are in the order of their text.
    return (options.event.empty() || textIn(entry, "event") == options.event) &&
           (options.since.empty() || textIn(entry, "time") >= options.since);
}

Result<void> showPart(const fs::path& part, const AuditOptions& options) {
    std::ifstream lines(part);
    if (!lines) {
        return fail(Errc::not_found, fmt::format("{} cannot be read", part.string()));
    }
    for (std::string line; std::getline(lines, line);) {
        const auto entry = nlohmann::ordered_json::parse(line, nullptr, false);
        if (isWanted(entry, options)) {
            fmt::print("{}\n", options.json ? opcua::sanitise(line) : shown(line, entry));
        }
    }
    return {};
}

Exit runShow(const AuditOptions& options) {
    const auto logs = chosenLogs(options);
    if (!logs) {
        return reportUsage(logs.error());
    }
    for (const auto& log : *logs) {
        for (const auto& part : audit::partsOf(log)) {
            if (const auto done = showPart(part, options); !done) {
                return report(done.error());
            }
        }
    }
    return Exit::success;
}

void addFiles(CLI::App& command, AuditOptions& options) {
    command.add_option("FILE", options.files, "Audit logs; the parts that follow one come with it");
    command.add_option("--state", options.state,
                       "The state folder of servers, for all logs that are there");
}

}  // namespace

void addAudit(CLI::App& app, Exit& exit) {
    auto* command = app.add_subcommand("audit", "What was done at servers, and what was refused");
    command->require_subcommand(1);
    // Shared by CLI11, which fills it, and the callbacks, which read it.
    auto options = std::make_shared<AuditOptions>();
    auto* verify = command->add_subcommand(
        "verify",
        "Tell whether audit logs are as they were written; fails naming the first line "
        "that is not");
    addFiles(*verify, *options);
    verify->callback([options, &exit] { exit = runVerify(*options); });
    auto* show = command->add_subcommand("show", "Show the entries of audit logs");
    addFiles(*show, *options);
    show->add_option("--since", options->since, "From this time on (UTC), as 2026-11-22T09:30");
    show->add_option("--event", options->event, "Of this name only, as Start or Denied");
    show->add_flag("--json", options->json, "The lines as they are in the file");
    show->callback([options, &exit] { exit = runShow(*options); });
}

}  // namespace metier::app
