#include "metrics/server_metrics.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

namespace metier::server {
namespace {

using device::SafetyState;

// A thread that has nothing to do shows itself every 100 ms.
constexpr std::chrono::duration<double> kLongestSilence{1.0};

constexpr std::array kStates{skill::State::halted, skill::State::ready, skill::State::running,
                             skill::State::suspended};
constexpr std::array kReasons{skill::Reason::by_client,      skill::Reason::error,
                              skill::Reason::force_exceeded, skill::Reason::owner_lost,
                              skill::Reason::device_lost,    skill::Reason::limit_violated};
constexpr std::array kMethods{skill::Method::start,   skill::Method::start_with,
                              skill::Method::suspend, skill::Method::resume,
                              skill::Method::halt,    skill::Method::reset};
constexpr std::array kSafety{SafetyState::normal, SafetyState::protective_stop,
                             SafetyState::emergency_stop, SafetyState::fault,
                             SafetyState::disconnected};

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

/// Adds what the kernel knows of this process, by the names that Prometheus has for it.
void addProcess(TextPage& page) {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    page.figure("process_cpu_seconds_total", MetricKind::counter, "CPU time of the process.",
                secondsOf(usage.ru_utime) + secondsOf(usage.ru_stime));
    page.figure("process_resident_memory_bytes", MetricKind::gauge, "Memory of the process.",
                residentBytes());
    page.figure("process_open_fds", MetricKind::gauge, "Open files and sockets.", openFiles());
    page.figure("process_start_time_seconds", MetricKind::gauge, "Since 1970-01-01 UTC.",
                std::chrono::duration<double>(kStart.time_since_epoch()).count());
}

template <typename Name>
std::string textOf(Name name) {
    return std::string(toString(name));
}

void addDevice(TextPage& page, const std::string& name, SafetyState now) {
    for (const auto state : kSafety) {
        page.add({{"device", name}, {"state", textOf(state)}}, std::uint64_t{state == now});
    }
}

}  // namespace

Result<std::unique_ptr<ServerMetrics>> ServerMetrics::start(const cell::ServerConfig& config,
                                                            Watched watched) {
    std::unique_ptr<ServerMetrics> made(new ServerMetrics(config, std::move(watched)));
    METIER_ASSIGN(made->endpoint_,
                  MetricsEndpoint::start({.address = config.metrics->host,
                                          .port = config.metrics->port,
                                          .metrics = [&told = *made] { return told.page(); },
                                          .health = [&told = *made] { return told.health(); }}));
    spdlog::info("{}: figures at http://{}:{}/metrics", config.name, config.metrics->host,
                 made->endpoint_->port());
    return made;
}

ServerMetrics::ServerMetrics(const cell::ServerConfig& config, Watched watched)
    : name_(config.name), watched_(std::move(watched)) {
    for (auto* program : watched_.programs) {
        meters_.push_back(std::make_unique<ProgramMeter>(*program));
    }
}

std::chrono::duration<double> ServerMetrics::silence() const {
    return std::chrono::steady_clock::now() - watched_.server.lastTick();
}

ServerHealth ServerMetrics::health() const {
    if (watched_.server.port() == 0) {
        return {false, name_ + ": the server is not started yet"};
    }
    if (silence() > kLongestSilence) {
        return {false, fmt::format("{}: the server's thread has not worked for {:.1f} s", name_,
                                   silence().count())};
    }
    if (watched_.arm != nullptr && watched_.arm->state().safety == SafetyState::disconnected) {
        return {false, fmt::format("{}: the controller of {} is not connected", name_,
                                   watched_.arm->info().name)};
    }
    if (watched_.gripper != nullptr &&
        watched_.gripper->state().safety == SafetyState::disconnected) {
        return {false, fmt::format("{}: the gripper {} is not connected", name_,
                                   watched_.gripper->info().name)};
    }
    const bool failing = watched_.recorder != nullptr &&
                         watched_.recorder->status().write_state == records::WriteState::failing;
    return {true, failing ? "ok, but nothing can be recorded" : "ok"};
}

std::string ServerMetrics::page() const {
    TextPage page;
    page.family("metier_build_info", MetricKind::gauge, "What serves; always 1.");
    page.add({{"server", name_}, {"version", METIER_VERSION}}, std::uint64_t{1});
    addSkills(page);
    addEnds(page);
    addServer(page);
    addQueues(page);
    addRecords(page);
    addDevices(page);
    addProcess(page);
    return page.text();
}

void ServerMetrics::addEach(TextPage& page, std::string_view name, std::string_view help,
                            std::uint64_t (ProgramMeter::*count)() const noexcept) const {
    page.family(name, MetricKind::counter, help);
    for (const auto& meter : meters_) {
        page.add({{"skill", meter->skill()}}, ((*meter).*count)());
    }
}

void ServerMetrics::addSkills(TextPage& page) const {
    page.family("metier_skill_state", MetricKind::gauge,
                "1 for the state that a skill is in, else 0.");
    for (const auto& meter : meters_) {
        for (const auto state : kStates) {
            page.add({{"skill", meter->skill()}, {"state", textOf(state)}},
                     std::uint64_t{meter->state() == state});
        }
    }
    addEach(page, "metier_skill_starts_total", "Executions that began.", &ProgramMeter::starts);
    addEach(page, "metier_skill_suspends_total", "How often one was suspended.",
            &ProgramMeter::suspends);
    page.family("metier_skill_refusals_total", MetricKind::counter,
                "Calls of a method that were refused.");
    for (const auto& meter : meters_) {
        for (const auto method : kMethods) {
            page.add({{"skill", meter->skill()}, {"method", textOf(method)}},
                     meter->refusals(method));
        }
    }
}

void ServerMetrics::addEnds(TextPage& page) const {
    addEach(page, "metier_skill_finished_total", "Executions that finished.",
            &ProgramMeter::finished);
    page.family("metier_skill_halts_total", MetricKind::counter,
                "Executions that were Halted, by reason.");
    for (const auto& meter : meters_) {
        for (const auto reason : kReasons) {
            page.add({{"skill", meter->skill()}, {"reason", textOf(reason)}}, meter->halts(reason));
        }
    }
    page.family("metier_skill_duration_seconds", MetricKind::histogram,
                "From Running to the end of an execution, however it was.");
    for (const auto& meter : meters_) {
        page.add({{"skill", meter->skill()}}, meter->durations().read());
    }
}

void ServerMetrics::addServer(TextPage& page) const {
    const auto now = watched_.server.statistics();
    page.figure("metier_server_silence_seconds", MetricKind::gauge,
                "Since the server's thread was last seen working.", silence().count());
    page.figure("metier_connections", MetricKind::gauge, "Open TCP connections.",
                std::uint64_t{now.connections});
    page.figure("metier_sessions", MetricKind::gauge, "OPC UA sessions.",
                std::uint64_t{now.sessions});
    page.figure("metier_connections_refused_total", MetricKind::counter,
                "Connections beyond what the limits allow.", now.refused_connections);
    page.figure("metier_peers_cut_total", MetricKind::counter,
                "Connections that were closed because their peer did not read.", now.cut_peers);
    page.figure("metier_publish_latency_seconds", MetricKind::histogram,
                "From an event until it was handed to the socket, for each Subscription.",
                watched_.server.publishLatency().read());
    page.figure("metier_lease_losses_total", MetricKind::counter,
                "Leases that ended without being given back.", watched_.control.losses());
}

void ServerMetrics::addQueues(TextPage& page) const {
    const auto now = watched_.server.statistics();
    page.family("metier_queue_length", MetricKind::gauge, "What waits in a queue.");
    page.add({{"queue", "server_thread"}}, std::uint64_t{now.waiting_work});
    if (watched_.audit != nullptr) {
        page.add({{"queue", "audit"}}, std::uint64_t{watched_.audit->waiting()});
    }
    if (watched_.recorder != nullptr) {
        const auto status = watched_.recorder->status();
        page.add({{"queue", "records"}}, std::uint64_t{status.waiting});
        page.add({{"queue", "record_samples"}}, std::uint64_t{status.waiting_samples});
    }
    page.figure("metier_send_queue_bytes", MetricKind::gauge, "What waits for peers to read it.",
                std::uint64_t{now.queued_bytes});
}

void ServerMetrics::addRecords(TextPage& page) const {
    if (watched_.recorder == nullptr) {
        return;
    }
    const auto status = watched_.recorder->status();
    page.figure("metier_records_failing", MetricKind::gauge, "1 while nothing can be recorded.",
                std::uint64_t{status.write_state == records::WriteState::failing});
    page.figure("metier_records_written_total", MetricKind::counter,
                "Executions that were recorded.", status.written);
    page.family("metier_records_dropped_total", MetricKind::counter, "What could not be recorded.");
    page.add({{"kind", "execution"}}, status.dropped.executions);
    page.add({{"kind", "event"}}, status.dropped.events);
    page.add({{"kind", "sample"}}, status.dropped.samples);
}

void ServerMetrics::addDevices(TextPage& page) const {
    const auto* const arm = watched_.arm;
    const auto* const gripper = watched_.gripper;
    if (arm == nullptr && gripper == nullptr) {
        return;
    }
    page.family("metier_device_state", MetricKind::gauge,
                "1 for the safety state of a device, else 0.");
    if (arm != nullptr) {
        addDevice(page, arm->info().name, arm->state().safety);
    }
    if (gripper != nullptr) {
        addDevice(page, gripper->info().name, gripper->state().safety);
    }
    if (arm != nullptr) {
        addArm(page);
    }
}

void ServerMetrics::addArm(TextPage& page) const {
    const auto& arm = *watched_.arm;
    const Labels labels{{"device", arm.info().name}};
    const auto state = arm.state();
    page.family("metier_cycles_total", MetricKind::counter,
                "Cycles of a controller since it connected.");
    page.add(labels, state.cycle);
    page.family("metier_missed_cycles_total", MetricKind::counter,
                "Of these, run later than one whole period.");
    page.add(labels, state.missed_cycles);
    if (const auto* jitter = arm.cycleJitter()) {
        page.family("metier_cycle_jitter_seconds", MetricKind::histogram,
                    "How far the time from one cycle to the next was off the period.");
        page.add(labels, jitter->read());
    }
}

}  // namespace metier::server
