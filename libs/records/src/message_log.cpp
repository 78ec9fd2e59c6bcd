#include "message_log.hpp"

#include <algorithm>
#include <cstring>
#include <string>
#include <type_traits>
#include <utility>

namespace metier::records {
namespace {

/// Of a piece; one message may need more [byte].
constexpr std::size_t kPiece = 256 * 1024;
/// Pieces that are kept: what a lively second takes.
constexpr std::size_t kMostKept = 64;

/// Of a text [byte].
using Length = std::uint32_t;

struct Begun {
    Execution execution{};
    Recorder::ToJson to_json = nullptr;
};
/// One that refers to what its caller has.
struct BegunAt {
    const Execution& execution;
    Recorder::ToJson to_json;
};

enum class Kind : std::uint8_t { begun, transition, intermediate, outcome };

Kind kindOf(const BegunAt& /*message*/) {
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

// What is kept of a message: the same list when it is put and when it is got.

template <typename Io, typename Message>
requires requires(Message& m) {
    m.to_json;
}
void fields(Io& io, Message& m) {
    auto& e = m.execution;
    io(m.to_json, e.id, e.server_name, e.skill, e.controller, e.device, e.parent, e.parent_server,
       e.session, e.client_name, e.user, e.thumbprint, e.parameters, e.check, e.started, e.state,
       e.reason, e.reason_text, e.result, e.missed_cycles);
}
template <typename Io, typename Message>
requires std::is_same_v<std::remove_const_t<Message>, Transition>
void fields(Io& io, Message& t) {
    io(t.time, t.from, t.to, t.sub_state, t.step, t.reason, t.reason_text);
}
template <typename Io, typename Message>
requires std::is_same_v<std::remove_const_t<Message>, Intermediate>
void fields(Io& io, Message& i) {
    io(i.time, i.value);
}
template <typename Io, typename Message>
requires std::is_same_v<std::remove_const_t<Message>, Outcome>
void fields(Io& io, Message& o) {
    io(o.time, o.state, o.reason, o.reason_text, o.result, o.missed_cycles);
}

/// How many bytes it takes.
class Size {
public:
    template <typename... Fields>
    void operator()(const Fields&... each) {
        (add(each), ...);
    }
    std::size_t bytes() const { return bytes_; }

private:
    void add(const std::string& text) { bytes_ += sizeof(Length) + text.size(); }
    template <typename T>
    void add(const T& value) {
        bytes_ += sizeof value;
    }

    std::size_t bytes_ = 0;
};

/// Into memory that has room for it.
class Put {
public:
    explicit Put(char* to) : to_(to) {}

    template <typename... Fields>
    void operator()(const Fields&... each) {
        (add(each), ...);
    }

private:
    void add(const std::string& text) {
        add(static_cast<Length>(text.size()));
        std::memcpy(to_, text.data(), text.size());
        to_ += text.size();
    }
    template <typename T>
    requires std::is_trivially_copyable_v<T>
    void add(const T& value) {
        std::memcpy(to_, &value, sizeof value);
        to_ += sizeof value;
    }

    char* to_;
};

class Get {
public:
    explicit Get(const char* from) : from_(from) {}

    template <typename... Fields>
    void operator()(Fields&... each) {
        (get(each), ...);
    }
    const char* position() const { return from_; }

private:
    void get(std::string& text) {
        Length size = 0;
        get(size);
        text.assign(from_, size);
        from_ += size;
    }
    template <typename T>
    requires std::is_trivially_copyable_v<T>
    void get(T& value) {
        std::memcpy(&value, from_, sizeof value);
        from_ += sizeof value;
    }

    const char* from_;
};

template <typename Message>
void giveOne(Get& get, Recorder::Key key, MessageTaker& taker) {
    Message message;
    fields(get, message);
    if constexpr (std::is_same_v<Message, Begun>) {
        taker.take(key, std::move(message.execution), message.to_json);
    } else {
        taker.take(key, std::move(message));
    }
}

void giveNext(Get& get, MessageTaker& taker) {
    Kind kind{};
    Recorder::Key key = 0;
    get(kind, key);
    switch (kind) {
        case Kind::begun:
            return giveOne<Begun>(get, key, taker);
        case Kind::transition:
            return giveOne<Transition>(get, key, taker);
        case Kind::intermediate:
            return giveOne<Intermediate>(get, key, taker);
        case Kind::outcome:
            return giveOne<Outcome>(get, key, taker);
    }
}

}  // namespace

char* MessageLog::room(std::size_t bytes) {
    if (used_ == 0 || pieces_[used_ - 1].bytes.size() - pieces_[used_ - 1].used < bytes) {
        if (used_ == pieces_.size()) {
            pieces_.emplace_back();
        }
        auto& next = pieces_[used_++];
        next.bytes.resize(std::max({bytes, kPiece, next.bytes.size()}));
        next.used = 0;
    }
    auto& piece = pieces_[used_ - 1];
    auto* const begin = piece.bytes.data() + piece.used;
    piece.used += bytes;
    return begin;
}

template <typename Message>
void MessageLog::append(Key key, const Message& message) {
    const auto kind = kindOf(message);
    Size size;
    size(kind, key);
    fields(size, message);
    Put put(room(size.bytes()));
    put(kind, key);
    fields(put, message);
    ++count_;
}

void MessageLog::put(Key key, const Execution& begun, Recorder::ToJson to_json) {
    append(key, BegunAt{begun, to_json});
}

void MessageLog::put(Key key, const Transition& transition) {
    append(key, transition);
}

void MessageLog::put(Key key, const Intermediate& intermediate) {
    append(key, intermediate);
}

void MessageLog::put(Key key, const Outcome& outcome) {
    append(key, outcome);
}

void MessageLog::giveTo(MessageTaker& taker) const {
    for (std::size_t i = 0; i < used_; ++i) {
        Get get(pieces_[i].bytes.data());
        const auto* const end = pieces_[i].bytes.data() + pieces_[i].used;
        while (get.position() != end) {
            giveNext(get, taker);
        }
    }
}

void MessageLog::clear() {
    count_ = 0;
    used_ = 0;
    pieces_.resize(std::min(pieces_.size(), kMostKept));
    std::erase_if(pieces_, [](const Piece& piece) { return piece.bytes.size() > kPiece; });
}

}  // namespace metier::records
