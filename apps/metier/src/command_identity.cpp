#include "command_identity.hpp"

#include <fmt/format.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <utility>

#include "metier/opcua/discovery.hpp"
#include "metier/opcua/text.hpp"
#include "metier/server/user_folders.hpp"

namespace metier::app {
namespace {

Error openServer(const server::Security& security, const std::string& url) {
    if (security.wasClosed(url)) {
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

Result<bool> offersNoSecurity(const std::string& url, std::chrono::milliseconds timeout) {
    const auto endpoints = opcua::getEndpoints(url, timeout);
    if (!endpoints) {
        return fail(endpoints.error().code, opcua::sanitise(endpoints.error().message));
    }
    using Mode = opcua::EndpointDescription::SecurityMode;
    return std::all_of(endpoints->begin(), endpoints->end(),
                       [](const auto& endpoint) { return endpoint.security_mode == Mode::none; });
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

Result<std::string> readPassword(const std::string& user) {
    // NOLINTNEXTLINE(concurrency-mt-unsafe): the environment never changes
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

CommandIdentity::CommandIdentity(const server::Security& security, const std::string& user)
    : security_(security), user_(user) {}

Result<void> CommandIdentity::secure(opcua::ClientOptions& options, const std::string& url) const {
    if (security_.insecure_lab) {
        return security_.checkOpen(url);
    }
    const auto open = offersNoSecurity(url, options.connect_timeout);
    if (!open || *open) {
        return fail(open ? openServer(security_, url) : open.error());
    }
    const std::lock_guard lock(mutex_);
    METIER_TRY(prepare());
    options.security = credentials_;
    options.user = login_;
    return {};
}

Result<void> CommandIdentity::prepare() const {
    if (!credentials_) {
        METIER_ASSIGN(
            credentials_,
            security_.credentials("command", {.application_name = "metier command",
                                              .application_uri = fmt::format(
                                                  "urn:{}:metier:command", server::hostName()),
                                              .hosts = {server::hostName()}}));
    }
    if (!user_.empty() && !login_) {
        METIER_ASSIGN(auto password, readPassword(user_));
        login_ = opcua::UserName{user_, std::move(password)};
    }
    return {};
}

void CommandIdentity::noteConnected(const opcua::ClientOptions& options,
                                    const std::string& url) const {
    security_.noteConnected(options, url);
}

std::string CommandIdentity::adviceOn(const opcua::Failure& refusal) const {
    const std::lock_guard lock(mutex_);
    if (refusal.status == opcua::status::kBadSecurityChecksFailed && credentials_) {
        return fmt::format(
            "; the server may not trust this application: there, metier trust accept {}",
            credentials_->identity.certificate.thumbprint());
    }
    if (refusal.status == opcua::status::kBadUserAccessDenied && credentials_) {
        return login_ ? "; a wrong name or password, or too many of them: wait a minute"
                      : fmt::format(
                            "; log in with --user, or there: metier trust accept {} "
                            "--role Operator",
                            credentials_->identity.certificate.thumbprint());
    }
    if (refusal.status == opcua::status::kBadIdentityTokenRejected && !credentials_) {
        return "; the server may be closed: leave out --insecure-lab";
    }
    if (refusal.status == opcua::status::kBadCertificateUntrusted) {
        return "; metier trust list says whether to accept it";
    }
    return {};
}

}  // namespace metier::app
