#pragma once

#include <memory>
#include <optional>
#include <string>

#include "metier/composition/used_skill.hpp"
#include "metier/skill/executor.hpp"
#include "metier/skill/program_observer.hpp"

namespace metier::composition {

/// A skill of the same process. Its clock is this machine's, so compareClocks() always gives zero.
///
/// Threading: the owner's thread, which is the Program's.
///
/// The Program's answers come later, by the executor: no call of this class calls the listener or
/// `done` before it returns.
class LocalUsedSkill final : public UsedSkill, private skill::ProgramObserver {
public:
    /// \param program  must outlive this
    /// \param executor of the Program's thread; events of the listener come through it
    /// \param caller   client as which the composed skill commands the Program
    LocalUsedSkill(skill::Program& program, std::shared_ptr<skill::Executor> executor,
                   skill::Caller caller);
    /// Detaches from the Program; an execution that runs goes on.
    ~LocalUsedSkill() override;
    LocalUsedSkill(const LocalUsedSkill&) = delete;
    LocalUsedSkill& operator=(const LocalUsedSkill&) = delete;

    const std::string& name() const override { return program_.description().name; }
    const skill::SkillDescription& description() const override { return program_.description(); }
    /// Always: it lives as long as this.
    Result<void> available() const override { return {}; }
    /// Present state; it may have been changed by another client.
    skill::State state() const override { return program_.state(); }
    /// Text of the Program's last transition.
    std::string reasonText() const override { return program_.reasonText(); }
    /// Resets at once; listener.onReset() follows. The listener replaces an earlier one.
    /// Errors: those of Program::reset(); no call follows then.
    Result<void> reset(UsedSkillListener& listener) override;
    /// Asks the Program at once, `done` gets the report later; not if this ends before.
    void check(const skill::CheckRequest& request, skill::CheckDone done) override;
    void compareClocks(std::function<void(Result<ClockOffset>)> done) override;
    /// A refused Start is reported by listener.onEnd() with Kind::refused.
    void begin(skill::StartRequest request, UsedSkillListener& listener) override;
    /// Errors: those of Program::suspend(). listener.onSuspended() follows at standstill.
    Result<void> suspend() override { return program_.suspend(caller_); }
    /// Errors: those of Program::resume(). listener.onResumed() follows.
    Result<void> resume() override { return program_.resume(caller_); }
    /// A refused Halt is reported by listener.onRefused().
    void halt() override;
    /// Nothing is reported any more; an execution that runs goes on.
    void release() override { link_->listener = nullptr; }

private:
    /// Target of posted work; valid as long as both ends exist.
    /// A replaced listener leaves its Link with nullptr, so that what was posted for it does
    /// nothing.
    struct Link {
        UsedSkillListener* listener = nullptr;
    };

    // Calls of the Program. Only those of the execution that was begun here reach the listener.
    void onTransition(const skill::TransitionEvent& event) override;
    void onStopping(const skill::StoppingEvent& event) override;
    void onProgress(const skill::Value& intermediate) override;

    /// Posts `tell` to be called with the listener, outside of the call that is under way.
    template <typename Tell>
    void post(Tell tell);
    /// Posts `done` to be called with `answer`, outside of the call that is under way.
    template <typename Answer>
    void answer(std::function<void(Result<Answer>)> done, Result<Answer> answer);
    void end(UsedSkillEnd end);
    /// Outcome for the composed skill; a Reset while Suspended counts as halted.
    UsedSkillEnd endOf(const skill::TransitionEvent& event) const;

    skill::Program& program_;
    std::shared_ptr<skill::Executor> executor_;  // shared by what its thread owns
    skill::Caller caller_;
    std::string execution_;  // the execution that was begun here and has not ended
    // Shared with posted work, which may come after this; a new one for each listener.
    std::shared_ptr<Link> link_ = std::make_shared<Link>();
    // Posted answers ask it whether this is still there.
    std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
};

}  // namespace metier::composition
