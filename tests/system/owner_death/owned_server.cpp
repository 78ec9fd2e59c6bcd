#include "owned_server.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <ctime>
#include <iomanip>
#include <sstream>
#include <stdexcept>

#include "../metier_program.hpp"

namespace metier::system_tests {
namespace {

link::ChildProcess started(const std::vector<std::string>& arguments) {
    auto child =
        link::ChildProcess::start(metierCommand(arguments), link::ErrorOutput::with_output);
    if (!child) {
        throw std::runtime_error(child.error().message);
    }
    return std::move(*child);
}

/// "2026-11-21 22:47:05.962 warning ..." in local time.
std::optional<UtcTime> timeOf(const std::string& line) {
    std::tm calendar{};
    calendar.tm_isdst = -1;
    int milliseconds = 0;
    char point = 0;
    std::istringstream text(line);
    if (!(text >> std::get_time(&calendar, "%Y-%m-%d %H:%M:%S") >> point >> milliseconds)) {
        return std::nullopt;
    }
    return std::chrono::system_clock::from_time_t(std::mktime(&calendar)) +
           std::chrono::milliseconds(milliseconds);
}

}  // namespace

OwnedServer::OwnedServer(const std::vector<std::string>& arguments) : process_(started(arguments)) {
    const std::string ready = "ready ";
    std::string seen;
    for (auto line = process_.readLine(inAMinute()); line; line = process_.readLine(inAMinute())) {
        if (line->starts_with(ready)) {
            url_ = line->substr(ready.size());
            break;
        }
        seen += *line + "\n";
    }
    if (url_.empty()) {
        throw std::runtime_error("no server, it said: " + seen);
    }
    reader_ = std::jthread([this](const std::stop_token& stop) { read(stop); });
}

void OwnedServer::read(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        const auto line =
            process_.readLine(std::chrono::steady_clock::now() + std::chrono::milliseconds(100));
        if (!line && line.error().code != Errc::timeout) {
            return;
        }
        const auto time = line && line->find(" is lost: ") != std::string::npos
                              ? timeOf(*line)
                              : std::optional<UtcTime>();
        if (time) {
            losses_.tryPush(*time);
        }
    }
}

void OwnedServer::forgetLosses() {
    while (losses_.popUntil(SteadyTime{})) {
    }
}

}  // namespace metier::system_tests
