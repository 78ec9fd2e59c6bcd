#include "security.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <mutex>

#include "folders.hpp"
#include "metier/opcua/discovery.hpp"
#include "metier/opcua/text.hpp"

namespace metier::app {
namespace {

struct Choice {
    bool insecure_lab = false;
    std::string folder;
    std::string user;
};

/// What this process is; filled by the command line first, then under the mutex.
struct Process {
    Choice choice;
    std::mutex mutex;
    std::optional<opcua::Credentials> application;  // as becomeApplication() made it
    std::optional<opcua::Credentials> command;
    std::optional<opcua::UserName> user;
};

Process& process() {
    static Process one;
    return one;
}

/// That of `--security`, else of the user.
Result<std::filesystem::path> securityFolder() {
    const auto& chosen = process().choice.folder;
    auto folder = chosen.empty() ? userConfigFolder() : std::filesystem::path(chosen);
    return folder.empty() ? fail(Errc::resource_unavailable,
                                 "neither HOME nor XDG_CONFIG_HOME says where certificates are "
                                 "kept: name a folder with --security")
                          : Result<std::filesystem::path>(std::move(folder));
}

bool wasClosed(const std::string& url) {
    const auto known = knownServers();
    return known && known->isClosed(url);
}

Error openServer(const std::string& url) {
    if (wasClosed(url)) {
        return {Errc::access_denied,
                fmt::format("this server was closed before, and now one without security answers "
                            "there: somebody else may have taken its place. If it was made a lab: "
                            "metier trust forget {}",
                            url)};
    }
    return {Errc::access_denied,
            "the server has no security, so anybody could answer in its place: --insecure-lab "
            "speaks to it all the same"};
}

Result<opcua::Credentials> credentialsOf(const std::string& name,
                                         const security::IdentityOptions& options) {
    auto folder = openSecurityFolder();
    if (!folder) {
        return fail(folder.error());
    }
    auto identity = folder->identity(name, options, std::chrono::system_clock::now());
    if (!identity) {
        return fail(identity.error());
    }
    return opcua::Credentials{std::move(*identity), folder->trustFolder(),
                              folder->identityFolder(name)};
}

Result<bool> offersNoSecurity(const std::string& url, std::chrono::milliseconds timeout) {
    const auto endpoints = opcua::getEndpoints(url, timeout);
    if (!endpoints) {
        return fail(endpoints.error().code, opcua::sanitise(endpoints.error().message));
    }
    using Mode = opcua::EndpointDescription::SecurityMode;
    return std::all_of(endpoints->begin(), endpoints->end(),
                       [](const auto& endpoint) { return endpoint.security_mode == Mode::none; });
}

/// Makes the identity of commands, and asks for the password, once.
Result<void> prepareCommand(Process& self) {
    if (!self.command) {
        auto made = credentialsOf(
            "command", {.application_name = "metier command",
                        .application_uri = fmt::format("urn:{}:metier:command", hostName()),
                        .hosts = {hostName()}});
        if (!made) {
            return fail(made.error());
        }
        self.command = std::move(*made);
    }
    if (!self.choice.user.empty() && !self.user) {
        auto password = readPassword(self.choice.user);
        if (!password) {
            return fail(password.error());
        }
        self.user = opcua::UserName{self.choice.user, std::move(*password)};
    }
    return {};
}

/// Hides what is typed until its end.
class Silence {
public:
    Silence() : is_terminal_(tcgetattr(STDIN_FILENO, &before_) == 0) {
        if (is_terminal_) {
            auto silent = before_;
            silent.c_lflag &= ~static_cast<tcflag_t>(ECHO);
            tcsetattr(STDIN_FILENO, TCSAFLUSH, &silent);
        }
    }
    ~Silence() {
        if (is_terminal_) {
            tcsetattr(STDIN_FILENO, TCSAFLUSH, &before_);
        }
    }
    Silence(const Silence&) = delete;
    Silence& operator=(const Silence&) = delete;
    bool isTerminal() const noexcept { return is_terminal_; }

private:
    termios before_{};
    bool is_terminal_;
};

}  // namespace

void addSecurityOptions(CLI::App& app) {
    auto& choice = process().choice;
    app.add_flag("--insecure-lab", choice.insecure_lab,
                 "No encryption, no certificates, no users, on this machine alone: for trials");
    app.add_option("--security", choice.folder,
                   "Folder of certificates, keys and users [~/.config/metier]");
    app.add_option("--user", choice.user,
                   "Log in to servers as this user; the password is asked for, or taken from "
                   "METIER_PASSWORD");
}

std::vector<std::string> securityArguments() {
    const auto& choice = process().choice;
    std::vector<std::string> arguments;
    if (choice.insecure_lab) {
        arguments.emplace_back("--insecure-lab");
    }
    if (!choice.folder.empty()) {
        arguments.insert(arguments.end(), {"--security", choice.folder});
    }
    return arguments;
}

bool isInsecureLab() {
    return process().choice.insecure_lab;
}

Result<security::SecurityFolder> openSecurityFolder() {
    const auto folder = securityFolder();
    return folder ? security::SecurityFolder::open(*folder) : fail(folder.error());
}

Result<security::KnownServers> knownServers() {
    const auto folder = securityFolder();
    return folder ? Result<security::KnownServers>(security::SecurityFolder::knownServers(*folder))
                  : fail(folder.error());
}

Result<void> becomeApplication(const std::string& name, const security::IdentityOptions& options) {
    if (isInsecureLab()) {
        return {};
    }
    auto made = credentialsOf(name, options);
    if (!made) {
        return fail(made.error());
    }
    const std::lock_guard lock(process().mutex);
    process().application = std::move(*made);
    return {};
}

std::optional<opcua::Credentials> ownCredentials() {
    const std::lock_guard lock(process().mutex);
    return process().application;
}

Result<void> secure(opcua::ClientOptions& options, const std::string& url) {
    auto& self = process();
    if (self.choice.insecure_lab) {
        return wasClosed(url)
                   ? fail(Errc::access_denied,
                          fmt::format("this server was closed before, and is not spoken to without "
                                      "security: leave out --insecure-lab. If it was made a lab: "
                                      "metier trust forget {}",
                                      url))
                   : Result<void>();
    }
    if (auto own = ownCredentials()) {
        options.security = std::move(own);
        return {};
    }
    const auto open = offersNoSecurity(url, options.connect_timeout);
    if (!open || *open) {
        return fail(open ? openServer(url) : open.error());
    }
    const std::lock_guard lock(self.mutex);
    if (auto ready = prepareCommand(self); !ready) {
        return ready;
    }
    options.security = self.command;
    options.user = self.user;
    return {};
}

void noteConnected(const opcua::ClientOptions& options, const std::string& url) {
    const auto known = options.security ? knownServers() : fail(Errc::not_found, "");
    if (!known) {
        return;
    }
    if (const auto noted = known->noteClosed(url); !noted) {
        spdlog::warn("{} is not remembered as closed: {}", url, noted.error().message);
    }
}

void noteServedOpen(const std::string& url) {
    const auto known = knownServers();
    const auto forgotten = known ? known->forget(url) : fail(known.error());
    if (!forgotten) {
        spdlog::debug("{}: {}", url, forgotten.error().message);
    }
}

std::string adviceOn(const opcua::Failure& refusal) {
    auto& self = process();
    const std::lock_guard lock(self.mutex);
    const auto& own = self.application ? self.application : self.command;
    if (refusal.status == opcua::status::kBadSecurityChecksFailed && own) {
        return fmt::format(
            "; the server may not trust this application: there, metier trust accept {}",
            own->identity.certificate.thumbprint());
    }
    if (refusal.status == opcua::status::kBadUserAccessDenied && own) {
        return self.user ? "; a wrong name or password, or too many of them: wait a minute"
                         : fmt::format(
                               "; log in with --user, or there: metier trust accept {} "
                               "--role Operator",
                               own->identity.certificate.thumbprint());
    }
    if (refusal.status == opcua::status::kBadIdentityTokenRejected && !own) {
        return "; the server may be closed: leave out --insecure-lab";
    }
    if (refusal.status == opcua::status::kBadCertificateUntrusted) {
        return "; metier trust list tells whether to accept it";
    }
    return {};
}

Result<std::string> readPassword(const std::string& user) {
    // NOLINTNEXTLINE(concurrency-mt-unsafe): nobody changes the environment
    if (const char* given = std::getenv("METIER_PASSWORD"); given != nullptr) {
        return std::string(given);
    }
    const Silence silence;
    if (!silence.isTerminal()) {
        return fail(Errc::access_denied,
                    fmt::format("the password of {} is to be in METIER_PASSWORD, or to be typed "
                                "at a terminal",
                                user));
    }
    fmt::print(stderr, "password of {}: ", user);
    std::string password;
    std::getline(std::cin, password);
    fmt::print(stderr, "\n");
    return password;
}

}  // namespace metier::app
