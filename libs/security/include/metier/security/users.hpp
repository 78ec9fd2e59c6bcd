#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/error.hpp"

namespace metier::security {

/// Rights of a user or an application (OPC 10000-18).
enum class Role {
    /// Reads and browses.
    observer,
    /// Also commands skills.
    operator_,
    /// Also changes how the server works, and reads audit events.
    engineer,
    /// Decides which certificates are trusted, and reads audit events; commands nothing.
    security_admin,
};
/// Name of a role: "Observer", "Operator", "Engineer", "SecurityAdmin". Valid for ever. Threads:
/// any; pure.
std::string_view toString(Role role) noexcept;
/// Role by its name from toString(); nothing for another text. Threads: any; pure.
std::optional<Role> roleNamed(std::string_view name) noexcept;

/// A user of a server.
struct User {
    /// Name, of letters, digits, `.`, `-`, `_`, `@`; at most 64 characters.
    std::string name;
    /// Rights of the user.
    Role role = Role::observer;
    /// Hash of the password in the form of crypt(5): yescrypt, with its salt.
    std::string password_hash;
};

/// Users of a server, kept in a file that only its owner may read: one line for each user, with
/// name, role and password hash.
///
///     auto users = UserTable::load(file);
///     METIER_TRY(users->add("anna", Role::operator_, password));
///     METIER_TRY(users->save(file));
///
/// Threading: one thread. A running server reads the file again by itself, see LoginGuard.
class UserTable {
public:
    /// A table without users.
    UserTable() = default;
    /// Loads the file; a missing file gives a table without users.
    /// Errors: access_denied (others may read the file), invalid_argument, naming the line.
    static Result<UserTable> load(const std::filesystem::path& file);
    /// Writes the file, readable by its owner only. Waits for the disk.
    /// Errors: resource_unavailable, invalid_argument (over 64 kB).
    Result<void> save(const std::filesystem::path& file) const;

    /// All users; valid until the table changes.
    const std::vector<User>& users() const noexcept { return users_; }
    /// The user of that name, or nullptr; valid until the table changes.
    const User* find(std::string_view name) const noexcept;
    /// Adds a user; hashes the password, so it takes some ten milliseconds. save() writes it.
    /// Errors: already_exists; invalid_argument (a name of other characters than letters, digits,
    ///         `.`, `-`, `_`, `@`, or over 64; a password of less than 8 characters or over 256).
    Result<void> add(std::string name, Role role, const std::string& password);
    /// Changes a password, with a new salt.
    /// Errors: not_found; invalid_argument (the password).
    Result<void> setPassword(std::string_view name, const std::string& password);
    /// Removes a user; save() writes it. Errors: not_found.
    Result<void> remove(std::string_view name);

private:
    std::vector<User> users_;
};

/// Hashes a password with a new salt. Takes some ten milliseconds on purpose, so that nobody can
/// try many passwords.
/// Errors: internal (the system's crypt()).
Result<std::string> hashPassword(const std::string& password);
/// Reports whether `hash` was made of this password; takes as long as hashPassword().
bool isPassword(const std::string& password, const std::string& hash);

}  // namespace metier::security
