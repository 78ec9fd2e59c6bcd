#include "host/server_records.hpp"

#include <cmath>
#include <utility>

namespace metier::server {
namespace {

records::Retention retentionOf(const cell::Records& config) {
    constexpr double kHoursPerDay = 24.0;
    constexpr double kMegabyte = 1e6;
    return {.age = std::chrono::hours(std::llround(config.keep_days * kHoursPerDay)),
            .bytes = static_cast<std::uint64_t>(config.keep_megabytes * kMegabyte)};
}

}  // namespace

Result<std::unique_ptr<ServerRecords>> ServerRecords::open(const cell::ServerConfig& config,
                                                           const std::string& server) {
    if (config.records.url.empty()) {
        return nullptr;
    }
    std::unique_ptr<ServerRecords> made(new ServerRecords(config.name));
    METIER_ASSIGN(
        made->recorder_,
        records::Recorder::create(
            {.url = config.records.url,
             .server = server,
             .keep = retentionOf(config.records),
             .on_write_state = [&alarm = made->alarm_](const records::WriteReport& report) {
                 alarm.tell(report.write_state == records::WriteState::failing
                                ? ServerAlarm::Kind::begins
                                : ServerAlarm::Kind::over,
                            report.text);
             }}));
    made->foreign_ = std::make_shared<ForeignRecords>(*made->recorder_);
    return made;
}

Result<void> ServerRecords::follow(opcua::Server& server,
                                   std::shared_ptr<skill::Executor> executor) {
    return alarm_.follow(server, std::move(executor));
}

void ServerRecords::letGo() {
    programs_.clear();
    foreign_->letGo();
    sampler_.reset();
}

void ServerRecords::record(const std::vector<skill::Program*>& programs,
                           const std::string& controller, const MovedDevice& device) {
    if (device.arm != nullptr) {
        sampler_.emplace(*device.arm, device.sensor, *recorder_);
    }
    for (auto* program : programs) {
        programs_.push_back(std::make_unique<records::ProgramRecorder>(
            *program, *recorder_, sampler_ ? &*sampler_ : nullptr,
            records::ProgramRecorder::Place{name_, controller, device.name}));
    }
}

}  // namespace metier::server
