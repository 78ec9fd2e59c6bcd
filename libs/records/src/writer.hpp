#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "database.hpp"
#include "messages.hpp"
#include "metier/records/execution_row.hpp"
#include "metier/records/recorder.hpp"
#include "parts.hpp"
#include "rows.hpp"

namespace metier::records {

/// Turns what a recorder was given into rows. Threading: one thread.
class Writer {
public:
    /// \param server ApplicationUri of all executions
    explicit Writer(std::string server) : server_(std::move(server)) {}

    /// Takes the messages in their order, then the samples; nothing is written yet.
    /// \return how much was too much for its execution
    Dropped take(Batch batch);
    /// Writes what was taken, all of it or nothing; may be called again after an error, also with
    /// another connection to the same store.
    Result<void> write(Database& database);

    /// The store was opened again: it may be another one.
    void reopened() { kinds_.clear(); }
    bool hasChanges() const noexcept { return !changed_.empty(); }
    /// Executions that began and are in the store.
    std::uint64_t written() const noexcept { return written_; }

private:
    /// An execution that is under way, or over and not written yet.
    struct Active {
        ExecutionRow execution{};
        std::int64_t parts = 0;
        std::size_t events_kept = 0;
        std::vector<Event> events{};  // not written yet
        Bytes samples{};              // as well
        bool row_changed = true;
        bool changed = false;

        bool hasPart() const { return !events.empty() || !samples.empty(); }
    };
    void take(Recorder::Key key, std::unique_ptr<ExecutionRow> execution);
    void take(Recorder::Key key, Transition transition);
    void take(Recorder::Key key, Intermediate intermediate);
    void take(Recorder::Key key, Outcome outcome);
    void take(const KeyedSample& sample);
    Active* find(Recorder::Key key);
    Active* findForEvent(Recorder::Key key);
    void note(Recorder::Key key, Active& active);
    Result<void> writeWithin(Database& database);
    Result<void> writeOne(RowWriter& rows, Recorder::Key key, Active& active);
    void kept();
    void undone();

    const std::string server_;
    std::unordered_map<Recorder::Key, Active> active_;
    std::vector<Recorder::Key> changed_;
    std::uint64_t written_ = 0;
    Dropped dropped_;
    bool in_doubt_ = false;  // the last write failed; whether it was committed is not known
    std::vector<Recorder::Key> numbered_;  // executions that got a number in this transaction
    KindCache kinds_;
};

}  // namespace metier::records
