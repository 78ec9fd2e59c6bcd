#include "backlog.hpp"

#include <array>
#include <chrono>
#include <cstring>
#include <random>
#include <utility>

#include "parts.hpp"
#include "text.hpp"
#include "writer.hpp"

namespace metier::records {
namespace {

/// What content begins with; another one when its form changes, or that of a message.
constexpr std::uint32_t kForm = 0x4D42'0001;

template <typename T>
void put(T value, Bytes& bytes) {
    std::array<std::uint8_t, sizeof value> raw{};
    std::memcpy(raw.data(), &value, sizeof value);
    bytes.insert(bytes.end(), raw.begin(), raw.end());
}

/// From the front; nothing if there is less.
template <typename T>
std::optional<T> take(std::span<const std::uint8_t>& bytes) {
    if (bytes.size() < sizeof(T)) {
        return std::nullopt;
    }
    T value{};
    std::memcpy(&value, bytes.data(), sizeof value);
    bytes = bytes.subspan(sizeof value);
    return value;
}

/// \param entry life and number
Result<void> recoverOne(Database& database, Writer& writer, const Row& entry, Dropped& lost) {
    const auto content =
        database.query("SELECT content FROM backlog WHERE life = $1 AND number = $2",
                       std::array<Cell, 2>{entry.integer(0), entry.integer(1)});
    if (!content) {
        return fail(content.error());
    }
    for (const auto& row : *content) {
        lost += writer.take(row.bytes(0));
    }
    return writer.writeWithin(database);
}

std::int64_t newLife() {
    std::random_device device;
    return std::uniform_int_distribution<std::int64_t>(1)(device);
}

}  // namespace

void makeTold(const MessageLog& messages, const std::vector<KeyedSample>& samples, Told& told) {
    told.messages = messages.count();
    told.content.clear();
    const std::uint64_t size = messages.size();
    told.content.reserve(sizeof kForm + sizeof size + size);
    put(kForm, told.content);
    put(size, told.content);
    messages.appendTo(told.content);
    for (const auto& sample : samples) {
        put(sample.key, told.content);
        encodeSample(sample.sample, told.content);
    }
}

bool giveTold(std::span<const std::uint8_t> content, MessageTaker& taker,
              std::vector<KeyedSample>& samples) {
    const auto form = take<std::uint32_t>(content);
    const auto size = take<std::uint64_t>(content);
    if (form != kForm || !size || *size > content.size() ||
        !MessageLog::give(content.first(*size), taker)) {
        return false;
    }
    content = content.subspan(*size);
    while (!content.empty()) {
        const auto key = take<Recorder::Key>(content);
        const auto sample = takeSample(content);
        if (!key || !sample) {
            return false;
        }
        samples.push_back({*key, *sample});
    }
    return true;
}

Backlog::Backlog(const std::string& server)
    : server_(storable(server, kLongestName)), life_(newLife()) {}

Result<void> Backlog::add(Database& database, const Told& told, std::string_view under_way) {
    const auto number = first_ + static_cast<std::int64_t>(entries_.size());
    // It may be there, if the answer to its commit was lost.
    auto done = inTransaction(database, [&]() -> Result<void> {
        const auto rows = database.execute(
            "INSERT INTO backlog (life, number, server, under_way, content) VALUES ($1, $2, $3, "
            "$4, $5) ON CONFLICT DO NOTHING",
            std::array<Argument, 5>{life_, number, server_, under_way,
                                    std::span<const std::uint8_t>(told.content)});
        return rows ? Result<void>() : Result<void>(fail(rows.error()));
    });
    if (done) {
        entries_.push_back({.time = std::chrono::steady_clock::now(),
                            .messages = told.messages,
                            .bytes = told.content.size()});
        messages_ += told.messages;
        bytes_ += told.content.size();
    }
    return done;
}

Result<std::optional<Bytes>> Backlog::readOldest(Database& database) const {
    const auto rows = database.query("SELECT content FROM backlog WHERE life = $1 AND number = $2",
                                     std::array<Cell, 2>{life_, first_});
    if (!rows) {
        return fail(rows.error());
    }
    return rows->empty() ? std::nullopt : std::optional(rows->front().bytes(0));
}

Result<void> Backlog::removeOldest(Database& database, std::string_view under_way) const {
    const auto removed = database.query("DELETE FROM backlog WHERE life = $1 AND number = $2",
                                        std::array<Cell, 2>{life_, first_});
    const auto rows =
        removed
            ? database.query("UPDATE backlog SET under_way = $1 WHERE life = $2 AND number = $3",
                             std::array<Cell, 3>{std::string(under_way), life_, first_ + 1})
            : removed;
    return rows ? Result<void>() : Result<void>(fail(rows.error()));
}

void Backlog::oldestRemoved() {
    messages_ -= entries_.front().messages;
    bytes_ -= entries_.front().bytes;
    entries_.pop_front();
    ++first_;
}

Result<Dropped> Backlog::recover(Database& database, const std::string& server,
                                 Recorder::ToJson to_json) {
    const auto entries = database.query(
        "SELECT life, number, under_way FROM backlog WHERE server = $1 ORDER BY life, number",
        std::array<Cell, 1>{server});
    if (!entries) {
        return fail(entries.error());
    }
    Dropped lost;
    std::optional<Writer> writer;  // of one life
    std::int64_t life = 0;
    for (const auto& entry : *entries) {
        auto done = Result<void>();
        if (!writer || life != entry.integer(0)) {
            life = entry.integer(0);
            writer.emplace(server, to_json);
            done = writer->goOnWith(database, entry.text(2));
        }
        if (done) {
            done = recoverOne(database, *writer, entry, lost);
        }
        if (!done) {
            return fail(done.error());
        }
    }
    const auto removed =
        database.query("DELETE FROM backlog WHERE server = $1", std::array<Cell, 1>{server});
    return removed ? Result<Dropped>(lost) : Result<Dropped>(fail(removed.error()));
}

}  // namespace metier::records
