#include "metier/security/security_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

#include "holdings.hpp"
#include "openssl.hpp"
#include "private_file.hpp"

namespace metier::security {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestFileName = 100;
constexpr std::size_t kThumbprintDigits = 40;

Result<void> checkFileName(std::string_view name) {
    constexpr std::string_view kAllowed =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.-_";
    const bool right = !name.empty() && name.size() <= kLongestFileName && name.front() != '.' &&
                       name.find_first_not_of(kAllowed) == std::string_view::npos;
    return right ? Result<void>()
                 : fail(Errc::invalid_argument,
                        fmt::format("\"{}\" is no name of an application: letters, digits, '.', "
                                    "'-', '_', at most {}",
                                    name, kLongestFileName));
}

bool isThumbprint(std::string_view text) {
    return text.size() == kThumbprintDigits &&
           text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

}  // namespace

Result<SecurityFolder> SecurityFolder::open(fs::path folder) {
    METIER_TRY(makeFolder(folder));
    std::error_code error;
    constexpr auto kOthersWrite = fs::perms::group_write | fs::perms::others_write;
    if ((fs::status(folder, error).permissions() & kOthersWrite) != fs::perms::none) {
        return fail(Errc::access_denied,
                    fmt::format("others may write to {}: chmod 700", folder.string()));
    }
    METIER_TRY(TrustStore::open(folder / "trust"));
    return SecurityFolder(std::move(folder));
}

fs::path SecurityFolder::identityFolder(const std::string& name) const {
    return folder_ / "own" / name;
}

/// The identity is made known before it is saved, so that a saved identity is always known.
Result<Identity> SecurityFolder::keep(const std::string& name, Identity identity) {
    METIER_ASSIGN(auto store, TrustStore::open(trustFolder()));
    METIER_TRY(store.trust(identity.certificate));
    METIER_TRY(setRole(identity.certificate, Role::operator_));
    METIER_TRY(saveIdentity(identityFolder(name), identity));
    return identity;
}

Result<Identity> SecurityFolder::identity(const std::string& name, const IdentityOptions& options,
                                          UtcTime now) {
    METIER_TRY(checkFileName(name));
    auto identity = loadIdentity(identityFolder(name));
    if (identity || identity.error().code != Errc::not_found) {
        return identity;
    }
    METIER_ASSIGN(auto made, makeIdentity(options, now));
    return keep(name, std::move(made));
}

Result<Identity> SecurityFolder::renew(const std::string& name, UtcTime now) {
    METIER_TRY(checkFileName(name));
    METIER_ASSIGN(const auto former, loadIdentity(identityFolder(name)));
    METIER_ASSIGN(auto made, makeSuccessor(former, IdentityOptions().lifetime, now));
    return keep(name, std::move(made));
}

std::vector<SecurityFolder::Own> SecurityFolder::own() const {
    std::vector<Own> all;
    std::error_code error;
    for (fs::directory_iterator entry(folder_ / "own", error), end; !error && entry != end;
         entry.increment(error)) {
        auto name = entry->path().filename().string();
        if (auto identity = loadIdentity(entry->path())) {
            all.push_back({std::move(name), std::move(identity->certificate)});
        }
    }
    std::sort(all.begin(), all.end(), [](const Own& a, const Own& b) { return a.name < b.name; });
    return all;
}

std::optional<Role> SecurityFolder::roleOf(std::string_view thumbprint) const {
    if (!isThumbprint(thumbprint)) {
        return std::nullopt;
    }
    auto text = readFile((folder_ / "roles" / thumbprint).string());
    while (!text.empty() && text.back() == '\n') {
        text.pop_back();
    }
    return roleNamed(text);
}

std::map<std::string, Role> SecurityFolder::roles() const {
    std::map<std::string, Role> roles;
    for (const auto& file : filesIn(folder_ / "roles")) {
        const auto thumbprint = file.filename().string();
        if (const auto role = roleOf(thumbprint)) {
            roles.emplace(thumbprint, *role);
        }
    }
    return roles;
}

Result<void> SecurityFolder::setRole(const Certificate& certificate, std::optional<Role> role) {
    const auto file = folder_ / "roles" / certificate.thumbprint();
    if (role) {
        return writeWhole(file, fmt::format("{}\n", toString(*role)), Readers::owner);
    }
    std::error_code error;
    fs::remove(file, error);
    return error ? failed(file, error.value()) : Result<void>();
}

}  // namespace metier::security
