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

/// End of the execution of a used skill.
struct UsedSkillEnd {
    enum class Kind {
        finished,
        halted,
        refused,  ///< it did not begin
        lost,     ///< lost: its state is unknown from now on
    };
    Kind kind = Kind::finished;
    skill::ValueMap result{};  ///< empty unless it finished
    skill::Reason reason = skill::Reason::none;
    std::string text{};  ///< with value, limit and unit
};

/// The execution of a used skill begins to come to rest.
struct UsedSkillStop {
    skill::State to = skill::State::suspended;  ///< Halted or Suspended, at standstill
    skill::Reason reason = skill::Reason::by_client;
    std::string text{};  ///< "by CLIENT", or what is wrong
};

/// Clock of a used skill's server, compared with this machine's clock.
struct ClockOffset {
    /// How far the server's clock is ahead; negative: behind.
    std::chrono::nanoseconds ahead{0};
    std::chrono::nanoseconds uncertainty{0};  ///< bound of the error, in either direction
};

/// Listener to the execution of a used skill; each function does nothing unless overridden.
///
/// Threading: the owner's thread; never from inside a call to the UsedSkill.
class UsedSkillListener {
public:
    virtual ~UsedSkillListener() = default;
    /// Outcome of UsedSkill::reset().
    virtual void onReset(const Result<void>& /*outcome*/) {}
    /// The execution begins to come to rest, also if this side asked for it; onSuspended() or
    /// onEnd() follows. Not called for servers that do not publish it.
    virtual void onStopping(const UsedSkillStop& /*stop*/) {}
    /// The execution came to rest, at the request of any client.
    virtual void onSuspended() {}
    /// A suspended execution goes on.
    virtual void onResumed() {}
    /// The execution published an intermediate result.
    virtual void onProgress(const skill::Value& /*intermediate*/) {}
    /// A suspend(), resume() or halt() was refused; the execution goes on as before.
    virtual void onRefused(skill::Method /*method*/, const Error& /*error*/) {}
    /// The execution has ended. Called once for each begin().
    virtual void onEnd(UsedSkillEnd /*end*/) {}
};

/// A skill that a composed skill uses, in the same process or elsewhere.
///
/// One execution at a time.
/// Threading: the owner's thread; nothing waits.
class UsedSkill {
public:
    virtual ~UsedSkill() = default;
    /// Name for messages: "GraspGripperSkill of wsg50".
    virtual const std::string& name() const = 0;
    virtual const skill::SkillDescription& description() const = 0;
    /// Address of its server; empty for a skill of the same server.
    virtual std::string serverUrl() const { return {}; }

    /// Checks that the skill can be reached.
    /// Errors: connection_lost.
    virtual Result<void> available() const = 0;
    /// State of the skill, as last heard.
    virtual skill::State state() const = 0;
    /// Reason of its state, for a person.
    virtual std::string reasonText() const = 0;

    /// Whether the skill is Halted because it still ran on behalf of the composed skill after that
    /// had stopped waiting for it.
    virtual bool leftOver() const { return false; }
    /// Clears a fault; the outcome goes to `listener`.
    /// Errors: those of the skill, where they are known at once; then the listener is not called.
    virtual Result<void> reset(UsedSkillListener& listener) = 0;
    /// Asks whether begin() with these parameters would succeed now; nothing moves.
    /// \param done called once, in a later turn of the owner's thread, unless this is destroyed
    ///             before
    /// Errors, given to `done`: connection_lost, timeout, the server's.
    virtual void check(const skill::ValueMap& parameters,
                       std::function<void(Result<skill::CheckReport>)> done) = 0;
    /// Compares the clocks of the used skill's server and of this machine.
    /// \param done as that of check()
    virtual void compareClocks(std::function<void(Result<ClockOffset>)> done) = 0;

    /// Begins an execution; its events go to `listener`, the end as the last one. A suspend, resume
    /// or halt right after this call waits until the execution has begun.
    virtual void begin(skill::StartRequest request, UsedSkillListener& listener) = 0;
    /// Ask the running execution, whoever began it. A refusal that is known at once is the result;
    /// a later one goes to UsedSkillListener::onRefused().
    virtual Result<void> suspend() = 0;
    virtual Result<void> resume() = 0;
    virtual void halt() = 0;
    /// Detaches the listener: it is not called any more.
    virtual void release() = 0;
};

}  // namespace metier::composition
