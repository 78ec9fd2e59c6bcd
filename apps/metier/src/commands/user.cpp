#include <fmt/format.h>

#include <memory>
#include <string>

#include "command_context.hpp"
#include "metier/security/users.hpp"

namespace metier::app {
namespace {

using security::UserTable;

struct UserOptions {
    std::string name;
    std::string role = "Operator";
};

Result<void> listUsers(UserTable& users, const UserOptions& /*options*/) {
    for (const auto& user : users.users()) {
        fmt::print("{:<24} {}\n", user.name, security::toString(user.role));
    }
    return {};
}

Result<void> add(UserTable& users, const UserOptions& options) {
    METIER_ASSIGN(const auto password, readPassword(options.name));
    const auto role = security::roleNamed(options.role).value_or(security::Role::observer);
    return users.add(options.name, role, password);
}

Result<void> setPassword(UserTable& users, const UserOptions& options) {
    if (users.find(options.name) == nullptr) {
        return fail(Errc::not_found, fmt::format("no user '{}'", options.name));
    }
    METIER_ASSIGN(const auto password, readPassword(options.name));
    return users.setPassword(options.name, password);
}

Result<void> remove(UserTable& users, const UserOptions& options) {
    return users.remove(options.name);
}

using UserAction = Result<void> (*)(UserTable&, const UserOptions&);

Result<Exit> act(UserAction action, const UserOptions& options, const server::Security& security) {
    METIER_ASSIGN(const auto folder, security.openFolder());
    METIER_ASSIGN(auto users, UserTable::load(folder.usersFile()));
    METIER_TRY(action(users, options));
    METIER_TRY(action == &listUsers ? Result<void>() : users.save(folder.usersFile()));
    return Exit::success;
}

}  // namespace

void addUser(CLI::App& app, CommandContext& context) {
    // Shared by CLI11, which fills it, and the callbacks, which read it.
    auto options = std::make_shared<UserOptions>();
    auto* command = app.add_subcommand("user", "Decide who may log in, and as what");
    command->require_subcommand(1);
    const auto addAction = [&](const char* name, const char* about, UserAction action) {
        auto* one = command->add_subcommand(name, about);
        one->callback([options, action, &context] {
            context.exit = exitOf(act(action, *options, context.security));
        });
        return one;
    };
    addAction("list", "Everybody who may log in", &listUsers);
    auto* adding = addAction("add", "Let somebody log in; asks for a password", &add);
    adding->add_option("name", options->name, "Who it is")->required();
    adding
        ->add_option("--role", options->role,
                     "Observer reads; Operator and Engineer also command; SecurityAdmin reads, and "
                     "decides whom to trust")
        ->check(CLI::IsMember({"Observer", "Operator", "Engineer", "SecurityAdmin"}))
        ->capture_default_str();
    addAction("password", "Give somebody another password", &setPassword)
        ->add_option("name", options->name, "Who it is")
        ->required();
    addAction("remove", "Let somebody log in no longer; open sessions are closed", &remove)
        ->add_option("name", options->name, "Who it is")
        ->required();
}

}  // namespace metier::app
