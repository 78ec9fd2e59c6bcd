#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/cell/cell.hpp"
#include "metier/device/arm.hpp"
#include "metier/device/gripper.hpp"
#include "metier/metrics/endpoint.hpp"
#include "metier/metrics/program_meter.hpp"
#include "metier/metrics/text_page.hpp"
#include "metier/opcua/server.hpp"
#include "metier/records/recorder.hpp"
#include "metier/skill/control.hpp"
#include "server_audit.hpp"

namespace metier::app {

/// Tells by HTTP what a server does: `/metrics` for Prometheus, and `/healthz`.
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
    metrics::Health health() const;
    void addSkills(metrics::TextPage& page) const;
    void addEnds(metrics::TextPage& page) const;
    void addServer(metrics::TextPage& page) const;
    void addQueues(metrics::TextPage& page) const;
    void addRecords(metrics::TextPage& page) const;
    void addDevices(metrics::TextPage& page) const;
    void addArm(metrics::TextPage& page) const;
    std::chrono::duration<double> silence() const;

    const std::string name_;
    const Watched watched_;
    std::vector<std::unique_ptr<metrics::ProgramMeter>> meters_;
    std::unique_ptr<metrics::Endpoint> endpoint_;  // ends first
};

}  // namespace metier::app
