#include "metier/security/users.hpp"

#include <crypt.h>
#include <fmt/format.h>
#include <openssl/crypto.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <memory>
#include <sstream>

#include "openssl.hpp"
#include "private_file.hpp"

namespace metier::security {
namespace {

constexpr const char* kMethod = "$y$";  // yescrypt
constexpr unsigned long kCost = 4;      // some 16 ms
constexpr std::size_t kLongestUserName = 64;
constexpr std::size_t kShortestPassword = 8;
constexpr std::size_t kLongestPassword = 256;
constexpr std::string_view kNameCharacters =
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.-_@";
/// In the order of Role.
constexpr std::array<std::string_view, 4> kRoleNames{"Observer", "Operator", "Engineer",
                                                     "SecurityAdmin"};

Result<void> checkUserName(const std::string& name) {
    const bool right = !name.empty() && name.size() <= kLongestUserName &&
                       name.find_first_not_of(kNameCharacters) == std::string::npos;
    return right ? Result<void>()
                 : fail(Errc::invalid_argument,
                        fmt::format("a user's name has 1 to {} letters, digits, . - _ or @",
                                    kLongestUserName));
}

Result<void> checkPassword(const std::string& password) {
    const bool right = password.size() >= kShortestPassword &&
                       password.size() <= kLongestPassword &&
                       password.find('\0') == std::string::npos;
    return right ? Result<void>()
                 : fail(Errc::invalid_argument, fmt::format("a password has {} to {} characters",
                                                            kShortestPassword, kLongestPassword));
}

tl::unexpected<Error> noUser(std::string_view name) {
    return fail(Errc::not_found, fmt::format("no user \"{}\"", name));
}

/// The hash with the salt and cost of `setting`; empty if it is none.
std::string crypted(const std::string& password, const std::string& setting) {
    const auto memory = std::make_unique<crypt_data>();  // 32 kB
    const char* hash = crypt_r(password.c_str(), setting.c_str(), memory.get());
    std::string result = hash == nullptr || hash[0] == '*' ? "" : hash;
    OPENSSL_cleanse(memory.get(), sizeof(crypt_data));
    return result;
}

Result<User> readUser(const std::string& line) {
    std::istringstream parts(line);
    std::string role;
    std::string more;
    User user;
    parts >> user.name >> role >> user.password_hash;
    const auto known = roleNamed(role);
    if (!known || user.password_hash.empty() || parts >> more || !checkUserName(user.name)) {
        return fail(Errc::invalid_argument, "is not a name, a role and a password hash");
    }
    user.role = *known;
    return user;
}

}  // namespace

std::string_view toString(Role role) noexcept {
    return kRoleNames[static_cast<std::size_t>(role)];
}

std::optional<Role> roleNamed(std::string_view name) noexcept {
    const auto* found = std::find(kRoleNames.begin(), kRoleNames.end(), name);
    return found == kRoleNames.end() ? std::nullopt
                                     : std::optional(static_cast<Role>(found - kRoleNames.begin()));
}

Result<UserTable> UserTable::load(const std::filesystem::path& file) {
    UserTable table;
    auto text = readPrivate(file);
    if (!text) {
        return text.error().code == Errc::not_found ? Result<UserTable>(table) : fail(text.error());
    }
    std::istringstream lines(*text);
    int number = 0;
    for (std::string line; std::getline(lines, line);) {
        ++number;
        if (line.empty() || line.front() == '#') {
            continue;
        }
        auto user = readUser(line);
        if (!user || table.find(user->name) != nullptr) {
            return fail(Errc::invalid_argument,
                        fmt::format("{}:{}: {}", file.string(), number,
                                    user ? "the user is there twice" : user.error().message));
        }
        table.users_.push_back(std::move(*user));
    }
    return table;
}

Result<void> UserTable::save(const std::filesystem::path& file) const {
    std::string text = "# name role password-hash; changed by `metier user`\n";
    for (const auto& user : users_) {
        text += fmt::format("{} {} {}\n", user.name, toString(user.role), user.password_hash);
    }
    if (text.size() > kLargestFile) {  // load() would refuse it
        return fail(Errc::invalid_argument,
                    fmt::format("{}: {} users are over 64 kB", file.string(), users_.size()));
    }
    return writeWhole(file, text, Readers::owner);
}

const User* UserTable::find(std::string_view name) const noexcept {
    const auto found = std::find_if(users_.begin(), users_.end(),
                                    [&](const User& user) { return user.name == name; });
    return found == users_.end() ? nullptr : &*found;
}

Result<void> UserTable::add(std::string name, Role role, const std::string& password) {
    METIER_TRY(checkUserName(name));
    if (find(name) != nullptr) {
        return fail(Errc::already_exists, fmt::format("there is a user \"{}\"", name));
    }
    METIER_TRY(checkPassword(password));
    METIER_ASSIGN(auto hash, hashPassword(password));
    users_.push_back({std::move(name), role, std::move(hash)});
    return {};
}

Result<void> UserTable::setPassword(std::string_view name, const std::string& password) {
    const auto user = std::find_if(users_.begin(), users_.end(),
                                   [&](const User& each) { return each.name == name; });
    if (user == users_.end()) {
        return noUser(name);
    }
    METIER_TRY(checkPassword(password));
    METIER_ASSIGN(auto hash, hashPassword(password));
    user->password_hash = std::move(hash);
    return {};
}

Result<void> UserTable::remove(std::string_view name) {
    return std::erase_if(users_, [&](const User& user) { return user.name == name; }) > 0
               ? Result<void>()
               : noUser(name);
}

Result<std::string> hashPassword(const std::string& password) {
    const std::unique_ptr<char, decltype(&std::free)> setting(
        crypt_gensalt_ra(kMethod, kCost, nullptr, 0), &std::free);
    auto hash = setting ? crypted(password, setting.get()) : std::string();
    return hash.empty() ? fail(Errc::internal, "this system's crypt() knows no yescrypt")
                        : Result<std::string>(std::move(hash));
}

bool isPassword(const std::string& password, const std::string& hash) {
    if (password.size() > kLongestPassword || password.find('\0') != std::string::npos) {
        return false;
    }
    const auto made = crypted(password, hash);
    return !made.empty() && made.size() == hash.size() &&
           CRYPTO_memcmp(made.data(), hash.data(), made.size()) == 0;
}

}  // namespace metier::security
