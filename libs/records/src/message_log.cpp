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

// What is kept of a message: names, which are few and come again and again, texts, times and
// counts.

template <typename Message>
concept AnExecution = requires(Message& m) {
    m.thumbprint;
};
template <typename Message>
concept ATransition = requires(Message& m) {
    m.sub_state;
};
template <typename Message>
concept AnIntermediate = requires(Message& m) {
    m.value;
};
template <typename Message>
concept AnOutcome = requires(Message& m) {
    m.result, m.time;
};

auto namesOf(AnExecution auto& e) {
    return std::tie(e.server_name, e.skill, e.controller, e.device, e.parent_server, e.session,
                    e.client_name, e.user, e.thumbprint, e.state, e.reason, e.reason_text);
}
auto textsOf(AnExecution auto& e) {
    return std::tie(e.id, e.parent, e.parameters, e.check, e.result);
}
auto timesOf(AnExecution auto& e) {
    return std::tie(e.started);
}
auto countsOf(AnExecution auto& e) {
    return std::tie(e.missed_cycles);
}
auto namesOf(ATransition auto& t) {
    return std::tie(t.from, t.to, t.sub_state, t.step, t.reason, t.reason_text);
}
auto textsOf(ATransition auto& /*t*/) {
    return std::tie();
}
auto timesOf(ATransition auto& t) {
    return std::tie(t.time);
}
auto countsOf(ATransition auto& /*t*/) {
    return std::tie();
}
auto namesOf(AnIntermediate auto& /*i*/) {
    return std::tie();
}
auto textsOf(AnIntermediate auto& i) {
    return std::tie(i.value);
}
auto timesOf(AnIntermediate auto& i) {
    return std::tie(i.time);
}
auto countsOf(AnIntermediate auto& /*i*/) {
    return std::tie();
}
auto namesOf(AnOutcome auto& o) {
    return std::tie(o.state, o.reason, o.reason_text);
}
auto textsOf(AnOutcome auto& o) {
    return std::tie(o.result);
}
auto timesOf(AnOutcome auto& o) {
    return std::tie(o.time);
}
auto countsOf(AnOutcome auto& o) {
    return std::tie(o.missed_cycles);
}

/// Recent texts of messages that are told together.
template <typename... Messages>
struct Recent {
    RecentTexts names{};
    std::array<RecentTexts, (std::tuple_size_v<decltype(textsOf(std::declval<Messages&>()))> + ...)>
        texts{};

    void clear() {
        names.clear();
        std::for_each(texts.begin(), texts.end(), [](RecentTexts& one) { one.clear(); });
    }
};

/// Of tuples, one after the other.
template <typename T, typename... Tuples>
auto arrayOf(const Tuples&... tuples) {
    return std::apply([](const auto&... one) { return std::array<T, sizeof...(one)>{T(one)...}; },
                      std::tuple_cat(tuples...));
}

// Names as one text: the length of each in a byte, or kLong and then in four, and the name.

constexpr std::uint8_t kLong = 255;

std::size_t mostOfJoined(std::string_view name) {
    return 1 + sizeof(std::uint32_t) + name.size();
}

/// Without a call for the few bytes that most names have.
char* copyName(std::string_view name, char* at) {
    const auto* const data = name.data();
    const auto size = name.size();
    const auto ends = [&](auto half) {  // both halves, which overlap
        std::memcpy(&half, data, sizeof half);
        std::memcpy(at, &half, sizeof half);
        std::memcpy(&half, data + size - sizeof half, sizeof half);
        std::memcpy(at + size - sizeof half, &half, sizeof half);
    };
    if (size > 2 * sizeof(std::uint64_t)) {
        std::memcpy(at, data, size);
    } else if (size >= sizeof(std::uint64_t)) {
        ends(std::uint64_t{});
    } else if (size >= sizeof(std::uint32_t)) {
        ends(std::uint32_t{});
    } else {
        std::copy(name.begin(), name.end(), at);
    }
    return at + size;
}

char* joinOne(std::string_view name, char* at) {
    const auto size = static_cast<std::uint32_t>(name.size());
    *at++ = static_cast<char>(std::min<std::uint32_t>(size, kLong));
    if (size == 0) {
        return at;
    }
    if (size >= kLong) {
        std::memcpy(at, &size, sizeof size);
        at += sizeof size;
    }
    return copyName(name, at);
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
    auto* texts = recent.texts.data();
    std::apply([&](auto&... one) { (unpacker.take(one, *texts++), ...); },
               of_all([](auto& one) { return textsOf(one); }));
    std::apply([&](auto&... one) { (unpacker.take(one), ...); },
               of_all([](auto& one) { return timesOf(one); }));
    std::apply([&](auto&... one) { (unpacker.take(one), ...); },
               of_all([](auto& one) { return countsOf(one); }));
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
    Recent<Execution, Transition, Transition, Outcome> whole{};
    std::string joined{};  // names of the message that is put; has its memory already

    void clear() {
        integers = {};
        begun.clear();
        transition.clear();
        intermediate.clear();
        outcome.clear();
        started.clear();
        ended.clear();
        whole.clear();
    }
    /// Valid until the next.
    std::string_view join(std::span<const std::string_view> names) {
        std::size_t most = 0;
        for (const auto name : names) {
            most += mostOfJoined(name);
        }
        if (joined.size() < most) {
            joined.resize(most);
        }
        auto* at = joined.data();
        for (const auto name : names) {
            at = joinOne(name, at);
        }
        return {joined.data(), static_cast<std::size_t>(at - joined.data())};
    }
    /// Up to what is damaged.
    /// \return how many messages
    std::size_t giveAll(std::span<const std::uint8_t> bytes, MessageTaker& taker) {
        std::size_t count = 0;
        Unpacker unpacker(bytes, integers);
        while (!unpacker.isAtEnd()) {
            const auto kind = static_cast<Kind>(unpacker.byte());
            if (!giveNext(kind, unpacker, taker)) {
                return count;
            }
            count += kind == Kind::whole ? 2 : 1;
        }
        return count;
    }

private:
    bool giveNext(Kind kind, Unpacker& unpacker, MessageTaker& taker) {
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
            case Kind::whole:
                return records::give(unpacker, key, whole, taker);
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

/// Of messages that are told together.
struct MessageLog::Fields {
    std::span<const std::string_view> names;
    RecentTexts& recent_names;
    std::span<const std::string_view> texts;
    RecentTexts* recent_texts;
    std::span<const UtcTime> times;
    std::span<const std::uint64_t> counts;
};

template <typename Recent, typename... Messages>
void MessageLog::append(Kind kind, Key key, Recent& recent, const Messages&... messages) {
    const auto names = arrayOf<std::string_view>(namesOf(messages)...);
    const auto texts = arrayOf<std::string_view>(textsOf(messages)...);
    const auto times = arrayOf<UtcTime>(timesOf(messages)...);
    const auto counts = arrayOf<std::uint64_t>(countsOf(messages)...);
    append(kind, key, {names, recent.names, texts, recent.texts.data(), times, counts});
}

/// One for all kinds: code, too, takes memory that is then missing in the caches.
void MessageLog::append(Kind kind, Key key, const Fields& fields) {
    const auto joined = before_->join(fields.names);
    auto most = 1 + Packer::mostOf(joined) +
                Packer::kMostOfInteger * (1 + fields.times.size() + fields.counts.size());
    for (const auto text : fields.texts) {
        most += Packer::mostOf(text);
    }
    auto& piece = pieceFor(most);
    auto* const room = piece.bytes.data() + piece.used;
    Packer packer(room, before_->integers);
    packer.byte(static_cast<std::uint8_t>(kind));
    packer.key(key);
    packer.put(joined, fields.recent_names);
    auto* recent = fields.recent_texts;
    for (const auto text : fields.texts) {
        packer.put(text, *recent++);
    }
    for (const auto time : fields.times) {
        packer.put(time);
    }
    for (const auto count : fields.counts) {
        packer.put(count);
    }
    piece.used += static_cast<std::size_t>(packer.end() - room);
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

void MessageLog::put(Key key, const WholeExecution& whole) {
    append(Kind::whole, key, before_->whole, whole.execution, whole.first, whole.last,
           whole.outcome);
    ++count_;
}

void MessageLog::giveTo(MessageTaker& taker) const {
    Before before;
    for (std::size_t i = 0; i < used_; ++i) {
        before.giveAll(std::span(pieces_[i].bytes).first(pieces_[i].used), taker);
    }
}

std::size_t MessageLog::give(std::span<const std::uint8_t> bytes, MessageTaker& taker) {
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
