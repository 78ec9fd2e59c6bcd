#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "database.hpp"
#include "metier/records/execution.hpp"
#include "metier/records/recorder.hpp"

namespace metier::records {

/// Who takes what a recorder was told.
class MessageTaker {
public:
    virtual ~MessageTaker() = default;
    virtual void take(Recorder::Key key, Execution&& execution) = 0;
    virtual void take(Recorder::Key key, Transition&& transition) = 0;
    virtual void take(Recorder::Key key, Intermediate&& intermediate) = 0;
    virtual void take(Recorder::Key key, Outcome&& outcome) = 0;
};

/// A sample and whose it is.
struct KeyedSample {
    Recorder::Key key = 0;
    PathSample sample{};
};

/// Messages to a recorder, one after the other in pieces of memory that are used again and again:
/// a text that is among the last ones of its field is a byte there, so that an execution takes some
/// sixty, and putting a message leaves nothing that another thread has to free.
///
/// Threading: one thread at a time.
class MessageLog {
public:
    using Key = Recorder::Key;

    MessageLog();
    ~MessageLog();
    MessageLog(MessageLog&&) noexcept;
    MessageLog& operator=(MessageLog&&) noexcept;

    /// Its number, server and end are not kept.
    void put(Key key, const ExecutionView& begun);
    void put(Key key, const TransitionView& transition);
    void put(Key key, const IntermediateView& intermediate);
    void put(Key key, const OutcomeView& outcome);
    // Two at once, which count as one.
    void put(Key key, const ExecutionView& begun, const TransitionView& first);
    void put(Key key, const TransitionView& last, const OutcomeView& outcome);
    /// All of an execution, which count as two.
    void put(Key key, const WholeExecution& whole);

    std::size_t count() const noexcept { return count_; }
    /// In the order in which they were put.
    void giveTo(MessageTaker& taker) const;
    /// Appends all of them, for give() of any process.
    void appendTo(Bytes& bytes) const;
    /// What appendTo() appends [byte].
    std::size_t size() const noexcept;
    /// Gives what appendTo() has appended, up to what is damaged.
    /// \return how many, as count() counts them
    static std::size_t give(std::span<const std::uint8_t> bytes, MessageTaker& taker);
    /// Keeps its memory, unless that is more than a lively second takes.
    void clear();

private:
    struct Before;
    enum class Kind : std::uint8_t {
        begun,
        transition,
        intermediate,
        outcome,
        started,
        ended,
        whole
    };
    struct Fields;
    template <typename Recent, typename... Messages>
    void append(Kind kind, Key key, Recent& recent, const Messages&... messages);
    void append(Kind kind, Key key, const Fields& fields);

    /// Holds whole messages.
    struct Piece {
        Bytes bytes;
        std::size_t used = 0;
    };
    Piece& pieceFor(std::size_t most);

    std::vector<Piece> pieces_;
    std::size_t used_ = 0;  // pieces with messages; the others wait to be used again
    std::size_t count_ = 0;
    std::unique_ptr<Before> before_;
};

}  // namespace metier::records
