#include "target_process.hpp"

#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <vector>

namespace metier::hostile {

namespace {

link::ChildProcess started(const std::string& folder) {
    std::vector<std::string> command{METIER_HOSTILE_TARGET};
    if (!folder.empty()) {
        command.push_back(folder);
    }
    auto child = link::ChildProcess::start(command);
    if (!child) {
        throw std::runtime_error(child.error().message);
    }
    return std::move(*child);
}

}  // namespace

TargetProcess::TargetProcess(const std::string& folder) : process_(started(folder)) {
    const std::string ready = "ready ";
    const auto line = process_.readLine(std::chrono::steady_clock::now() + std::chrono::minutes(1));
    if (!line || !line->starts_with(ready)) {
        throw std::runtime_error("the server that was to be attacked did not start");
    }
    url_ = line->substr(ready.size());
}

std::uint16_t TargetProcess::port() const {
    return static_cast<std::uint16_t>(std::stoul(url_.substr(url_.rfind(':') + 1)));
}

std::string TargetProcess::procFolder() const {
    return fmt::format("/proc/{}", process_.pid());
}

std::size_t TargetProcess::residentKilobytes() const {
    std::ifstream status(procFolder() + "/status");
    for (std::string word; status >> word;) {
        if (word == "VmRSS:") {
            std::size_t kilobytes = 0;
            status >> kilobytes;
            return kilobytes;
        }
    }
    return 0;
}

std::size_t TargetProcess::descriptors() const {
    const std::filesystem::directory_iterator folder(procFolder() + "/fd");
    return static_cast<std::size_t>(std::distance(begin(folder), end(folder)));
}

}  // namespace metier::hostile
