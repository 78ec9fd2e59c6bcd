#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "host/server_audit.hpp"
#include "metier/base/error.hpp"
#include "metier/cell/cell.hpp"
#include "metier/device/arm.hpp"
#include "metier/device/gripper.hpp"
#include "metier/opcua/server.hpp"
#include "metier/records/recorder.hpp"
#include "metier/skill/control.hpp"
#include "metrics/endpoint.hpp"
#include "metrics/program_meter.hpp"
#include "metrics/text_page.hpp"

namespace metier::server {

/// Publishes by HTTP what a server does: `/metrics` for Prometheus, and `/healthz`.
///
/// Nothing there waits for the server's thread, so that it answers also while that hangs.
/// Threading: made before the server's start, and ended once it is stopped, by one thread.
class ServerMetrics {
public:
    /// All but `server` and `control` may be missing; all must outlive the metrics.
    struct Watched {
        const opcua::Server& server;
        const skill::Control& control;
        std::vector<skill::Program*> programs{};
        const device::Arm* arm = nullptr;
        const device::Gripper* gripper = nullptr;
        const records::Recorder* recorder = nullptr;
        const ServerAudit* audit = nullptr;
    };

    /// Errors: resource_unavailable (the address is taken).
    static Result<std::unique_ptr<ServerMetrics>> start(const cell::ServerConfig& config,
                                                        Watched watched);
    ServerMetrics(const ServerMetrics&) = delete;
    ServerMetrics& operator=(const ServerMetrics&) = delete;

private:
    ServerMetrics(const cell::ServerConfig& config, Watched watched);

    // Threads of the endpoint.
    std::string page() const;
    ServerHealth health() const;
    /// A counter of each skill.
    void addEach(TextPage& page, std::string_view name, std::string_view help,
                 std::uint64_t (ProgramMeter::*count)() const noexcept) const;
    void addSkills(TextPage& page) const;
    void addEnds(TextPage& page) const;
    void addServer(TextPage& page) const;
    void addQueues(TextPage& page) const;
    void addRecords(TextPage& page) const;
    void addDevices(TextPage& page) const;
    void addArm(TextPage& page) const;
    std::chrono::duration<double> silence() const;

    const std::string name_;
    const Watched watched_;
    std::vector<std::unique_ptr<ProgramMeter>> meters_;
    std::unique_ptr<MetricsEndpoint> endpoint_;  // ends first
};

}  // namespace metier::server
