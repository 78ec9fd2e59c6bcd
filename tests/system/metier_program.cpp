#include "metier_program.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <unistd.h>

#include <csignal>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "metier/client/kinematics_reader.hpp"
#include "metier/client/skill_finder.hpp"
#include "metier/link/tcp_link.hpp"

namespace metier::system_tests {
namespace {

template <typename Answer>
auto orThrow(Answer answer) {
    if (!answer) {
        throw std::runtime_error(answer.error().message);
    }
    return std::move(*answer);
}

std::vector<std::string> serveArguments(const std::string& name,
                                        const std::vector<std::string>& more,
                                        const std::filesystem::path& cell) {
    std::vector<std::string> arguments{"serve", cell.string(), "--server", name};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return metierCommand(arguments);
}

}  // namespace

std::vector<std::string> metierCommand(const std::vector<std::string>& arguments) {
    std::vector<std::string> command{METIER_PROGRAM, "--insecure-lab"};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return command;
}

Finished runMetier(const std::vector<std::string>& arguments, Errors errors) {
    return runToEnd(metierCommand(arguments), errors);
}

Finished runToEnd(const std::vector<std::string>& command, Errors errors) {
    auto child = orThrow(link::ChildProcess::start(command, errors == Errors::with_output
                                                                ? link::ErrorOutput::with_output
                                                                : link::ErrorOutput::inherited));
    Finished finished;
    const auto deadline = inAMinute();
    auto line = child.readLine(deadline);
    for (; line; line = child.readLine(deadline)) {
        finished.output += *line + "\n";
    }
    const auto status = child.waitUntil(deadline);
    if (!status) {
        throw std::runtime_error(fmt::format("{} did not end; it printed:\n{}",
                                             fmt::join(command, " "), finished.output));
    }
    finished.status = *status;
    return finished;
}

std::filesystem::path demoCell() {
    return std::filesystem::path(METIER_SOURCE_DIR) / "cells" / "demo.toml";
}

std::filesystem::path simulatedCell() {
    return std::filesystem::path(METIER_SOURCE_DIR) / "tests" / "system" / "simulated.toml";
}

std::filesystem::path deviceCell(const std::string& name) {
    return std::filesystem::path(METIER_SOURCE_DIR) / "tests" / "system" / "devices" /
           (name + ".toml");
}

std::string lastingPort() {
    // Below the ports that the system hands out, of which every client and server here takes some.
    constexpr int kFirst = 12'000;
    constexpr int kPorts = 16'000;
    constexpr int kOfAProcess = 16;
    static int used = 0;
    for (int attempt = 0; attempt < kPorts; ++attempt) {
        const auto port = static_cast<std::uint16_t>(
            kFirst + (::getpid() % (kPorts / kOfAProcess) * kOfAProcess + used++) % kPorts);
        if (link::TcpListener::listen("127.0.0.1", port)) {
            return std::to_string(port);
        }
    }
    throw std::runtime_error("no free port");
}

std::string sourceText(const std::filesystem::path& file) {
    std::ifstream stream(std::filesystem::path(METIER_SOURCE_DIR) / file);
    return {std::istreambuf_iterator<char>(stream), {}};
}

ServerProcess::ServerProcess(const std::string& name, const std::vector<std::string>& more,
                             const std::filesystem::path& cell)
    : ServerProcess(serveArguments(name, more, cell)) {}

ServerProcess::ServerProcess(const std::vector<std::string>& command)
    : process_(orThrow(link::ChildProcess::start(command))) {
    const std::string ready = "ready ";
    const auto line = orThrow(process_.readLine(inAMinute()));
    if (!line.starts_with(ready)) {
        throw std::runtime_error(fmt::format("{} said: {}", fmt::join(command, " "), line));
    }
    url_ = line.substr(ready.size());
}

void ServerProcess::kill() {
    process_.signal(SIGKILL);
}

std::unique_ptr<opcua::Client> connectTo(const std::string& url) {
    opcua::ClientOptions options;
    // These only guard against hanging: the machine is busy with other tests.
    options.connect_timeout = std::chrono::seconds(60);
    options.call_timeout = std::chrono::seconds(30);
    return orThrow(opcua::Client::connect(url, options));
}

client::SkillHandle openSkill(opcua::Client& client, const std::string& name) {
    return orThrow(client::SkillHandle::open(client, orThrow(client::findSkill(client, name))));
}

std::vector<double> jointPosition(opcua::Client& client, const client::SkillHandle& skill) {
    const auto nodes = orThrow(client::findKinematics(client, skill.address()));
    return orThrow(client::readJointPosition(client, nodes));
}

void awaitMotion(opcua::Client& client, const client::SkillHandle& skill,
                 const std::vector<double>& from) {
    const auto deadline = inAMinute();
    while (jointPosition(client, skill) == from) {
        if (std::chrono::steady_clock::now() > deadline) {
            throw std::runtime_error(skill.address().name + ": the arm does not move");
        }
    }
}

}  // namespace metier::system_tests
