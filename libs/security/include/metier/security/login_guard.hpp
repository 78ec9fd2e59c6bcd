#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "metier/base/background_read.hpp"
#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/security/users.hpp"

namespace metier::security {

/// Checks user names and passwords, and delays repeated wrong passwords.
///
/// After five wrong passwords for one user from one application, further attempts are refused for a
/// while, which doubles from one second to a minute. The password is not checked meanwhile: a check
/// takes some ten milliseconds of the server's thread. Each pair of user and application is counted
/// by itself, so a person who guesses locks out neither other users of the same application, such
/// as the page of a cell, nor users of other applications. After twenty wrong passwords from one
/// application for any users, the last within ten minutes, the first wrong one for a user causes a
/// delay.
/// The file of users is read again when it has changed; while a disk hangs, the last known users
/// count.
/// Threading: one thread.
class LoginGuard {
public:
    /// Reads the file of users; waits for the disk.
    /// \param file  of a UserTable; a missing one has no users
    /// \param clock measures the delays; must outlive this
    /// \param patience longest time that check() and roleOf() wait for a change of the file
    /// Errors: those of UserTable::load().
    static Result<LoginGuard> open(const std::filesystem::path& file, const Clock& clock,
                                   std::chrono::milliseconds patience = kReadPatience);

    /// Checks a password and returns the role of its user.
    /// An unknown user takes as long as a wrong password, so the time says nothing. A right
    /// password ends the count of this user and application. If the changed file of users cannot be
    /// read, the error is logged and the users of before stay.
    /// \param thumbprint thumbprint of the application's certificate
    /// Errors: access_denied: a wrong name or password (the text does not say which), or too many
    ///         attempts, with the time to wait.
    Result<Role> check(const std::string& user, const std::string& password,
                       const std::string& thumbprint);

    /// Present role of a user; nothing if the user is not known. Does not count as an attempt.
    /// Waits for the file as check() does.
    std::optional<Role> roleOf(const std::string& user);

private:
    /// Wrong passwords of one pair, and the time until which further attempts are refused.
    struct Failures {
        int count = 0;
        SteadyTime last{};
        SteadyTime barred_until{};
    };
    /// User and thumbprint; an empty user stands for all users of the application together.
    using Who = std::pair<std::string, std::string>;

    struct Users {
        UserTable table;
        std::filesystem::file_time_type changed{};
    };

    LoginGuard(const std::filesystem::path& file, const Clock& clock, Users users,
               std::chrono::milliseconds patience);
    void noteFailure(const Who& who, int free_attempts, const UserTable& users);
    int freeAttempts(const Who& application);
    void forgetOne(const UserTable& users);
    Result<void> checkBar(const Who& who) const;

    const Clock* clock_;
    std::unique_ptr<BackgroundRead<Users>> users_;
    std::map<Who, Failures> failures_;
};

}  // namespace metier::security
