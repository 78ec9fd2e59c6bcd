#include "metrics/process_figures.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace metier::server {
namespace {

// Time when this library was loaded, with the program.
const auto kStart = std::chrono::system_clock::now();

double secondsOf(const timeval& time) {
    constexpr double kMicrosecond = 1e-6;
    return static_cast<double>(time.tv_sec) + kMicrosecond * static_cast<double>(time.tv_usec);
}

std::uint64_t residentBytes() {
    std::ifstream statm("/proc/self/statm");
    std::uint64_t total = 0;
    std::uint64_t resident = 0;
    statm >> total >> resident;
    return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

std::uint64_t openFiles() {
    std::error_code error;
    const std::filesystem::directory_iterator files("/proc/self/fd", error);
    return error ? 0 : static_cast<std::uint64_t>(std::distance(begin(files), end(files)));
}

}  // namespace

void addProcess(TextPage& page) {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    page.family("process_cpu_seconds_total", MetricKind::counter, "CPU time of the process.");
    page.add({}, secondsOf(usage.ru_utime) + secondsOf(usage.ru_stime));
    page.family("process_resident_memory_bytes", MetricKind::gauge, "Memory of the process.");
    page.add({}, residentBytes());
    page.family("process_open_fds", MetricKind::gauge, "Open files and sockets.");
    page.add({}, openFiles());
    page.family("process_start_time_seconds", MetricKind::gauge, "Since 1970-01-01 UTC.");
    page.add({}, std::chrono::duration<double>(kStart.time_since_epoch()).count());
}

}  // namespace metier::server
