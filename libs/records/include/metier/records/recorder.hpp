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
    /// Number of executions, with all that belongs to them.
    std::uint64_t executions = 0;
    /// Number of transitions and intermediate results.
    std::uint64_t events = 0;
    /// Number of samples of paths.
    std::uint64_t samples = 0;

    /// All kinds together; a dropped execution counts once, whatever belonged to it.
    std::uint64_t sum() const noexcept { return executions + events + samples; }
    /// Adds each kind.
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
    /// Records reach the store.
    writing,
    /// Nothing can be written, or writing takes too long: records are lost or may be.
    failing,
};

/// Report for the server's clients: sent once when recording fails, and once when it works again.
struct WriteReport {
    /// State from now on.
    WriteState write_state = WriteState::writing;
    /// Text for a person: the reason and what was lost, "records work again: ...".
    std::string text{};
    /// Records that were lost since the recorder was made.
    Dropped dropped{};
};

/// Records the executions of one server. Every call returns at once, whatever the disk does. A
/// server gives each Program a ProgramRecorder, which makes these calls:
///
///     auto recorder = Recorder::create({.url = "/var/lib/metier/records.db", .server = uri});
///     ProgramRecorder of_skill(program, **recorder, nullptr, {.server_name = "arm"});
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

    /// Settings of a recorder.
    struct Options {
        /// Store, as Store::open() takes it.
        std::string url{};
        /// ApplicationUri of the server. Recorders of several processes may share it: what one of
        /// them left under way when it died is closed once none of them is there.
        std::string server{};
        /// Age and size up to which records are kept.
        Retention keep{};
        /// Called on a thread of the recorder, at each change between writing and failing. May be
        /// empty.
        std::function<void(const WriteReport&)> on_write_state{};
        /// Largest memory of executions and events that wait [byte].
        std::size_t most_waiting = 50'000'000;
        /// Largest number of samples that wait, about 230 byte each.
        std::size_t most_waiting_samples = 16'384;
        /// Longest time without a write, since the disk hangs or others lock the store, that is not
        /// reported as failing while nothing is lost: a busy machine is no fault.
        std::chrono::milliseconds patience{20'000};
    };

    /// Figures for metrics.
    struct Status {
        /// Whether records are written now.
        WriteState write_state = WriteState::writing;
        /// Number of executions and events that are not written yet.
        std::size_t waiting = 0;
        /// Number of samples that are not written yet.
        std::size_t waiting_samples = 0;
        /// Number of executions that are in the store.
        std::uint64_t written = 0;
        /// Records that were lost since the recorder was made.
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
    /// \return 0 if it was dropped
    virtual Key begin(ExecutionRow execution) = 0;
    /// Adds a transition, in the order of their times; the first 100,000 of an execution are kept.
    virtual void transition(Key key, Transition transition) = 0;
    /// Adds a value that the execution published.
    /// Dropped and counted if the queue is full, as a transition is.
    virtual void intermediate(Key key, Intermediate intermediate) = 0;
    /// Adds a sample of the arm's path.
    virtual void sample(Key key, const PathSample& sample) = 0;
    /// Ends an execution; nothing of it may follow.
    /// Taken also when the queue is full, so that no recorded execution stays open.
    virtual void end(Key key, Outcome outcome) = 0;

    /// Waits until readers see all that was recorded before. For tests and tools, not for servers.
    /// \return false at the deadline
    virtual bool flush(SteadyTime deadline) = 0;
    /// Present figures. Threads: any.
    virtual Status status() const = 0;

protected:
    Recorder() = default;
};

}  // namespace metier::records
