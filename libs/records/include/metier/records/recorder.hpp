#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/records/execution.hpp"
#include "metier/records/store.hpp"

namespace metier::records {

/// What could not be recorded.
struct Dropped {
    std::uint64_t executions = 0;
    std::uint64_t events = 0;  ///< transitions and intermediate results
    std::uint64_t samples = 0;

    bool any() const noexcept { return executions + events + samples > 0; }
    Dropped& operator+=(const Dropped& more) noexcept {
        executions += more.executions;
        events += more.events;
        samples += more.samples;
        return *this;
    }
    friend bool operator==(const Dropped&, const Dropped&) = default;
};

/// What recording is in.
enum class Health {
    writing,
    failing,  ///< nothing can be written, or it takes too long: something is or may get lost
};

/// What the server should tell as an alarm: once when recording fails, once when it works again.
struct HealthReport {
    Health health = Health::writing;
    std::string text{};  ///< for a person: the reason and what was lost, "records work again: ..."
    Dropped dropped{};   ///< since the recorder was made
};

/// Records the executions of one server. Every call returns at once, whatever the disk does.
///
/// A writer thread of its own writes at least every 500 ms: a crash of the server loses at most the
/// last second. What comes faster than 2,000 executions a second is written as it was told, and
/// made rows of, which readers see, once less comes, after ten seconds, or when the server is
/// started again. While the store cannot be written or opened, events wait in a queue of a fixed
/// size; beyond it new executions and events are dropped, of samples the oldest. An end is never
/// dropped if its begin was not. What servers that died left under way is closed as kLost
/// when it opens the store, and every hour. The store is trimmed to its retention at the beginning
/// and then every hour.
class Recorder {
public:
    /// One execution of this recorder; 0: it was dropped, and all that is told of it is, too.
    using Key = std::uint64_t;
    /// Makes JSON of a value in the form that its teller has given it.
    using ToJson = std::string (*)(std::string_view);

    struct Options {
        std::string url{};     ///< as Store::open() takes it
        std::string server{};  ///< ApplicationUri; nobody else records under it
        Retention keep{};
        /// Called on a thread of the recorder with parameters, intermediate values and results,
        /// unless empty, whatever was told; null: they are JSON. Takes any bytes: the store may be
        /// damaged.
        ToJson to_json = nullptr;
        /// On a thread of the recorder, at each change of its health. May be empty.
        std::function<void(const HealthReport&)> on_health{};
        std::size_t most_waiting = 10'000;          ///< executions and events
        std::size_t most_waiting_samples = 16'384;  ///< about 220 byte each, taken at once
        /// Longest time without a write, because the disk hangs or others keep the store locked,
        /// that is not told as failing while nothing is lost: a busy machine is no fault.
        std::chrono::milliseconds patience{20'000};
    };

    /// How it is, for metrics.
    struct Status {
        Health health = Health::writing;
        std::size_t waiting = 0;          ///< messages of which there are no rows yet
        std::size_t waiting_samples = 0;  ///< about
        std::uint64_t written = 0;        ///< executions that began and are in the store
        Dropped dropped{};
    };

    /// Does not wait for the store: one that cannot be opened is tried again and told as failing.
    /// Errors: invalid_argument (no such URL, no server's name).
    static Result<std::unique_ptr<Recorder>> create(Options options);
    /// Tries once to write what is waiting.
    ~Recorder();
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;

    /// An execution begins; its server is Options::server whatever it says. Its state changes with
    /// its transitions. Threads: any, but no cycle thread (allocates, locks for a moment); the same
    /// for all but sample().
    Key begin(const ExecutionView& execution);
    /// The same, and its first transition.
    Key begin(const ExecutionView& execution, const TransitionView& first);
    /// Of one execution in the order of their times; the 100,000 first are kept.
    void transition(Key key, const TransitionView& transition);
    void intermediate(Key key, const IntermediateView& intermediate);
    /// Threads: any, cycle threads as well; neither locks nor allocates. One at a time for a key.
    void sample(Key key, const PathSample& sample) noexcept;
    /// Nothing may be told of it any more.
    void end(Key key, const OutcomeView& outcome);
    /// The same, and its last transition before.
    void end(Key key, const OutcomeView& outcome, const TransitionView& last);
    /// begin() and end() of an execution that is over.
    void record(const WholeExecution& whole);

    /// Waits until readers see all that was told before; false at the deadline. For tests and
    /// tools, not for servers.
    bool flush(SteadyTime deadline);
    /// Threads: any.
    Status status() const;

private:
    class Impl;
    explicit Recorder(std::unique_ptr<Impl> impl);

    std::unique_ptr<Impl> impl_;
};

}  // namespace metier::records
