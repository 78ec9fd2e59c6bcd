#include "server_process.hpp"

#include <fmt/format.h>
#include <sched.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace metier::benchmarks {
namespace {

using namespace std::chrono_literals;

/// Report of the child once it serves.
struct Report {
    std::array<char, 128> url;
    double seconds;
    double bytes;
};

struct Pipe {
    int read_end = -1;
    int write_end = -1;
};

Pipe makePipe() {
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) {
        throw std::runtime_error(std::strerror(errno));
    }
    return {ends[0], ends[1]};
}

double residentBytes() {
    std::ifstream file("/proc/self/statm");
    double all = 0;
    double resident = 0;
    file >> all >> resident;
    return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

Served serveAndReport(const std::function<Served()>& serve, int output) {
    const double before = residentBytes();
    const auto begin = std::chrono::steady_clock::now();
    auto served = serve();
    Report report{};
    report.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    report.bytes = residentBytes() - before;
    served.url.copy(report.url.data(), report.url.size() - 1);
    if (write(output, &report, sizeof report) != sizeof report) {
        throw std::runtime_error(std::strerror(errno));
    }
    return served;
}

/// The child's whole life: it serves until the other end of `control` is closed.
[[noreturn]] void live(const std::function<Served()>& serve, int output, int control) {
    try {
        const auto served = serveAndReport(serve, output);
        char nothing = 0;
        static_cast<void>(read(control, &nothing, 1));
    } catch (const std::exception& error) {
        fmt::print(stderr, "server: {}\n", error.what());
        _exit(EXIT_FAILURE);
    }
    _exit(EXIT_SUCCESS);
}

std::vector<std::filesystem::path> tasksOf(pid_t process) {
    std::vector<std::filesystem::path> tasks;
    for (const auto& task :
         std::filesystem::directory_iterator(fmt::format("/proc/{}/task", process))) {
        tasks.push_back(task.path());
    }
    return tasks;
}

std::chrono::nanoseconds cpuTimeOf(const std::filesystem::path& task) {
    std::ifstream file(task / "schedstat");
    std::int64_t nanoseconds = 0;
    file >> nanoseconds;
    return std::chrono::nanoseconds(nanoseconds);
}

/// Scheduling policy: field 41 of proc(5), the 39th after the name in brackets.
int policyOf(const std::filesystem::path& task) {
    std::ifstream file(task / "stat");
    std::string text;
    std::getline(file, text);
    std::istringstream fields(text.substr(text.rfind(')') + 1));
    std::string field;
    for (int i = 0; i < 39; ++i) {
        fields >> field;
    }
    return std::atoi(field.c_str());
}

}  // namespace

ServerProcess::ServerProcess(const std::function<Served()>& serve) {
    const auto output = makePipe();
    const auto control = makePipe();
    pid_ = fork();
    if (pid_ == 0) {
        close(output.read_end);
        close(control.write_end);
        live(serve, output.write_end, control.read_end);
    }
    close(output.write_end);
    close(control.read_end);
    control_ = control.write_end;
    Report report{};
    const auto got = read(output.read_end, &report, sizeof report);
    close(output.read_end);
    if (pid_ < 0 || got != sizeof report) {
        throw std::runtime_error("the server's process did not begin to serve");
    }
    url_ = report.url.data();
    start_time_ = std::chrono::duration<double>(report.seconds);
    memory_ = report.bytes;
}

ServerProcess::~ServerProcess() {
    close(control_);
    waitpid(pid_, nullptr, 0);
}

std::chrono::nanoseconds ServerProcess::cpuTime() const {
    clockid_t clock{};
    timespec time{};
    if (clock_getcpuclockid(pid_, &clock) != 0 || clock_gettime(clock, &time) != 0) {
        throw std::runtime_error("the CPU time of the server's process cannot be read");
    }
    return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

std::chrono::nanoseconds ServerProcess::busiestThreadTime() const {
    std::chrono::nanoseconds most{0};
    for (const auto& task : tasksOf(pid_)) {
        most = std::max(most, cpuTimeOf(task));
    }
    return most;
}

std::chrono::nanoseconds ServerProcess::yieldingThreadsTime() const {
    std::chrono::nanoseconds sum{0};
    for (const auto& task : tasksOf(pid_)) {
        sum += policyOf(task) == SCHED_BATCH ? cpuTimeOf(task) : 0ns;
    }
    return sum;
}

}  // namespace metier::benchmarks
