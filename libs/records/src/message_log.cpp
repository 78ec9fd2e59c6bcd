#include "message_log.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

#include "packing.hpp"

namespace metier::records {
namespace {

/// Of a piece; one message may need more [byte].
constexpr std::size_t kPiece = 262'144;
/// Pieces that are kept: what a lively second takes.
constexpr std::size_t kMostKept = 64;

// What is kept of a message: names, which are few and come again and again, and what is its own.

template <typename Message>
requires requires(Message& m) {
    m.thumbprint;
}
auto namesOf(Message& e) {
    return std::tie(e.server_name, e.skill, e.controller, e.device, e.parent_server, e.session,
                    e.client_name, e.user, e.thumbprint, e.state, e.reason, e.reason_text);
}
template <typename Message>
requires requires(Message& m) {
    m.thumbprint;
}
auto ownOf(Message& e) {
    return std::tie(e.id, e.parent, e.parameters, e.check, e.result, e.started, e.missed_cycles);
}
template <typename Message>
requires requires(Message& m) {
    m.sub_state;
}
auto namesOf(Message& t) {
    return std::tie(t.from, t.to, t.sub_state, t.step, t.reason, t.reason_text);
}
template <typename Message>
requires requires(Message& m) {
    m.sub_state;
}
auto ownOf(Message& t) {
    return std::tie(t.time);
}
template <typename Message>
requires requires(Message& m) {
    m.value;
}
auto namesOf(Message& /*i*/) {
    return std::tie();
}
template <typename Message>
requires requires(Message& m) {
    m.value;
}
auto ownOf(Message& i) {
    return std::tie(i.time, i.value);
}
template <typename Message>
requires requires(Message& m) {
    m.result, m.time;
}
auto namesOf(Message& o) {
    return std::tie(o.state, o.reason, o.reason_text);
}
template <typename Message>
requires requires(Message& m) {
    m.result, m.time;
}
auto ownOf(Message& o) {
    return std::tie(o.time, o.result, o.missed_cycles);
}

/// Recent texts of messages that are told together.
template <typename... Messages>
struct Recent {
    RecentTexts names{};
    std::array<RecentTexts, (std::tuple_size_v<decltype(ownOf(std::declval<Messages&>()))> + ...)>
        own{};

    void clear() {
        names.clear();
        std::for_each(own.begin(), own.end(), [](RecentTexts& texts) { texts.clear(); });
    }
};

void put(Packer& packer, std::string_view text, RecentTexts& recent) {
    packer.put(text, recent);
}
template <typename T>
void put(Packer& packer, const T& value, RecentTexts& /*recent*/) {
    packer.put(value);
}
void take(Unpacker& unpacker, std::string& text, RecentTexts& recent) {
    unpacker.take(text, recent);
}
template <typename T>
void take(Unpacker& unpacker, T& value, RecentTexts& /*recent*/) {
    unpacker.take(value);
}

/// Calls `one` with each of `fields` and of `recent`.
template <typename Fields, typename Recents, typename One>
void forEach(const Fields& fields, Recents& recent, One one) {
    [&]<std::size_t... I>(std::index_sequence<I...> /*all*/) {
        (one(std::get<I>(fields), recent[I]), ...);
    }
    (std::make_index_sequence<std::tuple_size_v<Fields>>{});
}

// Names as one text: the length of each in a byte, or kLong and then in four, and the name.

constexpr std::uint8_t kLong = 255;

void joinOne(std::string_view name, std::string& joined) {
    const auto size = static_cast<std::uint32_t>(name.size());
    joined += static_cast<char>(std::min<std::uint32_t>(size, kLong));
    if (size >= kLong) {
        const auto bytes = std::bit_cast<std::array<char, sizeof size>>(size);
        joined.append(bytes.data(), bytes.size());
    }
    joined += name;
}

/// False if it is not there.
bool splitOne(std::string_view& joined, std::string& name) {
    if (joined.empty()) {
        return false;
    }
    std::uint32_t size = static_cast<std::uint8_t>(joined.front());
    joined.remove_prefix(1);
    if (size == kLong) {
        if (joined.size() < sizeof size) {
            return false;
        }
        std::memcpy(&size, joined.data(), sizeof size);
        joined.remove_prefix(sizeof size);
    }
    if (joined.size() < size) {
        return false;
    }
    name = joined.substr(0, size);
    joined.remove_prefix(size);
    return true;
}

/// \return false if they are damaged
template <typename... Messages>
bool give(Unpacker& unpacker, Recorder::Key key, Recent<Messages...>& recent, MessageTaker& taker) {
    std::tuple<Messages...> all;
    const auto of_all = [&all](auto fields_of) {
        return std::apply([&](auto&... one) { return std::tuple_cat(fields_of(one)...); }, all);
    };
    std::string joined;
    unpacker.take(joined, recent.names);
    forEach(of_all([](auto& one) { return ownOf(one); }), recent.own,
            [&](auto& field, RecentTexts& texts) { take(unpacker, field, texts); });
    std::string_view rest(joined);
    const bool whole = unpacker.isWhole() &&
                       std::apply([&](auto&... name) { return (splitOne(rest, name) && ...); },
                                  of_all([](auto& one) { return namesOf(one); }));
    if (whole) {
        std::apply([&](auto&... one) { (taker.take(key, std::move(one)), ...); }, all);
    }
    return whole;
}

}  // namespace

/// What the next messages are told as a difference from.
struct MessageLog::Before {
    BeforeIntegers integers{};
    Recent<Execution> begun{};
    Recent<Transition> transition{};
    Recent<Intermediate> intermediate{};
    Recent<Outcome> outcome{};
    Recent<Execution, Transition> started{};
    Recent<Transition, Outcome> ended{};
    // Of the message that is put; they have their memory already.
    std::string names{};
    Bytes packed{};

    void clear() {
        integers = {};
        begun.clear();
        transition.clear();
        intermediate.clear();
        outcome.clear();
        started.clear();
        ended.clear();
    }
    /// \return false if they are damaged
    bool giveAll(std::span<const std::uint8_t> bytes, MessageTaker& taker) {
        Unpacker unpacker(bytes, integers);
        while (!unpacker.isAtEnd()) {
            if (!giveNext(unpacker, taker)) {
                return false;
            }
        }
        return true;
    }

private:
    bool giveNext(Unpacker& unpacker, MessageTaker& taker) {
        const auto kind = static_cast<Kind>(unpacker.byte());
        const auto key = unpacker.key();
        switch (kind) {
            case Kind::begun:
                return records::give(unpacker, key, begun, taker);
            case Kind::transition:
                return records::give(unpacker, key, transition, taker);
            case Kind::intermediate:
                return records::give(unpacker, key, intermediate, taker);
            case Kind::outcome:
                return records::give(unpacker, key, outcome, taker);
            case Kind::started:
                return records::give(unpacker, key, started, taker);
            case Kind::ended:
                return records::give(unpacker, key, ended, taker);
        }
        return false;
    }
};

MessageLog::MessageLog() : before_(std::make_unique<Before>()) {}
MessageLog::~MessageLog() = default;
MessageLog::MessageLog(MessageLog&&) noexcept = default;
MessageLog& MessageLog::operator=(MessageLog&&) noexcept = default;

/// With room for so many bytes.
MessageLog::Piece& MessageLog::pieceFor(std::size_t most) {
    if (used_ == 0 || pieces_[used_ - 1].bytes.size() - pieces_[used_ - 1].used < most) {
        if (used_ == pieces_.size()) {
            pieces_.emplace_back();
        }
        auto& next = pieces_[used_++];
        next.bytes.resize(std::max({most, kPiece, next.bytes.size()}));
        next.used = 0;
    }
    return pieces_[used_ - 1];
}

template <typename Recent, typename... Messages>
void MessageLog::append(Kind kind, Key key, Recent& recent, const Messages&... messages) {
    auto& names = before_->names;
    auto& packed = before_->packed;
    names.clear();
    packed.clear();
    std::apply([&](const auto&... name) { (joinOne(name, names), ...); },
               std::tuple_cat(namesOf(messages)...));
    Packer packer(packed, before_->integers);
    packer.byte(static_cast<std::uint8_t>(kind));
    packer.key(key);
    packer.put(names, recent.names);
    forEach(std::tuple_cat(ownOf(messages)...), recent.own,
            [&](const auto& field, RecentTexts& texts) { records::put(packer, field, texts); });
    auto& piece = pieceFor(packed.size());
    std::memcpy(piece.bytes.data() + piece.used, packed.data(), packed.size());
    piece.used += packed.size();
    ++count_;
}

void MessageLog::put(Key key, const ExecutionView& begun) {
    append(Kind::begun, key, before_->begun, begun);
}

void MessageLog::put(Key key, const TransitionView& transition) {
    append(Kind::transition, key, before_->transition, transition);
}

void MessageLog::put(Key key, const IntermediateView& intermediate) {
    append(Kind::intermediate, key, before_->intermediate, intermediate);
}

void MessageLog::put(Key key, const OutcomeView& outcome) {
    append(Kind::outcome, key, before_->outcome, outcome);
}

void MessageLog::put(Key key, const ExecutionView& begun, const TransitionView& first) {
    append(Kind::started, key, before_->started, begun, first);
}

void MessageLog::put(Key key, const TransitionView& last, const OutcomeView& outcome) {
    append(Kind::ended, key, before_->ended, last, outcome);
}

void MessageLog::giveTo(MessageTaker& taker) const {
    Before before;
    for (std::size_t i = 0; i < used_; ++i) {
        before.giveAll(std::span(pieces_[i].bytes).first(pieces_[i].used), taker);
    }
}

bool MessageLog::give(std::span<const std::uint8_t> bytes, MessageTaker& taker) {
    Before before;
    return before.giveAll(bytes, taker);
}

void MessageLog::appendTo(Bytes& bytes) const {
    for (std::size_t i = 0; i < used_; ++i) {
        const auto used = std::span(pieces_[i].bytes).first(pieces_[i].used);
        bytes.insert(bytes.end(), used.begin(), used.end());
    }
}

std::size_t MessageLog::size() const noexcept {
    std::size_t size = 0;
    for (std::size_t i = 0; i < used_; ++i) {
        size += pieces_[i].used;
    }
    return size;
}

void MessageLog::clear() {
    count_ = 0;
    used_ = 0;
    // Whoever reads the next message begins without any before it.
    before_->clear();
    pieces_.resize(std::min(pieces_.size(), kMostKept));
    std::erase_if(pieces_, [](const Piece& piece) { return piece.bytes.size() > kPiece; });
}

}  // namespace metier::records
