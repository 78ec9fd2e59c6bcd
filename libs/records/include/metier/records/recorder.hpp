#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/records/execution_row.hpp"
#include "metier/records/store.hpp"

namespace metier::records {

/// Number of records that were lost.
struct Dropped {
    std::uint64_t executions = 0;
    std::uint64_t events = 0;  ///< transitions and intermediate results
    std::uint64_t samples = 0;

    std::uint64_t sum() const noexcept { return executions + events + samples; }
    Dropped& operator+=(const Dropped& more) noexcept {
        executions += more.executions;
        events += more.events;
        samples += more.samples;
        return *this;
    }
    friend bool operator==(const Dropped&, const Dropped&) = default;
};

/// Whether records are written.
enum class WriteState {
    writing,
    failing,  ///< nothing can be written, or writing takes too long: records are lost or may be
};

/// Report for the server's clients: sent once when recording fails, and once when it works again.
struct WriteReport {
    WriteState write_state = WriteState::writing;
    std::string text{};  ///< for a person: the reason and what was lost, "records work again: ..."
    Dropped dropped{};   ///< since the recorder was made
};

/// Records the executions of one server. Every call returns at once, whatever the disk does.
///
/// A thread of its own writes rows, at least every 500 ms: a crash of the server loses at most the
/// last second. While the store cannot be opened or written, or is too slow, records wait in a
/// queue of a fixed size. When it is full, new executions and events are dropped, and the oldest
/// samples. An end is never dropped if its begin was not. Executions of servers that died are
/// closed as kLost when this opens the store, and every hour. The store is trimmed to its retention
/// at the start and then every hour.
///
/// Threads: any, but no cycle thread (allocates, locks for a moment).
class Recorder {
public:
    /// Key of one execution in this recorder; 0: it was dropped, and so is all that belongs to it.
    using Key = std::uint64_t;

    struct Options {
        std::string url{};     ///< as Store::open() takes it
        std::string server{};  ///< ApplicationUri; no other recorder uses it
        Retention keep{};
        /// Called on a thread of the recorder, at each change between writing and failing. May be
        /// empty.
        std::function<void(const WriteReport&)> on_write_state{};
        std::size_t most_waiting = 50'000'000;      ///< executions and events [byte]
        std::size_t most_waiting_samples = 16'384;  ///< about 230 byte each
        /// Longest time without a write, since the disk hangs or others lock the store, that is not
        /// reported as failing while nothing is lost: a busy machine is no fault.
        std::chrono::milliseconds patience{20'000};
    };

    /// Figures for metrics.
    struct Status {
        WriteState write_state = WriteState::writing;
        std::size_t waiting = 0;          ///< executions and events that are not written yet
        std::size_t waiting_samples = 0;  ///< samples that are not written yet
        std::uint64_t written = 0;        ///< number of executions that are in the store
        Dropped dropped{};
    };

    /// Returns without waiting for the store. A store that cannot be opened is tried again and
    /// reported as failing.
    /// Errors: invalid_argument (not a URL of a store, or no server name).
    static Result<std::unique_ptr<Recorder>> create(Options options);
    /// Tries once to write the waiting records.
    virtual ~Recorder() = default;
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;

    /// Begins an execution; its server is always Options::server. Its state follows from its
    /// transitions.
    virtual Key begin(ExecutionRow execution) = 0;
    /// Adds a transition, in the order of their times; the first 100,000 of an execution are kept.
    virtual void transition(Key key, Transition transition) = 0;
    virtual void intermediate(Key key, Intermediate intermediate) = 0;
    virtual void sample(Key key, const PathSample& sample) = 0;
    /// Ends an execution; nothing of it may follow.
    virtual void end(Key key, Outcome outcome) = 0;

    /// Waits until readers see all that was recorded before. For tests and tools, not for servers.
    /// \return false at the deadline
    virtual bool flush(SteadyTime deadline) = 0;
    /// Threads: any.
    virtual Status status() const = 0;

protected:
    Recorder() = default;
};

}  // namespace metier::records
