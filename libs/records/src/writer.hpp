#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "database.hpp"
#include "message_log.hpp"
#include "metier/records/execution.hpp"
#include "metier/records/recorder.hpp"
#include "parts.hpp"
#include "rows.hpp"

namespace metier::records {

/// Turns what a recorder was told into rows. Threading: one thread.
class Writer final : private MessageTaker {
public:
    /// \param server ApplicationUri of all that it is told of
    Writer(std::string server, Recorder::ToJson to_json)
        : server_(std::move(server)), to_json_(to_json) {}

    /// Takes the messages in their order, then the samples; nothing is written yet.
    /// \return how much was too much for its execution
    Dropped take(const MessageLog& messages, const std::vector<KeyedSample>& samples);
    /// The same of Told::content. Messages that are damaged count as events.
    Dropped take(std::span<const std::uint8_t> told);
    /// Writes what was taken, all of it or nothing; may be called again after an error, also with
    /// another connection to the same store.
    Result<void> write(Database& database);
    /// The same within a transaction; kept() or undone() tells how that ended.
    Result<void> writeWithin(Database& database);
    /// All that was written is in the store.
    void kept();
    /// Nothing of it is, unless the answer to the commit was lost.
    void undone();
    /// What is written next may be in the store already.
    void doubt() noexcept { in_doubt_ = true; }
    /// The executions under way, once what was taken is in the store.
    std::string underWay() const;
    /// Another server, which took this one for dead, has made rows of what was taken last: goes on
    /// with what is in the store.
    Result<void> goOnWithStore(Database& database);
    /// Takes over from another writer of this server.
    /// \param under_way of that one
    Result<void> goOnWith(Database& database, std::string_view under_way);
    /// Closes what the server left under way when it died. Within a transaction.
    static Result<void> closeLost(Database& database, const std::string& server);

    bool hasChanges() const noexcept { return !changed_.empty(); }
    /// Whether executions are under way.
    bool isBusy() const noexcept { return !active_.empty(); }
    /// Executions that began and are in the store.
    std::uint64_t written() const noexcept { return written_; }

private:
    /// An execution that is under way, or over and not written yet.
    struct Active {
        Execution execution{};
        std::int64_t parts = 0;
        std::size_t events_kept = 0;
        std::vector<Event> events{};  // that are not written yet
        Bytes samples{};              // as well
        bool row_changed = true;
        bool changed = false;

        bool hasPart() const { return !events.empty() || !samples.empty(); }
    };
    void take(Recorder::Key key, Execution&& execution) override;
    void take(Recorder::Key key, Transition&& transition) override;
    void take(Recorder::Key key, Intermediate&& intermediate) override;
    void take(Recorder::Key key, Outcome&& outcome) override;
    void takeSamples(const std::vector<KeyedSample>& samples);
    bool takeSample(const KeyedSample& sample);
    Active* find(Recorder::Key key);
    Active* findForEvent(Recorder::Key key);
    void note(Recorder::Key key, Active& active);
    Result<void> writeOne(RowWriter& rows, Recorder::Key key, Active& active);
    Result<bool> isOverInStore(RowWriter& rows, Database& database, Active& active);

    /// A value that was made JSON; the next one is often the same.
    struct Made {
        std::string from{};
        std::string json{};
    };

    void makeJson(std::string& value) const;
    Result<bool> readRow(Database& database, Execution& execution) const;

    const std::string server_;
    const Recorder::ToJson to_json_;
    Made parameters_;
    std::unordered_map<Recorder::Key, Active> active_;
    std::vector<Recorder::Key> changed_;
    std::vector<KeyedSample> early_;  // of executions that were not taken yet
    Recorder::Key newest_ = 0;
    std::uint64_t written_ = 0;
    Dropped dropped_;
    bool in_doubt_ = false;  // the last write failed; whether it was committed is not known
    std::vector<Recorder::Key> numbered_;  // who got a number in this transaction
    KindCache kinds_;
};

}  // namespace metier::records
