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
        /// It reached its end; `result` is complete.
        finished,
        /// It was halted, by anybody, or reset while it was suspended.
        halted,
        /// It did not begin.
        refused,
        /// Its state is unknown from now on.
        lost,
    };
    /// Way in which it ended.
    Kind kind = Kind::finished;
    /// Values by the names of the skill's results; empty unless it finished.
    skill::ValueMap result{};
    /// Reason of the last transition.
    skill::Reason reason = skill::Reason::none;
    /// Text for a person, with value, limit and unit; may be empty.
    std::string text{};
};

/// The execution of a used skill begins to come to rest.
struct UsedSkillStop {
    /// State at standstill: Halted or Suspended.
    skill::State to = skill::State::suspended;
    /// Cause.
    skill::Reason reason = skill::Reason::by_client;
    /// Text for a person: "by CLIENT", or what is wrong.
    std::string text{};
};

/// Clock of a used skill's server, compared with this machine's clock.
struct ClockOffset {
    /// Time by which the server's clock is ahead; negative: behind.
    std::chrono::nanoseconds ahead{0};
    /// Bound of the error, in either direction.
    std::chrono::nanoseconds uncertainty{0};
};

/// Listener to the execution of a used skill; each function does nothing unless overridden.
///
/// Threading: the owner's thread; never from inside a call to the UsedSkill.
class UsedSkillListener {
public:
    virtual ~UsedSkillListener() = default;
    /// Reports the outcome of UsedSkill::reset().
    virtual void onReset(const Result<void>& /*outcome*/) {}
    /// Reports that the execution begins to come to rest, also if this side asked for it;
    /// onSuspended() or onEnd() follows. Not called for servers that do not publish it.
    virtual void onStopping(const UsedSkillStop& /*stop*/) {}
    /// Reports that the execution came to rest, at the request of any client.
    virtual void onSuspended() {}
    /// Reports that a suspended execution goes on.
    virtual void onResumed() {}
    /// Reports an intermediate result of the execution.
    virtual void onProgress(const skill::Value& /*intermediate*/) {}
    /// Reports that a suspend(), resume() or halt() was refused; the execution goes on as before.
    virtual void onRefused(skill::Method /*method*/, const Error& /*error*/) {}
    /// Reports that the execution has ended. Called once for each begin(), unless release() came
    /// before.
    virtual void onEnd(UsedSkillEnd /*end*/) {}
};

/// A skill that a composed skill uses, in the same process or elsewhere.
///
/// One execution at a time: begin(), then the listener's onEnd(), then the next.
/// Threading: the owner's thread; nothing waits.
class UsedSkill {
public:
    virtual ~UsedSkill() = default;
    /// Name for messages: "GraspGripperSkill of wsg50".
    virtual const std::string& name() const = 0;
    /// Parameters, results and whether it can be suspended; valid as long as this.
    virtual const skill::SkillDescription& description() const = 0;
    /// Address of its server; empty for a skill of the same server.
    virtual std::string serverUrl() const { return {}; }
    /// Lists for a person what an execution cannot have, since its server is of another maker: "no
    /// atomic start, no dead-man". Such a server does not record it either. Empty for servers of
    /// metier.
    virtual std::string lacks() const { return {}; }

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
    /// Whether it runs skills of others, so that it may move the arms of any server.
    virtual bool runsOthers() const { return !description().steps.empty(); }
    /// Asks whether begin() with these parameters would succeed; nothing moves. The keys of
    /// `starts` and of the answer's `ends` are addresses as serverUrl(); empty: this process' own
    /// server.
    /// \param done called once, in a later turn of the owner's thread, unless this is destroyed
    ///             before
    /// Errors, given to `done`: not_supported (it has no Check), connection_lost, timeout, the
    ///                          server's.
    virtual void check(const skill::CheckRequest& request, skill::CheckDone done) = 0;
    /// Compares the clocks of the used skill's server and of this machine.
    /// \param done as that of check()
    virtual void compareClocks(std::function<void(Result<ClockOffset>)> done) = 0;

    /// Begins an execution; its events go to `listener`, the end as the last one. A start that is
    /// refused is an end, too: UsedSkillEnd::Kind::refused. A suspend, resume or halt right after
    /// this call waits until the execution has begun.
    /// \param request  with an id that no execution had before
    /// \param listener must live until onEnd() or release()
    virtual void begin(skill::StartRequest request, UsedSkillListener& listener) = 0;
    /// Asks the running execution to come to rest, whoever began it. A refusal that is known at
    /// once is the result; a later one goes to UsedSkillListener::onRefused().
    virtual Result<void> suspend() = 0;
    /// Asks a suspended execution to go on; errors as suspend().
    virtual Result<void> resume() = 0;
    /// Asks the execution to brake and end; a refusal goes to UsedSkillListener::onRefused().
    virtual void halt() = 0;
    /// Detaches the listener: it is not called any more.
    virtual void release() = 0;
};

}  // namespace metier::composition
