#include "metier/security/login_guard.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace metier::security {
namespace {

using namespace std::chrono_literals;

constexpr int kFreeAttempts = 5;
constexpr int kManyAttempts = 20;  // wrong passwords of one application
constexpr auto kMemory = 10min;
constexpr auto kFirstPause = 1s;
constexpr auto kLongestPause = 60s;
constexpr std::size_t kMostRemembered = 200;
constexpr std::size_t kLongestName = 64;

std::filesystem::file_time_type changeOf(const std::filesystem::path& file) {
    std::error_code error;
    const auto time = std::filesystem::last_write_time(file, error);
    return error ? std::filesystem::file_time_type::min() : time;
}

/// Hash for unknown user names, so that their answer takes as long.
const std::string& hashOfNobody() {
    static const auto hash = hashPassword("nobody's").value_or("");
    return hash;
}

}  // namespace

Result<LoginGuard> LoginGuard::open(const std::filesystem::path& file, const Clock& clock,
                                    std::chrono::milliseconds patience) {
    const auto changed = changeOf(file);
    METIER_ASSIGN(auto users, UserTable::load(file));
    return LoginGuard(file, clock, {std::move(users), changed}, patience);
}

LoginGuard::LoginGuard(const std::filesystem::path& file, const Clock& clock, Users users,
                       std::chrono::milliseconds patience)
    : clock_(&clock) {
    using Kept = std::shared_ptr<const Users>;
    users_ = std::make_unique<BackgroundRead<Users>>(
        std::make_shared<Users>(std::move(users)),
        [file](const Kept& last) -> Kept {
            const auto changed = changeOf(file);
            if (changed == last->changed) {
                return last;
            }
            auto table = UserTable::load(file);
            if (!table) {
                spdlog::error("the users of before stay: {}", table.error().message);
            }
            return std::make_shared<Users>(Users{table ? std::move(*table) : last->table, changed});
        },
        patience);
}

Result<Role> LoginGuard::check(const std::string& user, const std::string& password,
                               const std::string& thumbprint) {
    const auto users = users_->get();
    const Who who{user.substr(0, kLongestName), thumbprint};
    METIER_TRY(checkBar(who));
    const auto* known = users->table.find(user);
    const bool right = isPassword(password, known ? known->password_hash : hashOfNobody());
    if (known == nullptr || !right) {
        const Who application{"", thumbprint};  // no user has that name
        noteFailure(who, freeAttempts(application), users->table);
        noteFailure(application, std::numeric_limits<int>::max(), users->table);
        return fail(Errc::access_denied, "unknown user or wrong password");
    }
    failures_.erase(who);
    return known->role;
}

std::optional<Role> LoginGuard::roleOf(const std::string& user) {
    const auto users = users_->get();
    const auto* known = users->table.find(user);
    return known == nullptr ? std::nullopt : std::optional(known->role);
}

Result<void> LoginGuard::checkBar(const Who& who) const {
    const auto failures = failures_.find(who);
    const auto now = clock_->now();
    if (failures == failures_.end() || now >= failures->second.barred_until) {
        return {};
    }
    const std::chrono::duration<double> wait = failures->second.barred_until - now;
    return fail(Errc::access_denied,
                fmt::format("too many wrong passwords: wait {:.0f} s", std::ceil(wait.count())));
}

/// Forgets one entry, an unknown user name first: so invented names do not end the counting of
/// guesses at real users.
void LoginGuard::forgetOne(const UserTable& users) {
    const auto isLess = [&](const auto& left, const auto& right) {
        const auto isKept = [&](const std::string& user) {
            return user.empty() || users.find(user) != nullptr;
        };
        const bool known_left = isKept(left.first.first);
        const bool known_right = isKept(right.first.first);
        return std::pair(known_left, left.second.barred_until) <
               std::pair(known_right, right.second.barred_until);
    };
    failures_.erase(std::min_element(failures_.begin(), failures_.end(), isLess));
}

/// An application that tries many names gets few attempts at each, and no name is barred by others.
int LoginGuard::freeAttempts(const Who& application) {
    const auto failures = failures_.find(application);
    if (failures != failures_.end() && clock_->now() - failures->second.last > kMemory) {
        failures_.erase(failures);
        return kFreeAttempts;
    }
    return failures == failures_.end() || failures->second.count < kManyAttempts ? kFreeAttempts
                                                                                 : 1;
}

void LoginGuard::noteFailure(const Who& who, int free_attempts, const UserTable& users) {
    if (failures_.size() >= kMostRemembered && failures_.find(who) == failures_.end()) {
        forgetOne(users);
    }
    auto& failures = failures_[who];
    ++failures.count;
    failures.last = clock_->now();
    if (failures.count >= free_attempts) {
        const int doubled = std::min(failures.count - free_attempts, 6);
        const auto pause =
            std::min<std::chrono::seconds>(kFirstPause * (1 << doubled), kLongestPause);
        failures.barred_until = clock_->now() + pause;
    }
}

}  // namespace metier::security
