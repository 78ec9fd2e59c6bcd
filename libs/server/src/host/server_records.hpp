#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/server_alarm.hpp"
#include "metier/base/error.hpp"
#include "metier/cell/cell.hpp"
#include "metier/device/arm.hpp"
#include "metier/device/force_torque_sensor.hpp"
#include "metier/opcua/server.hpp"
#include "metier/records/path_sampler.hpp"
#include "metier/records/program_recorder.hpp"
#include "metier/records/recorder.hpp"
#include "metier/server/foreign_records.hpp"

namespace metier::server {

/// Device that the Programs of a server move; each part may be missing.
struct MovedDevice {
    const device::Arm* arm = nullptr;
    const device::ForceTorqueSensor* sensor = nullptr;
    std::string name{};
};

/// Records every execution of a server's Programs, and says when that does not work: in the
/// program's log, and by an event of the Server object.
///
/// Threading: made, followed and ended as its server. It lets go of its Programs and their device
/// before these end, once the server is stopped, and ends before the server; its end waits for what
/// is still to be written.
class ServerRecords {
public:
    /// \param server ApplicationUri
    /// \return null if nothing is to be recorded
    /// Errors: invalid_argument (the URL).
    static Result<std::unique_ptr<ServerRecords>> open(const cell::ServerConfig& config,
                                                       const std::string& server);
    ServerRecords(const ServerRecords&) = delete;
    ServerRecords& operator=(const ServerRecords&) = delete;

    /// Raises the events at that server. Before its start.
    Result<void> follow(opcua::Server& server, std::shared_ptr<skill::Executor> executor);
    /// Records what these do. Before the server's start; once.
    void record(const std::vector<skill::Program*>& programs, const std::string& controller,
                const MovedDevice& device);

    /// Records of executions that this server starts at others; shared by its used skills.
    const std::shared_ptr<ForeignRecords>& foreign() const noexcept { return foreign_; }

    /// The Programs are about to end: what is under way is over. Waits for nothing.
    void letGo();

    const records::Recorder& recorder() const noexcept { return *recorder_; }

private:
    explicit ServerRecords(const std::string& name) : name_(name), alarm_(name, "Records") {}

    const std::string name_;
    ServerAlarm alarm_;
    std::unique_ptr<records::Recorder> recorder_;
    std::shared_ptr<ForeignRecords> foreign_;  // shared with used skills
    std::optional<records::PathSampler> sampler_;
    std::vector<std::unique_ptr<records::ProgramRecorder>> programs_;
};

}  // namespace metier::server
