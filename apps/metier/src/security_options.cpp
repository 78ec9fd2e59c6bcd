#include "security_options.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace metier::app {

void addSecurityOptions(CLI::App& app, CommandContext& context) {
    app.add_flag("--insecure-lab", context.security.insecure_lab,
                 "No encryption, no certificates, no users, on this machine alone: for trials");
    app.add_option_function<std::string>(
        "--security", [&context](const std::string& folder) { context.security.folder = folder; },
        "Folder of certificates, keys and users [~/.config/metier]");
    app.add_option("--user", context.user,
                   "Log in to servers as this user; the password is asked for, or taken from "
                   "METIER_PASSWORD");
}

std::vector<std::string> securityArguments(const server::Security& security) {
    std::vector<std::string> arguments;
    if (security.insecure_lab) {
        arguments.emplace_back("--insecure-lab");
    }
    if (!security.folder.empty()) {
        arguments.insert(arguments.end(), {"--security", security.folder.string()});
    }
    return arguments;
}

void printLabNotice(const server::Security& security) {
    if (security.insecure_lab) {
        fmt::print(stderr,
                   "INSECURE LAB: no encryption, and everybody on this machine may command\n");
    }
}

void warnOfLab(const server::Security& security, const std::string& server,
               const std::string& url) {
    if (security.insecure_lab) {
        spdlog::warn("INSECURE LAB: {} at {} has no encryption and lets anonymous users in", server,
                     url);
    }
}

}  // namespace metier::app
