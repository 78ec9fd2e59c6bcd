#include "backlog.hpp"

#include <algorithm>
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

/// What content begins with: a mark, and a version that changes with its form or a message's.
constexpr std::uint32_t kMark = 0x4D42'0000;
constexpr std::uint32_t kVersions = 0xFFFF;
constexpr std::uint32_t kForm = kMark + 2;

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

struct Place {
    std::int64_t life = 0;
    std::int64_t number = 0;
};

/// \return false if it was not there
Result<bool> remove(Database& database, const Place& piece) {
    const auto removed =
        database.query("DELETE FROM backlog WHERE life = $1 AND number = $2 RETURNING number",
                       std::array<Cell, 2>{piece.life, piece.number});
    return removed ? Result<bool>(!removed->empty()) : Result<bool>(fail(removed.error()));
}

Result<void> setUnderWay(Database& database, const Place& piece, std::string_view under_way) {
    const auto rows =
        database.query("UPDATE backlog SET under_way = $1 WHERE life = $2 AND number = $3",
                       std::array<Cell, 3>{std::string(under_way), piece.life, piece.number});
    return rows ? Result<void>() : Result<void>(fail(rows.error()));
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
    told.content.reserve(sizeof kForm + sizeof told.messages + sizeof size + size);
    put(kForm, told.content);
    put(told.messages, told.content);
    put(size, told.content);
    messages.appendTo(told.content);
    for (const auto& sample : samples) {
        put(sample.key, told.content);
        encodeSample(sample.sample, told.content);
    }
}

std::uint64_t giveTold(std::span<const std::uint8_t> content, MessageTaker& taker,
                       std::vector<KeyedSample>& samples) {
    const auto form = take<std::uint32_t>(content);
    const auto messages = take<std::uint64_t>(content);
    const auto size = take<std::uint64_t>(content);
    if (form != kForm || !messages || !size || *size > content.size()) {
        return 1;  // at least
    }
    const auto given = MessageLog::give(content.first(*size), taker);
    if (given != *messages) {
        return std::max<std::uint64_t>(*messages, given + 1) - given;
    }
    content = content.subspan(*size);
    while (!content.empty()) {
        const auto key = take<Recorder::Key>(content);
        const auto sample = takeSample(content);
        if (!key || !sample) {
            return 1;
        }
        samples.push_back({*key, *sample});
    }
    return 0;
}

bool isOfAnotherVersion(std::span<const std::uint8_t> content) {
    const auto form = take<std::uint32_t>(content);
    return form && (*form & ~kVersions) == kMark && *form != kForm;
}

Backlog::Backlog(const std::string& server)
    : server_(storable(server, kLongestName)), life_(newLife()) {}

Result<void> Backlog::add(Database& database, const Told& told, std::string_view under_way) {
    // It may be there, if the answer to its commit was lost.
    auto done = inTransaction(database, [&]() -> Result<void> {
        const auto rows = database.execute(
            "INSERT INTO backlog (life, number, server, under_way, content) VALUES ($1, $2, $3, "
            "$4, $5) ON CONFLICT DO NOTHING",
            std::array<Argument, 5>{life_, next(), server_, under_way,
                                    std::span<const std::uint8_t>(told.content)});
        return rows ? Result<void>() : Result<void>(fail(rows.error()));
    });
    if (done) {
        entries_.push_back({.time = std::chrono::steady_clock::now(),
                            .messages = told.messages,
                            .in_doubt = add_failed_});
        messages_ += told.messages;
    }
    add_failed_ = !done;
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

Result<bool> Backlog::removeOldest(Database& database) const {
    return remove(database, {life_, first_});
}

Result<void> Backlog::noteUnderWay(Database& database, std::string_view under_way) const {
    return setUnderWay(database, {life_, first_ + 1}, under_way);
}

void Backlog::oldestRemoved() {
    messages_ -= entries_.front().messages;
    entries_.pop_front();
    ++first_;
}

Recovery::Recovery(std::string server, Recorder::ToJson to_json)
    : server_(std::move(server)), to_json_(to_json) {}

Recovery::~Recovery() = default;

Result<bool> Recovery::step(Database& database) {
    const auto lives = database.query(
        "SELECT life, min(number) FROM backlog WHERE server = $1 GROUP BY life ORDER BY life",
        std::array<Cell, 1>{server_});
    if (!lives) {
        return fail(lives.error());
    }
    const auto next = std::find_if(lives->begin(), lives->end(), [this](const Row& row) {
        return std::find(others_.begin(), others_.end(), row.integer(0)) == others_.end();
    });
    if (next == lives->end()) {
        return false;
    }
    const Place piece{next->integer(0), next->integer(1)};
    const auto rows =
        database.query("SELECT under_way, content FROM backlog WHERE life = $1 AND number = $2",
                       std::array<Cell, 2>{piece.life, piece.number});
    if (!rows) {
        return fail(rows.error());
    }
    const auto content = rows->front().bytes(1);
    if (isOfAnotherVersion(content)) {
        others_.push_back(piece.life);
        return true;
    }
    // Somebody else may have made rows of the one before.
    if (piece.life != life_ || piece.number != number_ + 1) {
        writer_.reset();
    }
    auto done = makeRows(database, rows->front().text(0), content);
    if (done) {
        done = setUnderWay(database, {piece.life, piece.number + 1}, writer_->underWay());
    }
    const auto removed = done ? remove(database, piece) : Result<bool>(fail(done.error()));
    life_ = piece.life;
    number_ = piece.number;
    return removed ? Result<bool>(true) : removed;
}

Result<void> Recovery::makeRows(Database& database, std::string_view under_way,
                                std::span<const std::uint8_t> content) {
    if (!writer_) {
        writer_ = std::make_unique<Writer>(server_, to_json_);
        if (auto gone_on = writer_->goOnWith(database, under_way); !gone_on) {
            return gone_on;
        }
    }
    lost_ += writer_->take(content);
    auto written = writer_->writeWithin(database);
    if (written) {
        writer_->kept();
    }
    return written;
}

}  // namespace metier::records
