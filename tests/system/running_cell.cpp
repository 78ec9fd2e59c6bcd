#include "running_cell.hpp"

#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <fstream>
#include <span>
#include <stdexcept>
#include <system_error>

#include "metier/link/tcp_link.hpp"
#include "metier_program.hpp"

namespace metier::system_tests {
namespace {

constexpr const char* kUp = "the cell is up; Ctrl-C ends it";

link::ChildProcess startUp(const std::filesystem::path& file,
                           const std::filesystem::path& endpoints,
                           const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"up", file.string(), "--free-ports", "--endpoints",
                                       endpoints.string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return link::ChildProcess::start(metierCommand(arguments)).value();
}

/// One line for one line, without a process for each.
nlohmann::json askControlPort(const std::string& address, const nlohmann::json& request) {
    constexpr std::uint16_t kControlPort = 7400;
    const auto deadline = inAMinute();
    auto link = link::TcpLink::connect(address, kControlPort, deadline).value();
    const auto line = request.dump() + "\n";
    std::string answer;
    const auto sent = link.send(std::as_bytes(std::span(line)), deadline);
    while (sent && !answer.ends_with('\n')) {
        std::array<char, 4096> buffer{};
        const auto count = link.receive(std::as_writable_bytes(std::span(buffer)), deadline);
        answer.append(buffer.data(), count.value());
    }
    return nlohmann::json::parse(answer);
}

}  // namespace

RunningCell::RunningCell(const std::filesystem::path& file, const std::vector<std::string>& more)
    : endpoints_(std::filesystem::temp_directory_path() /
                 ("endpoints_" + std::to_string(getpid()) + ".json")),
      process_(startUp(file, endpoints_, more)) {
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

RunningCell::~RunningCell() {
    std::error_code error;
    std::filesystem::remove(endpoints_, error);
}

void RunningCell::inject(const std::string& controller, const std::string& fault,
                         const std::string& value) const {
    const auto answer =
        askControlPort(virtualAddress(controller), {{"inject", fault}, {"value", value}});
    if (answer.contains("error")) {
        throw std::runtime_error(answer.at("error").get<std::string>());
    }
}

nlohmann::json RunningCell::state(const std::string& controller) const {
    return askControlPort(virtualAddress(controller), {{"state", true}});
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
