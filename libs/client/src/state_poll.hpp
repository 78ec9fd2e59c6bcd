#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "program_state.hpp"

namespace metier::client {

class TransitionLog;

/// Reads the state of a skill again and again, for a server that has no subscriptions, and adds
/// each change to the log: at once after a command, every 20 ms while the skill runs, every 200 ms
/// while it rests. It ends when the connection is lost for good, which is a last doubt, and when
/// the server was started again: the nodes may be others then.
///
/// Threading: any thread; the log is written on the client's thread.
class StatePoll : public std::enable_shared_from_this<StatePoll> {
public:
    /// \param client must outlive stop()
    StatePoll(opcua::Client& client, ProgramNodes nodes, std::shared_ptr<TransitionLog> log)
        : client_(client), boot_(client.boot()), nodes_(std::move(nodes)), log_(std::move(log)) {}

    /// Begins; once.
    void begin() { hurry(); }
    /// Notes that a Start was answered: what it has begun may end before it is seen to run. Reads
    /// at once.
    void noteStart();
    /// Reads at once: a command was answered.
    void hurry();
    /// Ends it: nothing is added to the log any more. Waits at most 5 s for a callback of the log
    /// that runs; may be called in such a callback.
    void stop();

private:
    // The client's thread.
    void ask();
    void askAfter(std::chrono::milliseconds pause);
    void answered(const opcua::Answer<std::vector<opcua::DataValue>>& values, std::uint64_t starts);
    void take(const ProgramNow& now, UtcTime time, std::uint64_t starts);
    /// Runs `work`, which writes the log, unless this was stopped.
    void call(const std::function<void()>& work);
    bool isOver() const;

    opcua::Client& client_;
    const std::uint64_t boot_;
    const ProgramNodes nodes_;
    const std::shared_ptr<TransitionLog> log_;
    std::atomic<bool> stopped_ = false;
    // Held while the log calls back; by this thread.
    std::timed_mutex calling_;
    std::atomic<std::thread::id> caller_{};
    // The client's thread.
    std::optional<skill::State> state_;
    std::uint64_t starts_ = 0;  // that were answered
    std::uint64_t ended_ = 0;   // starts whose end was seen
    std::uint64_t turn_ = 0;    // the newest read; earlier ones are not followed by another
    bool lost_ = false;
};

/// A StatePoll that ends with its owner; or none.
class StatePolling {
public:
    StatePolling() = default;
    explicit StatePolling(std::shared_ptr<StatePoll> poll) : poll_(std::move(poll)) {
        poll_->begin();
    }
    ~StatePolling() {
        if (poll_) {
            poll_->stop();
        }
    }
    StatePolling(StatePolling&& other) noexcept : poll_(std::move(other.poll_)) {}
    StatePolling& operator=(StatePolling&& other) noexcept {
        std::swap(poll_, other.poll_);
        return *this;
    }

    /// Null: none. Shared with the answers that are on their way.
    const std::shared_ptr<StatePoll>& poll() const noexcept { return poll_; }

private:
    std::shared_ptr<StatePoll> poll_;
};

}  // namespace metier::client
