#include "running_cell.hpp"

#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "metier_program.hpp"

namespace metier::system_tests {
namespace {

constexpr const char* kUp = "the cell is up; Ctrl-C ends it";

process::ChildProcess startUp(const std::filesystem::path& file,
                              const std::filesystem::path& endpoints) {
    return process::ChildProcess::start(metierCommand({"up", file.string(), "--free-ports",
                                                       "--endpoints", endpoints.string()}))
        .value();
}

}  // namespace

RunningCell::RunningCell(const std::filesystem::path& file)
    : endpoints_(std::filesystem::path(::testing::TempDir()) /
                 ("endpoints_" + std::to_string(getpid()) + ".json")),
      process_(startUp(file, endpoints_)) {
    for (std::string line; line != kUp;) {
        line = process_.readLine(inAMinute()).value();
    }
    std::ifstream stream(endpoints_);
    const auto endpoints = nlohmann::json::parse(stream);
    for (const auto& server : endpoints.at("servers")) {
        urls_[server.at("name")] = server.at("url");
    }
    for (const auto& controller : endpoints.at("virtual")) {
        virtual_addresses_[controller.at("name")] = controller.at("address");
    }
}

void RunningCell::inject(const std::string& controller, const std::string& fault,
                         const std::string& value) const {
    std::vector<std::string> command{"virtual", "inject", virtualAddress(controller), fault};
    if (!value.empty()) {
        command.push_back(value);
    }
    const auto injected = runMetier(command);
    if (injected.status != 0) {
        throw std::runtime_error(injected.output);
    }
}

std::string RunningCell::state(const std::string& controller) const {
    return runMetier({"virtual", "state", virtualAddress(controller)}).output;
}

std::vector<pid_t> RunningCell::childPids() const {
    const auto task = "/proc/" + std::to_string(process_.pid()) + "/task/" +
                      std::to_string(process_.pid()) + "/children";
    std::ifstream file(task);
    std::vector<pid_t> pids;
    for (pid_t pid = 0; file >> pid;) {
        pids.push_back(pid);
    }
    return pids;
}

std::vector<pollfd> RunningCell::children() const {
    std::vector<pollfd> handles;
    for (const auto pid : childPids()) {
        handles.push_back({static_cast<int>(syscall(SYS_pidfd_open, pid, 0)), POLLIN, 0});
    }
    return handles;
}

}  // namespace metier::system_tests
