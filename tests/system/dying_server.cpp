#include "dying_server.hpp"

#include <unistd.h>

#include <array>
#include <cmath>
#include <csignal>
#include <stdexcept>

#include "metier/link/tcp_link.hpp"

namespace metier::system_tests {

namespace {

using namespace std::chrono_literals;

constexpr std::uint16_t kControlPort = 7400;

/// Loopback address that only this test's process uses; another one at each call.
std::string freeAddress() {
    static int used = 0;
    return "127." + std::to_string(100 + ++used % 100) + "." +
           std::to_string(getpid() / 250 % 250) + "." + std::to_string(1 + getpid() % 250);
}

link::ChildProcess startController(const std::string& file, const std::string& address) {
    auto controller = link::ChildProcess::start(metierCommand({"virtual", "run", file, "controller",
                                                               "--address", address}))
                          .value();
    controller.readLine(inAMinute()).value();
    return controller;
}

}  // namespace

DyingServer::DyingServer(const std::string& arm)
    : file_((std::filesystem::path(METIER_SOURCE_DIR) / "tests" / "system" / "deaths" /
             (arm + ".toml"))
                .string()),
      address_(freeAddress()),
      controller_(startController(file_, address_)),
      begun_(std::chrono::steady_clock::now()),
      server_(start("arm", {"--port", lastingPort(), "--controller", address_})),
      started_in_(std::chrono::steady_clock::now() - begun_) {}

StartedServer DyingServer::start(const std::string& server,
                                 const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"serve", file_, "--server", server};
    arguments.insert(arguments.end(), more.begin(), more.end());
    auto process =
        link::ChildProcess::start(metierCommand(arguments), link::ErrorOutput::with_output).value();
    const std::string ready = "ready ";
    std::string said;
    for (auto line = process.readLine(inAMinute()); line; line = process.readLine(inAMinute())) {
        if (line->starts_with(ready)) {
            return {std::move(process), line->substr(ready.size())};
        }
        said += *line + "\n";
    }
    throw std::runtime_error(server + " is not ready; it said:\n" + said);
}

StartedServer DyingServer::startStreamer() const {
    return start("move", {"--port", "0", "--robot", url()});
}

Finished DyingServer::runSecond(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"serve", file_, "--server", "arm", "--controller", address_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return runMetier(arguments);
}

void DyingServer::signal(int number) {
    server_.process.signal(number);
    if (number == SIGKILL && !server_.process.waitUntil(inAMinute())) {
        throw std::runtime_error("the server outlives kill -9");
    }
}

void DyingServer::startAgain() {
    const auto port = server_.url.substr(server_.url.rfind(':') + 1);
    server_ = start("arm", {"--port", port, "--controller", address_});
}

nlohmann::json DyingServer::state() const {
    auto link = link::TcpLink::connect(address_, kControlPort, inAMinute()).value();
    const std::string request = "{\"state\": true}\n";
    if (const auto sent = link.send(std::as_bytes(std::span(request)), inAMinute()); !sent) {
        throw std::runtime_error(sent.error().message);
    }
    std::string answer;
    while (answer.find('\n') == std::string::npos) {
        std::array<char, 4096> buffer{};
        const auto count =
            link.receive(std::as_writable_bytes(std::span(buffer)), inAMinute()).value();
        answer.append(buffer.data(), count);
    }
    return nlohmann::json::parse(answer);
}

bool DyingServer::awaitMotion() const {
    const auto start = state().at("joint_position").get<std::vector<double>>();
    const auto deadline = inAMinute();
    while (std::chrono::steady_clock::now() < deadline) {
        const auto now = state().at("joint_position").get<std::vector<double>>();
        for (std::size_t axis = 0; axis < now.size(); ++axis) {
            if (std::abs(now[axis] - start[axis]) > 0.01) {
                return true;
            }
        }
    }
    return false;
}

DyingServer::Rest DyingServer::awaitRest(std::chrono::milliseconds least) const {
    const auto deadline = inAMinute();
    while (std::chrono::steady_clock::now() < deadline) {
        const auto asked = std::chrono::steady_clock::now();
        const auto seen = state();
        const std::chrono::duration<double> standing(seen.at("standing_for").get<double>());
        const std::chrono::duration<double> cycle(seen.at("longest_cycle").get<double>());
        if (standing > least) {
            return {asked - std::chrono::round<std::chrono::nanoseconds>(standing),
                    std::chrono::round<std::chrono::nanoseconds>(cycle),
                    seen.at("joint_position").get<std::vector<double>>()};
        }
    }
    throw std::runtime_error("the arm still moves after a minute");
}

std::string DyingServer::awaitLogLine(const std::string& text) {
    const auto deadline = inAMinute();
    for (;;) {
        auto line = server_.process.readLine(deadline).value();
        if (line.find(text) != std::string::npos) {
            return line;
        }
    }
}

}  // namespace metier::system_tests
