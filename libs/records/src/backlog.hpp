#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "database.hpp"
#include "message_log.hpp"
#include "metier/base/clock.hpp"

namespace metier::records {

class Writer;

/// What a recorder was told in a while, of which no rows were made yet.
struct Told {
    Bytes content{};
    std::uint64_t messages = 0;
};

/// Replaces `told`, whose memory is used again.
void makeTold(const MessageLog& messages, const std::vector<KeyedSample>& samples, Told& told);
/// Gives the messages to `taker` and appends the samples, up to what is damaged.
/// \return how many messages are missing; 0: it is whole
std::uint64_t giveTold(std::span<const std::uint8_t> content, MessageTaker& taker,
                       std::vector<KeyedSample>& samples);
/// Whether another version of metier, which packs messages in another way, has made it.
bool isOfAnotherVersion(std::span<const std::uint8_t> content);

/// What one recorder was told faster than it makes rows of it, in the store as it came: to write it
/// so takes a hundredth of the time, and it outlives the process.
class Backlog {
public:
    /// \param server ApplicationUri
    explicit Backlog(const std::string& server);

    bool isEmpty() const noexcept { return entries_.empty(); }
    std::uint64_t messages() const noexcept { return messages_; }
    /// Of the pieces, from 0; that of the oldest, and of the next one that is added.
    std::int64_t first() const noexcept { return first_; }
    std::int64_t next() const noexcept {
        return first_ + static_cast<std::int64_t>(entries_.size());
    }
    /// When the oldest was added; only if there is one.
    SteadyTime oldest() const { return entries_.front().time; }

    /// In a transaction of its own. After an error, again with the same.
    /// \param under_way Writer::underWay()
    Result<void> add(Database& database, const Told& told, std::string_view under_way);
    /// The content of the oldest; nothing if another server, which took this one for dead, has made
    /// rows of it.
    Result<std::optional<Bytes>> readOldest(Database& database) const;
    /// Whether the answer to its commit was lost, so that rows may have been made of it as well.
    bool isOldestInDoubt() const { return entries_.front().in_doubt; }
    /// Within the transaction that makes its rows.
    /// \return false if it is there no longer
    Result<bool> removeOldest(Database& database) const;
    /// Within the same one.
    /// \param under_way after the rows of the oldest
    Result<void> noteUnderWay(Database& database, std::string_view under_way) const;
    /// That transaction was committed.
    void oldestRemoved();

private:
    struct Entry {
        SteadyTime time{};
        std::uint64_t messages = 0;
        bool in_doubt = false;
    };

    const std::string server_;
    const std::int64_t life_;  // tells recorders of one server apart
    std::int64_t first_ = 0;   // number of the oldest
    std::deque<Entry> entries_;
    std::uint64_t messages_ = 0;
    bool add_failed_ = false;  // the last time
};

/// Makes rows of what a server left when it died, a piece in each transaction: others that write
/// need not wait for all of it.
class Recovery {
public:
    Recovery(std::string server, Recorder::ToJson to_json);
    ~Recovery();
    Recovery(const Recovery&) = delete;
    Recovery& operator=(const Recovery&) = delete;

    /// Of the oldest piece. Within a transaction; if that fails, this is of no use any more. What
    /// another version of metier left stays for one of that version.
    /// \return false if there was none
    Result<bool> step(Database& database);
    /// What was damaged or too much.
    const Dropped& lost() const noexcept { return lost_; }

private:
    Result<void> makeRows(Database& database, std::string_view under_way,
                          std::span<const std::uint8_t> content);

    const std::string server_;
    const Recorder::ToJson to_json_;
    std::unique_ptr<Writer> writer_;  // of the piece before, if that was of the same life
    std::int64_t life_ = 0;
    std::int64_t number_ = 0;
    std::vector<std::int64_t> others_;  // lives of another version
    Dropped lost_;
};

}  // namespace metier::records
