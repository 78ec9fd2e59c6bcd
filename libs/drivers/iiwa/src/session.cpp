#include "session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <thread>
#include <utility>

#include "commands.hpp"
#include "metier/link/back_off.hpp"

namespace metier::iiwa_driver {

using std::chrono::steady_clock;

namespace {

// Length of one wait for the cabinet; shutdown() ends it at once.
constexpr auto kAcceptTimeout = std::chrono::milliseconds(500);
// Deadline for the first commands, which may take longer: the cabinet attaches tools, for example.
constexpr auto kFirstTimeout = std::chrono::seconds(2);
// Before the next cabinet is listened to after one was lost.
constexpr auto kPause = std::chrono::milliseconds(200);

}  // namespace

Session::Session(Links links, Clients clients, const IiwaOptions& options)
    : links_(std::move(links)), clients_(std::move(clients)), options_(options) {}

void Session::run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        auto link = links_.listener.accept(steady_clock::now() + kAcceptTimeout);
        if (link) {
            serve(*link, stop);
        } else if (link.error().code != Errc::timeout) {
            link::waitFor(stop, kPause);
        }
    }
}

void Session::serve(link::TcpLink& link, const std::stop_token& stop) {
    answered_ = false;
    const auto served = poll(link, stop);
    link.shutdown();
    links_.guard.release();
    guarded_ = false;
    if (served) {
        return;
    }
    const auto* hint = answered_ ? "" : " before its first state: does it use another precision?";
    clients_.commander.lost(fmt::format("{}: cabinet {}{}", clients_.commander.core().info().name,
                                        served.error().message, hint));
    clients_.signal();
    link::waitFor(stop, kPause);
}

Result<void> Session::poll(link::TcpLink& link, const std::stop_token& stop) {
    auto& commander = clients_.commander;
    METIER_ASSIGN(auto first, exchange(link, askState(), kFirstTimeout));
    answered_ = true;
    commander.connected(first, steady_clock::now());
    auto scheduled = steady_clock::now();
    while (!stop.stop_requested()) {
        METIER_TRY(keepGuard(link));
        const auto command = commander.command();
        METIER_ASSIGN(const auto answer,
                      exchange(link, command,
                               commander.settlingIn() ? kFirstTimeout : options_.answer_timeout));
        const auto now = steady_clock::now();
        clients_.force.take(answer, now);
        commander.take(command, answer, now);
        if (commander.toTell()) {
            clients_.signal();
        }
        if (commander.hurried()) {
            scheduled = now;
        } else {
            awaitCycle(scheduled);
        }
    }
    return {};
}

/// The cabinet waits for ever for the next command, and goes on with a motion meanwhile: the guard
/// has to close the connection if none comes. It begins after the first commands, which may take
/// longer than its limit.
Result<void> Session::keepGuard(link::TcpLink& link) {
    links_.guard.alive();
    if (guarded_ || clients_.commander.settlingIn()) {
        return {};
    }
    guarded_ = true;
    return links_.guard.guard(link);
}

Result<CabinetState> Session::exchange(link::TcpLink& link, const Command& command,
                                       std::chrono::nanoseconds timeout) {
    const auto deadline = steady_clock::now() + timeout;
    const auto encoded = encode(command, options_.precision);
    METIER_TRY(link.send(encoded.bytes(), deadline));
    const std::size_t expected = stateSize(options_.precision);
    std::size_t received = 0;
    while (received < expected) {
        METIER_ASSIGN(const auto count,
                      link.receive(std::span(buffer_).subspan(received), deadline));
        received += count;
    }
    const auto state = parseState(std::span(buffer_).first(received), options_.precision);
    if (!state) {
        auto error = toError(state.error());
        error.message = link.peer() + ": " + error.message;
        return fail(std::move(error));
    }
    return *state;
}

/// Waits for the next cycle. Cycles that are past are counted; the others keep their times.
void Session::awaitCycle(SteadyTime& scheduled) {
    scheduled += options_.cycle;
    const auto now = steady_clock::now();
    if (now > scheduled) {
        const auto late = (now - scheduled) / options_.cycle;
        clients_.commander.missedCycles(static_cast<std::uint64_t>(late));
        scheduled += late * options_.cycle;
        return;
    }
    std::this_thread::sleep_until(scheduled);
}

}  // namespace metier::iiwa_driver
