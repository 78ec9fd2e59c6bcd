#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "metier/records/execution.hpp"
#include "metier/records/recorder.hpp"

namespace metier::records {

/// Who takes what a recorder was told.
class MessageTaker {
public:
    virtual ~MessageTaker() = default;
    virtual void take(Recorder::Key key, Execution&& execution, Recorder::ToJson to_json) = 0;
    virtual void take(Recorder::Key key, Transition&& transition) = 0;
    virtual void take(Recorder::Key key, Intermediate&& intermediate) = 0;
    virtual void take(Recorder::Key key, Outcome&& outcome) = 0;
};

/// The beginning of an execution.
struct Begun {
    Execution execution{};
    Recorder::ToJson to_json = nullptr;
};

/// One of each kind.
struct LatestMessages {
    Begun begun{};
    Transition transition{};
    Intermediate intermediate{};
    Outcome outcome{};
};

/// Messages to a recorder, one after the other in pieces of memory that are used again and again:
/// putting one is copying those of its texts that are not as before, and leaves nothing that
/// another thread has to free.
///
/// Threading: one thread at a time.
class MessageLog {
public:
    using Key = Recorder::Key;

    /// Its number, server and end are not kept.
    void put(Key key, const Execution& begun, Recorder::ToJson to_json);
    void put(Key key, const Transition& transition);
    void put(Key key, const Intermediate& intermediate);
    void put(Key key, const Outcome& outcome);

    std::size_t count() const noexcept { return count_; }
    /// In the order in which they were put.
    void giveTo(MessageTaker& taker) const;
    /// Keeps its memory, unless that is more than a lively second takes.
    void clear();

private:
    template <typename Message, typename Before>
    void append(Key key, const Message& message, Before& before);

    /// Holds whole messages.
    struct Piece {
        std::vector<char> bytes;
        std::size_t used = 0;
    };
    Piece& pieceFor(std::size_t most);

    std::vector<Piece> pieces_;
    std::size_t used_ = 0;  // pieces with messages; the others wait to be used again
    std::size_t count_ = 0;
    LatestMessages latest_;  // of each kind that was put
};

}  // namespace metier::records
