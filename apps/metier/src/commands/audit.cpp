#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "commands.hpp"
#include "metier/base/text.hpp"
#include "metier/opcua/standard_ids.hpp"
#include "metier/opcua/text.hpp"
#include "metier/opcua_skill/namespaces.hpp"
#include "metier/security/audit_log.hpp"
#include "metier/server/audit_anchor.hpp"
#include "servers.hpp"

namespace metier::app {
namespace {

namespace fs = std::filesystem;

struct AuditOptions {
    std::vector<std::string> files;
    std::string state;
    std::string since;
    std::string event;
    std::vector<std::string> anchors;
    bool json = false;
};

/// Whether it is a part that verify() of another file comes to.
bool followsAnother(const fs::path& file, const std::vector<fs::path>& files) {
    return std::any_of(files.begin(), files.end(), [&](const fs::path& first) {
        const auto parts = security::partsOf(first);
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

/// The chain values of `--anchor`, in small letters.
Result<std::set<std::string>> anchorsOf(const AuditOptions& options) {
    constexpr std::size_t kDigits = 64;
    std::set<std::string> anchors;
    for (const auto& given : options.anchors) {
        auto anchor = inLowerCase(given);
        if (anchor.size() != kDigits ||
            anchor.find_first_not_of("0123456789abcdef") != std::string::npos) {
            return fail(Errc::invalid_argument,
                        fmt::format("--anchor {}: 64 hexadecimal digits expected, as `metier audit "
                                    "anchor` prints them",
                                    opcua::sanitise(anchor)));
        }
        anchors.insert(std::move(anchor));
    }
    return anchors;
}

Exit reportVerified(const fs::path& log, const security::Verified& verified, bool whole_logs) {
    fmt::print("{}: {} entries, {} to {}, last chain value {}\n", log.string(), verified.entries,
               verified.first_time, verified.last_time, verified.last_chain);
    if (verified.first_number == 1) {
        return Exit::success;
    }
    fmt::print(stderr, "{}: begins with entry {}; what came before was not looked at\n",
               log.string(), verified.first_number);
    return whole_logs ? Exit::failed : Exit::success;
}

Result<Exit> runVerify(const AuditOptions& options) {
    METIER_ASSIGN(const auto logs, asUsage(chosenLogs(options)));
    METIER_ASSIGN(const auto anchors, anchorsOf(options));
    auto exit = Exit::success;
    auto missing = anchors;
    for (const auto& log : logs) {
        const auto verified = security::verify(log, anchors);
        if (!verified) {
            report(verified.error());
            exit = Exit::failed;
            continue;
        }
        if (reportVerified(log, *verified, !options.state.empty()) != Exit::success) {
            exit = Exit::failed;
        }
        for (const auto& found : verified->anchors) {
            missing.erase(found);
        }
    }
    for (const auto& anchor : missing) {
        fmt::print(
            stderr,
            "metier: no line has the chain value {}: lines were cut off at the end, or it is "
            "of another log\n",
            anchor);
        exit = Exit::failed;
    }
    return exit;
}

/// As the server publishes it.
Result<std::string> anchorOfServer(const CommandIdentity& identity, const std::string& url) {
    METIER_ASSIGN(const auto client, connectTo(identity, url));
    const auto metier = client->namespaceIndex(opcua_skill::kMetierUri);
    const auto variable =
        metier ? client->translate(opcua::ids::kServer, {{*metier, server::kAuditAnchor}})
               : opcua::Answer<opcua::NodeId>(tl::unexpected(metier.error()));
    if (!variable) {
        return fail(Errc::not_found, fmt::format("{}: keeps no audit log", url));
    }
    const auto value = client->read(*variable);
    if (!value) {
        return fail(value.error().code, fmt::format("{}: {}", url, value.error().message));
    }
    const auto text = value->as<std::string>();
    return text ? Result<std::string>(opcua::sanitise(*text)) : fail(text.error());
}

Result<std::string> anchorOfFile(const fs::path& log) {
    return security::verify(log).map([](const auto& verified) { return verified.last_chain; });
}

Result<Exit> runAnchor(const AuditOptions& options, const CommandIdentity& identity) {
    std::vector<std::string> asked = options.files;
    if (asked.empty()) {
        METIER_ASSIGN(const auto logs, asUsage(chosenLogs(options)));
        asked.assign(logs.begin(), logs.end());
    }
    auto exit = Exit::success;
    for (const auto& one : asked) {
        const auto anchor = isAddress(one) ? anchorOfServer(identity, one) : anchorOfFile(one);
        if (!anchor) {
            exit = report(anchor.error());
            continue;
        }
        fmt::print("{} {}\n", *anchor, one);
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

Result<Exit> runShow(const AuditOptions& options) {
    METIER_ASSIGN(const auto logs, asUsage(chosenLogs(options)));
    for (const auto& log : logs) {
        for (const auto& part : security::partsOf(log)) {
            METIER_TRY(showPart(part, options));
        }
    }
    return Exit::success;
}

void addFiles(CLI::App& command, AuditOptions& options,
              const char* files = "Audit logs; the parts that follow one come with it") {
    command.add_option("FILE", options.files, files);
    command.add_option("--state", options.state,
                       "The state folder of servers, for all logs that are there");
}

}  // namespace

void addAudit(CLI::App& app, CommandContext& context) {
    auto* command = app.add_subcommand(
        "audit", "Check audit logs: what was done at servers, and what was refused");
    command->require_subcommand(1);
    // Shared by CLI11, which fills it, and the callbacks, which read it.
    auto options = std::make_shared<AuditOptions>();
    auto* verify = command->add_subcommand(
        "verify",
        "Check whether audit logs are as they were written; fails naming the first line "
        "that is not");
    addFiles(*verify, *options);
    verify->add_option("--anchor", options->anchors,
                       "A chain value that was newest once: fails unless a line still has it");
    verify->callback([options, &context] { context.exit = exitOf(runVerify(*options)); });
    auto* anchor = command->add_subcommand(
        "anchor",
        "Print the newest chain value of audit logs, to be kept elsewhere: as files have it, or as "
        "servers publish it");
    addFiles(*anchor, *options, "Audit logs, or servers: opc.tcp://host:port");
    anchor->callback(
        [options, &context] { context.exit = exitOf(runAnchor(*options, context.identity)); });
    auto* show = command->add_subcommand("show", "Show the entries of audit logs");
    addFiles(*show, *options);
    show->add_option("--since", options->since, "From this time on (UTC), as 2026-11-22T09:30");
    show->add_option("--event", options->event, "Of this name only, as Start or Denied");
    show->add_flag("--json", options->json, "The lines as they are in the file");
    show->callback([options, &context] { context.exit = exitOf(runShow(*options)); });
}

}  // namespace metier::app
