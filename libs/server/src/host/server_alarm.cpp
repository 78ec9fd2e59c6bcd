#include "host/server_alarm.hpp"

#include <spdlog/spdlog.h>

#include <utility>

namespace metier::server {
namespace {

constexpr std::uint16_t kAlarm = 800;
constexpr std::uint16_t kOver = 100;

}  // namespace

Result<void> ServerAlarm::follow(opcua::Server& server, std::shared_ptr<skill::Executor> executor) {
    METIER_ASSIGN(emitter_, opcua::EventEmitter::create(server, opcua::ids::kSystemEventType, {}));
    const std::lock_guard lock(mutex_);
    executor_ = std::move(executor);
    return {};
}

void ServerAlarm::tell(Kind kind, const std::string& text) {
    spdlog::log(kind == Kind::begins ? spdlog::level::err : spdlog::level::warn, "{}: {}", name_,
                text);
    std::shared_ptr<skill::Executor> executor;
    {
        const std::lock_guard lock(mutex_);
        executor = executor_;
    }
    if (executor) {
        executor->post([this, kind, text] { raise(kind, text); });
    }
}

void ServerAlarm::raise(Kind kind, const std::string& text) {
    const auto raised = emitter_->emit({.source = opcua::ids::kServer,
                                        .source_name = source_,
                                        .time = std::chrono::system_clock::now(),
                                        .severity = kind == Kind::begins ? kAlarm : kOver,
                                        .message = {"en", text},
                                        .fields = {}});
    if (!raised) {
        spdlog::error("{}: no event: {}", name_, raised.error().message);
    }
}

}  // namespace metier::server
