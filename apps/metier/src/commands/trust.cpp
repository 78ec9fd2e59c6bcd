#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "command_context.hpp"
#include "metier/opcua/text.hpp"
#include "metier/security/security_folder.hpp"

namespace metier::app {
namespace {

using security::Certificate;
using security::SecurityFolder;
using security::TrustStore;

struct TrustOptions {
    std::string what;  // a thumbprint, a file or a name
    std::string role;
};

/// Files that each of these commands works on.
struct Place {
    SecurityFolder folder;
    TrustStore store;
};

Result<Place> openPlace(const server::Security& security) {
    METIER_ASSIGN(auto folder, security.openFolder());
    METIER_ASSIGN(auto store, TrustStore::open(folder.trustFolder()));
    return Place{std::move(folder), std::move(store)};
}

/// "ends 2028-11-21", and what is to be done about it.
std::string endText(const Certificate& certificate) {
    const auto now = std::chrono::system_clock::now();
    const auto* remark = certificate.notAfter() < now                            ? ", is over"
                         : certificate.notAfter() < now + security::kRenewalTime ? ", renew it"
                                                                                 : "";
    return fmt::format("ends {}{}", security::dateText(certificate.notAfter()), remark);
}

void print(const Certificate& certificate, const std::string& remark) {
    fmt::print("  {}  {}  {}, {}{}\n", certificate.thumbprint(),
               opcua::sanitise(certificate.subject()),
               opcua::sanitise(certificate.applicationUri()), endText(certificate),
               remark.empty() ? "" : ", " + remark);
}

std::string roleText(const SecurityFolder& folder, const Certificate& certificate) {
    const auto role = folder.roleOf(certificate.thumbprint());
    return role ? fmt::format("{} without a user", security::toString(*role)) : "";
}

Result<void> list(Place& place) {
    fmt::print("own, in {}:\n", place.folder.path().string());
    for (const auto& own : place.folder.own()) {
        print(own.certificate, own.name);
    }
    fmt::print("trusted:\n");
    for (const auto& certificate : place.store.trusted()) {
        print(certificate, roleText(place.folder, certificate));
    }
    fmt::print("rejected, to be decided on:\n");
    for (const auto& certificate : place.store.rejected()) {
        print(certificate, "");
    }
    return {};
}

/// A file's, or one of those that were rejected.
Result<Certificate> trustOne(Place& place, const std::string& what) {
    std::error_code error;
    if (!std::filesystem::exists(what, error)) {
        return place.store.trustRejected(what);
    }
    METIER_ASSIGN(auto certificate, Certificate::fromFile(what));
    METIER_TRY(place.store.trust(certificate));
    return certificate;
}

Result<void> accept(Place& place, const TrustOptions& options) {
    const auto role = security::roleNamed(options.role);
    METIER_ASSIGN(const auto certificate, trustOne(place, options.what));
    if (role) {
        METIER_TRY(place.folder.setRole(certificate, role));
    }
    fmt::print("trusted from now on:\n");
    print(certificate, roleText(place.folder, certificate));
    return {};
}

Result<void> reject(Place& place, const TrustOptions& options) {
    METIER_ASSIGN(const auto certificate, place.store.distrust(options.what));
    METIER_TRY(place.folder.setRole(certificate, std::nullopt));
    fmt::print("trusted no longer:\n");
    print(certificate, "");
    return {};
}

Result<void> revoke(Place& place, const TrustOptions& options) {
    METIER_TRY(place.store.addRevocationList(options.what));
    fmt::print("the revocation list {} holds from now on\n", options.what);
    return {};
}

Result<void> renew(Place& place, const TrustOptions& options) {
    METIER_ASSIGN(const auto identity,
                  place.folder.renew(options.what, std::chrono::system_clock::now()));
    const auto file = place.folder.identityFolder(options.what) / "certificate.der";
    fmt::print("renewed:\n");
    print(identity.certificate, options.what);
    fmt::print("whoever trusted the former is to trust {}\n", file.string());
    return {};
}

Result<void> forget(Place& place, const TrustOptions& options) {
    const auto known = SecurityFolder::knownServers(place.folder.path());
    METIER_ASSIGN(const auto forgotten, known.forget(options.what));
    fmt::print("{} {}\n", opcua::sanitise(options.what),
               forgotten ? "may be open from now on" : "was not known as closed");
    return {};
}

using Action = Result<void> (*)(Place&, const TrustOptions&);

Result<Exit> runAction(Action action, const TrustOptions& options,
                       const server::Security& security) {
    METIER_ASSIGN(auto place, openPlace(security));
    METIER_TRY(action(place, options));
    return Exit::success;
}

}  // namespace

void addTrust(CLI::App& app, CommandContext& context) {
    // Shared by CLI11, which fills it, and the callbacks, which read it.
    auto options = std::make_shared<TrustOptions>();
    auto* command = app.add_subcommand("trust", "Decide which applications are trusted");
    command->require_subcommand(1);
    const auto add = [&](const char* name, const char* about, Action action) {
        auto* one = command->add_subcommand(name, about);
        one->callback([options, action, &context] {
            context.exit = exitOf(runAction(action, *options, context.security));
        });
        return one;
    };
    add("list", "Own certificates, those trusted, and those that were rejected",
        [](Place& place, const TrustOptions&) { return list(place); });
    auto* accepting =
        add("accept", "Trust an application that was rejected, or the one of a file", &accept);
    accepting->add_option("certificate", options->what, "Thumbprint or its beginning, or a file")
        ->required();
    accepting
        ->add_option("--role", options->role,
                     "What it may do without a user: Observer, Operator, Engineer, SecurityAdmin")
        ->check(CLI::IsMember({"Observer", "Operator", "Engineer", "SecurityAdmin"}));
    add("reject", "Trust an application no longer; its sessions are closed", &reject)
        ->add_option("certificate", options->what, "Thumbprint or its beginning")
        ->required();
    add("forget", "Believe an open server at an address where a closed one was", &forget)
        ->add_option("address", options->what, "opc.tcp://host:port")
        ->required();
    add("revoke", "Take an authority's revocation list", &revoke)
        ->add_option("file", options->what, "The list, DER or PEM")
        ->required();
    add("renew", "Give an application of this folder a new key and certificate; it need not stop",
        &renew)
        ->add_option("name", options->what, "Its name, as `metier trust list` shows it")
        ->required();
}

}  // namespace metier::app
