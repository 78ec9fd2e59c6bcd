#include "message_log.hpp"

#include <algorithm>
#include <cstring>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>

namespace metier::records {
namespace {

/// Of a piece; one message may need more [byte].
constexpr std::size_t kPiece = 262'144;
/// Pieces that are kept: what a lively second takes.
constexpr std::size_t kMostKept = 64;

/// How long a text is, in one byte, unless it is one of these.
constexpr std::uint8_t kLong = 254;       // four bytes tell
constexpr std::uint8_t kAsBefore = 255;   // as in the message before of that kind
constexpr std::size_t kMostOfLength = 5;  // [byte]

/// A beginning that its teller has.
struct Beginning {
    const Execution& execution;
    Recorder::ToJson to_json;
};

enum class Kind : std::uint8_t { begun, transition, intermediate, outcome };

Kind kindOf(const Beginning& /*message*/) {
    return Kind::begun;
}
Kind kindOf(const Transition& /*message*/) {
    return Kind::transition;
}
Kind kindOf(const Intermediate& /*message*/) {
    return Kind::intermediate;
}
Kind kindOf(const Outcome& /*message*/) {
    return Kind::outcome;
}

// What is kept of a message, in its order.

template <typename Message>
requires requires(Message& m) {
    m.to_json;
}
auto fieldsOf(Message& m) {
    auto& e = m.execution;
    return std::tie(m.to_json, e.id, e.server_name, e.skill, e.controller, e.device, e.parent,
                    e.parent_server, e.session, e.client_name, e.user, e.thumbprint, e.parameters,
                    e.check, e.started, e.state, e.reason, e.reason_text, e.result,
                    e.missed_cycles);
}
template <typename Message>
requires requires(Message& m) {
    m.sub_state;
}
auto fieldsOf(Message& t) {
    return std::tie(t.time, t.from, t.to, t.sub_state, t.step, t.reason, t.reason_text);
}
auto fieldsOf(const Intermediate& i) {
    return std::tie(i.time, i.value);
}
auto fieldsOf(Intermediate& i) {
    return std::tie(i.time, i.value);
}
template <typename Message>
requires requires(Message& m) {
    m.result, m.time;
}
auto fieldsOf(Message& o) {
    return std::tie(o.time, o.state, o.reason, o.reason_text, o.result, o.missed_cycles);
}

/// How many bytes they take at most.
struct Size {
    static std::size_t of(const std::string& text) { return kMostOfLength + text.size(); }
    template <typename T>
    static std::size_t of(const T& value) {
        return sizeof value;
    }
    template <typename... Fields>
    std::size_t operator()(const Fields&... each) const {
        return (of(each) + ...);
    }
};

/// Into memory that has room for it.
class Put {
public:
    explicit Put(char* to) : to_(to) {}
    const char* position() const { return to_; }

    template <typename T>
    requires std::is_trivially_copyable_v<T>
    void value(const T& put) { bytes(&put, sizeof put); }
    void field(const std::string& text, std::string& before) {
        if (text == before) {
            value(kAsBefore);
            return;
        }
        before = text;
        if (text.size() < kLong) {
            value(static_cast<std::uint8_t>(text.size()));
        } else {
            value(kLong);
            value(static_cast<std::uint32_t>(text.size()));
        }
        bytes(text.data(), text.size());
    }
    template <typename T>
    void field(const T& field, T& /*before*/) {
        value(field);
    }

private:
    void bytes(const void* from, std::size_t size) {
        std::memcpy(to_, from, size);
        to_ += size;
    }

    char* to_;
};

class Get {
public:
    explicit Get(const char* from) : from_(from) {}
    const char* position() const { return from_; }

    template <typename T>
    requires std::is_trivially_copyable_v<T> T value() {
        T got{};
        std::memcpy(&got, from_, sizeof got);
        from_ += sizeof got;
        return got;
    }
    void field(std::string& text, std::string& before) {
        const auto length = value<std::uint8_t>();
        if (length != kAsBefore) {
            const std::size_t size = length == kLong ? value<std::uint32_t>() : length;
            before.assign(from_, size);
            from_ += size;
        }
        text = before;
    }
    template <typename T>
    void field(T& field, T& /*before*/) {
        field = value<T>();
    }

private:
    const char* from_;
};

/// Puts or gets each field, beside that of the message before of its kind.
template <typename Io, typename Message, typename Before>
void exchange(Io& io, Message& message, Before& before) {
    const auto fields = fieldsOf(message);
    const auto befores = fieldsOf(before);
    [&]<std::size_t... I>(std::index_sequence<I...> /*all*/) {
        (io.field(std::get<I>(fields), std::get<I>(befores)), ...);
    }
    (std::make_index_sequence<std::tuple_size_v<decltype(befores)>>{});
}

template <typename Message>
void giveOne(Get& get, Recorder::Key key, Message& before, MessageTaker& taker) {
    Message message;
    exchange(get, message, before);
    if constexpr (std::is_same_v<Message, Begun>) {
        taker.take(key, std::move(message.execution), message.to_json);
    } else {
        taker.take(key, std::move(message));
    }
}

void giveNext(Get& get, LatestMessages& before, MessageTaker& taker) {
    const auto kind = get.value<Kind>();
    const auto key = get.value<Recorder::Key>();
    switch (kind) {
        case Kind::begun:
            return giveOne(get, key, before.begun, taker);
        case Kind::transition:
            return giveOne(get, key, before.transition, taker);
        case Kind::intermediate:
            return giveOne(get, key, before.intermediate, taker);
        case Kind::outcome:
            return giveOne(get, key, before.outcome, taker);
    }
}

/// They keep their memory.
template <typename Message>
void clearTexts(Message& message) {
    const auto clear = [](auto& field) {
        if constexpr (std::is_same_v<decltype(field), std::string&>) {
            field.clear();
        }
    };
    std::apply([&](auto&... each) { (clear(each), ...); }, fieldsOf(message));
}

}  // namespace

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

template <typename Message, typename Before>
void MessageLog::append(Key key, const Message& message, Before& before) {
    const auto kind = kindOf(message);
    const auto most = sizeof kind + sizeof key + std::apply(Size{}, fieldsOf(message));
    auto& piece = pieceFor(most);
    auto* const begin = piece.bytes.data() + piece.used;
    Put put(begin);
    put.value(kind);
    put.value(key);
    exchange(put, message, before);
    piece.used += static_cast<std::size_t>(put.position() - begin);
    ++count_;
}

void MessageLog::put(Key key, const Execution& begun, Recorder::ToJson to_json) {
    append(key, Beginning{begun, to_json}, latest_.begun);
}

void MessageLog::put(Key key, const Transition& transition) {
    append(key, transition, latest_.transition);
}

void MessageLog::put(Key key, const Intermediate& intermediate) {
    append(key, intermediate, latest_.intermediate);
}

void MessageLog::put(Key key, const Outcome& outcome) {
    append(key, outcome, latest_.outcome);
}

void MessageLog::giveTo(MessageTaker& taker) const {
    LatestMessages before;
    for (std::size_t i = 0; i < used_; ++i) {
        Get get(pieces_[i].bytes.data());
        const auto* const end = pieces_[i].bytes.data() + pieces_[i].used;
        while (get.position() != end) {
            giveNext(get, before, taker);
        }
    }
}

void MessageLog::clear() {
    count_ = 0;
    used_ = 0;
    // Whoever reads the next message begins without any before it.
    clearTexts(latest_.begun);
    clearTexts(latest_.transition);
    clearTexts(latest_.intermediate);
    clearTexts(latest_.outcome);
    pieces_.resize(std::min(pieces_.size(), kMostKept));
    std::erase_if(pieces_, [](const Piece& piece) { return piece.bytes.size() > kPiece; });
}

}  // namespace metier::records
