#pragma once

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

/// Lets users in by name and password, and makes whoever guesses wait.
///
/// After five wrong passwords for one user from one application each further attempt is refused for
/// a while, which doubles from one second to a minute, without a look at the password: that look
/// takes some ten milliseconds of the server's thread. Counted for each user and each application
/// by itself: somebody who guesses cannot lock out other users of the same application, such as of
/// the page of a cell, nor those who use others. After twenty wrong passwords from one application
/// for whatever users, the last within ten minutes, the first wrong one for a user is enough.
/// The file of users is read again when it has changed; while a disk hangs, the users of before are
/// let in.
/// Threading: one thread.
class LoginGuard {
public:
    /// \param clock must outlive this
    /// Errors: those of UserTable::load().
    static Result<LoginGuard> open(std::filesystem::path file, const Clock& clock);

    /// \param thumbprint of the certificate of the application
    /// Errors: access_denied: a wrong name or password, not told apart; too many attempts, with how
    ///         long to wait.
    Result<Role> check(const std::string& user, const std::string& password,
                       const std::string& thumbprint);

    /// What a user may do now; nothing for one who is not known.
    std::optional<Role> roleOf(const std::string& user);

private:
    struct Failures {
        int count = 0;
        SteadyTime last{};
        SteadyTime barred_until{};
    };
    using Who = std::pair<std::string, std::string>;

    struct Users {
        UserTable table;
        std::filesystem::file_time_type changed{};
    };

    LoginGuard(const std::filesystem::path& file, const Clock& clock, Users users);
    void noteFailure(const Who& who, int free_attempts, const UserTable& users);
    int freeAttempts(const Who& application);
    void forgetOne(const UserTable& users);
    Result<void> checkBar(const Who& who) const;

    const Clock* clock_;
    std::unique_ptr<BackgroundRead<Users>> users_;
    std::map<Who, Failures> failures_;
};

}  // namespace metier::security
