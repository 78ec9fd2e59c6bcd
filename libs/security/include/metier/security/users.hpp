#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/error.hpp"

namespace metier::security {

/// What somebody may do (OPC 10000-18).
enum class Role {
    observer,        ///< reads and browses
    operator_,       ///< also commands skills
    engineer,        ///< also changes how the server works
    security_admin,  ///< decides whom to trust; commands nothing
};
/// "Observer", "Operator", "Engineer", "SecurityAdmin".
std::string_view toString(Role role) noexcept;
std::optional<Role> roleNamed(std::string_view name) noexcept;

struct User {
    std::string name;
    Role role = Role::observer;
    std::string password_hash;  ///< as crypt(5): yescrypt, with its salt
};

/// The users of a server, in a file that its owner alone may read: a line for each, with name, role
/// and password hash.
///
/// Threading: one thread.
class UserTable {
public:
    UserTable() = default;
    /// No file is a table without users.
    /// Errors: access_denied (others may read the file), invalid_argument, naming the line.
    static Result<UserTable> load(const std::filesystem::path& file);
    /// Errors: resource_unavailable.
    Result<void> save(const std::filesystem::path& file) const;

    const std::vector<User>& users() const noexcept { return users_; }
    const User* find(std::string_view name) const noexcept;
    /// Errors: already_exists; invalid_argument (a name of other characters than letters, digits,
    ///         `.`, `-`, `_`, `@`, or over 64; a password of less than 8 characters or over 256).
    Result<void> add(std::string name, Role role, const std::string& password);
    /// Errors: not_found; invalid_argument (the password).
    Result<void> setPassword(std::string_view name, const std::string& password);
    /// Errors: not_found.
    Result<void> remove(std::string_view name);

private:
    std::vector<User> users_;
};

/// Takes some ten milliseconds, so that nobody can guess many.
/// Errors: internal (the system's crypt()).
Result<std::string> hashPassword(const std::string& password);
/// Whether it is the password of that hash; takes as long.
bool isPassword(const std::string& password, const std::string& hash);

}  // namespace metier::security
