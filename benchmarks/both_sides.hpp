#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "metier/opcua_skill/skill_server.hpp"
#include "server_process.hpp"

namespace metier::benchmarks {

class RecordingSwitch;

/// One client of one side, as far as the benchmarks need it.
///
/// Threading: one thread.
class Caller {
public:
    virtual ~Caller() = default;
    /// The call whose time is compared: metier's Start, or a bare method that does nothing.
    virtual void call() = 0;
    /// Starts an execution that ends at once: two events.
    virtual void start() = 0;
    /// Subscribes to the events of what start() starts.
    virtual void subscribe() = 0;
    /// Starts an execution; returns the time until this client's subscription reported Running.
    virtual std::chrono::nanoseconds startUntilRunning() = 0;
    /// Keeps the connection alive without a call.
    virtual void idleUntil(std::chrono::steady_clock::time_point end) = 0;
};

/// metier, or open62541 alone.
struct Side {
    /// A server with one Program to start and `idle` others.
    std::function<Served(std::size_t idle)> serve;
    std::function<std::unique_ptr<Caller>(const std::string& url)> connect;
};

inline constexpr std::chrono::milliseconds kPublishingInterval{100};

/// Errors of the functions that they hold: exceptions.
Side metierSide(opcua_skill::NodeStyle style = opcua_skill::NodeStyle::readable);
/// The same, which records every execution while `recording`, which must outlive it, is on.
/// \param work time that an execution keeps the server's thread busy
Side recordingSide(const RecordingSwitch& recording, std::chrono::microseconds work);
Side bareSide();
/// metier's server with open62541 alone as its client; can only call().
Side metierServerBareClient();

}  // namespace metier::benchmarks
