#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "database.hpp"
#include "message_log.hpp"
#include "metier/base/clock.hpp"

namespace metier::records {

/// What a recorder was told in a while, of which no rows were made yet.
struct Told {
    Bytes content{};
    std::uint64_t messages = 0;
};

/// Replaces `told`, whose memory is used again.
void makeTold(const MessageLog& messages, const std::vector<KeyedSample>& samples, Told& told);
/// Gives the messages to `taker` and appends the samples.
/// \return false if it is damaged or of another version of metier: what came before that was given
bool giveTold(std::span<const std::uint8_t> content, MessageTaker& taker,
              std::vector<KeyedSample>& samples);

/// What one recorder was told faster than it makes rows of it, in the store as it came: to write it
/// so takes a hundredth of the time, and it outlives the process.
class Backlog {
public:
    /// \param server ApplicationUri
    explicit Backlog(const std::string& server);

    bool isEmpty() const noexcept { return entries_.empty(); }
    std::uint64_t messages() const noexcept { return messages_; }
    std::size_t bytes() const noexcept { return bytes_; }
    /// When the oldest was added; only if there is one.
    SteadyTime oldest() const { return entries_.front().time; }

    /// In a transaction of its own. After an error, again with the same.
    /// \param under_way Writer::underWay()
    Result<void> add(Database& database, const Told& told, std::string_view under_way);
    /// The content of the oldest; nothing if another server, which took this one for dead, has made
    /// rows of it.
    Result<std::optional<Bytes>> readOldest(Database& database) const;
    /// Within a transaction.
    /// \param under_way after the rows of the oldest
    Result<void> removeOldest(Database& database, std::string_view under_way) const;
    /// That transaction was committed.
    void oldestRemoved();

    /// Makes rows of what a server left when it died. Within a transaction.
    /// \return what was damaged or too much
    static Result<Dropped> recover(Database& database, const std::string& server,
                                   Recorder::ToJson to_json);

private:
    struct Entry {
        SteadyTime time{};
        std::uint64_t messages = 0;
        std::size_t bytes = 0;
    };

    const std::string server_;
    const std::int64_t life_;  // tells recorders of one server apart
    std::int64_t first_ = 0;   // number of the oldest
    std::deque<Entry> entries_;
    std::uint64_t messages_ = 0;
    std::size_t bytes_ = 0;
};

}  // namespace metier::records
