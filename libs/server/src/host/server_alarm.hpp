#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "metier/base/error.hpp"
#include "metier/opcua/event_emitter.hpp"
#include "metier/opcua/server.hpp"
#include "metier/skill/executor.hpp"

namespace metier::server {

/// Reports that something does not work any more, and that it works again: in the program's log,
/// and by an event of the Server object once the server serves.
///
/// Threading: made, followed and ended as its server, and ends before it; tell() from any thread.
class ServerAlarm {
public:
    enum class Kind {
        begins,  ///< Severity 800
        over,    ///< Severity 100
    };

    /// \param name   of the server, for the log
    /// \param source SourceName of the events
    ServerAlarm(std::string name, std::string source)
        : name_(std::move(name)), source_(std::move(source)) {}
    ServerAlarm(const ServerAlarm&) = delete;
    ServerAlarm& operator=(const ServerAlarm&) = delete;

    /// Raises the events at that server. Before its start.
    Result<void> follow(opcua::Server& server, std::shared_ptr<skill::Executor> executor);
    void tell(Kind kind, const std::string& text);

private:
    void raise(Kind kind, const std::string& text);

    const std::string name_;
    const std::string source_;
    std::optional<opcua::EventEmitter> emitter_;
    std::mutex mutex_;
    // Runs on the server's thread; shared with its Programs.
    std::shared_ptr<skill::Executor> executor_;
};

}  // namespace metier::server
