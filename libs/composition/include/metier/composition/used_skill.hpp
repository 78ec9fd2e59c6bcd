#pragma once

#include <chrono>
#include <functional>
#include <string>

#include "metier/base/error.hpp"
#include "metier/skill/program.hpp"
#include "metier/skill/skill.hpp"
#include "metier/skill/state.hpp"
#include "metier/skill/value.hpp"

namespace metier::composition {

/// How the execution of a used skill ended.
struct UsedSkillEnd {
    enum class Kind {
        finished,
        halted,
        refused,  ///< it did not begin
        lost,     ///< nothing is known of it any more
    };
    Kind kind = Kind::finished;
    skill::ValueMap result{};  ///< of one that finished
    skill::Reason reason = skill::Reason::none;
    std::string text{};  ///< with value, limit and unit
};

/// The execution of a used skill begins to come to rest.
struct UsedSkillStop {
    skill::State to = skill::State::suspended;  ///< Halted or Suspended, at standstill
    skill::Reason reason = skill::Reason::by_client;
    std::string text{};  ///< "by CLIENT", or what is wrong
};

/// How far the clock of a used skill's server is ahead of this machine's.
struct ClockOffset {
    std::chrono::nanoseconds ahead{0};
    std::chrono::nanoseconds uncertainty{0};  ///< it may be wrong by that much either way
};

/// Observer of an execution of a used skill; each function does nothing unless it is overridden.
///
/// Threading: the owner's thread; never from inside a call to the UsedSkill.
class UsedSkillListener {
public:
    virtual ~UsedSkillListener() = default;
    /// Answers UsedSkill::reset().
    virtual void onReset(const Result<void>& /*outcome*/) {}
    /// It begins to come to rest, also at a request from here; onSuspended() or onEnd() follows.
    /// Not called by servers that do not say so.
    virtual void onStopping(const UsedSkillStop& /*stop*/) {}
    /// It came to rest; at whoever's request.
    virtual void onSuspended() {}
    virtual void onResumed() {}
    virtual void onProgress(const skill::Value& /*intermediate*/) {}
    /// A suspend(), resume() or halt() was refused; all goes on as before.
    virtual void onRefused(skill::Method /*method*/, const Error& /*error*/) {}
    /// Once for each begin().
    virtual void onEnd(UsedSkillEnd /*end*/) {}
};

/// A skill that a composed skill uses, in the same process or elsewhere.
///
/// One execution at a time. Threading: the owner's thread; nothing waits.
class UsedSkill {
public:
    virtual ~UsedSkill() = default;
    /// For texts: "GraspGripperSkill of wsg50".
    virtual const std::string& name() const = 0;
    virtual const skill::SkillDescription& description() const = 0;
    /// Address of its server; empty for a skill of the same server.
    virtual std::string serverUrl() const { return {}; }

    /// Whether it can be reached.
    /// Errors: connection_lost.
    virtual Result<void> available() const = 0;
    /// As far as is known here.
    virtual skill::State state() const = 0;
    /// Why it is in its state.
    virtual std::string reasonText() const = 0;

    /// Whether it is Halted because it still ran for the composed skill when nobody waited for it.
    virtual bool leftOver() const { return false; }
    /// Clears a fault; `listener` hears the outcome.
    /// Errors: it refuses, where that is known at once; then the listener is not called.
    virtual Result<void> reset(UsedSkillListener& listener) = 0;
    /// Asks what begin() with these parameters would say now; nothing moves.
    /// \param done called once, in a later turn of the owner's thread, as long as this is there.
    ///             Errors: connection_lost, timeout, the server's
    virtual void check(const skill::ValueMap& parameters,
                       std::function<void(Result<skill::CheckReport>)> done) = 0;
    /// Compares the clocks of the used skill's server and of this machine.
    /// \param done as that of check()
    virtual void compareClocks(std::function<void(Result<ClockOffset>)> done) = 0;

    /// Begins; `listener` hears what follows, its end at the latest. What is asked of the execution
    /// right after this waits until it has begun.
    virtual void begin(skill::StartRequest request, UsedSkillListener& listener) = 0;
    /// Ask what runs, begun here or not; what is refused is told, at once where it is known.
    virtual Result<void> suspend() = 0;
    virtual Result<void> resume() = 0;
    virtual void halt() = 0;
    /// The listener is not called any more.
    virtual void release() = 0;
};

}  // namespace metier::composition
