#include "installation.hpp"

#include <gtest/gtest.h>

#include "metier/security/security_folder.hpp"

namespace metier::system_tests {

Installation::Installation(const std::string& name)
    : folder_(std::filesystem::path(::testing::TempDir()) / "installations" /
              ::testing::UnitTest::GetInstance()->current_test_info()->name() / name) {
    std::filesystem::remove_all(folder_);
}

std::vector<std::string> Installation::command(const std::vector<std::string>& arguments) const {
    std::vector<std::string> command{METIER_PROGRAM, "--security", folder_.string()};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return command;
}

Finished Installation::run(const std::vector<std::string>& arguments,
                           const std::string& password) const {
    auto line = command(arguments);
    if (!password.empty()) {
        line.insert(line.begin(), {"env", "METIER_PASSWORD=" + password});
    }
    return runToEnd(line);
}

ServerProcess Installation::serve(const std::string& server, const std::string& port) const {
    return ServerProcess(
        command({"serve", simulatedCell().string(), "--server", server, "--port", port}));
}

opcua::ClientOptions Installation::asCommand() const {
    auto folder = security::SecurityFolder::open(folder_).value();
    auto identity = folder.identity("command",
                                    {.application_name = "metier command",
                                     .application_uri = "urn:test:metier:command",
                                     .hosts = {"localhost"}},
                                    std::chrono::system_clock::now());
    opcua::ClientOptions options;
    options.security = opcua::Credentials{identity.value(), folder.trustFolder()};
    return options;
}

std::string Installation::thumbprintOf(const std::string& application) const {
    const auto folder = security::SecurityFolder::open(folder_).value();
    return security::loadIdentity(folder.identityFolder(application))
        .value()
        .certificate.thumbprint();
}

}  // namespace metier::system_tests
