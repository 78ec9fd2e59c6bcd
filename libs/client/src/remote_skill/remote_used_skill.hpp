#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "metier/composition/used_skill.hpp"
#include "remote_skill/connection.hpp"

namespace metier::client {

/// A skill of another server, by asynchronous requests and events.
///
/// Threading: the owner's thread.
class RemoteUsedSkill final : public composition::UsedSkill {
public:
    /// \param connection must outlive this
    /// \param name       for texts
    /// \param origin     as the ids of executions begin that are begun here
    RemoteUsedSkill(Connection& connection, std::shared_ptr<UsedSkillLink> link, std::string name,
                    std::string origin);
    ~RemoteUsedSkill() override;
    RemoteUsedSkill(const RemoteUsedSkill&) = delete;
    RemoteUsedSkill& operator=(const RemoteUsedSkill&) = delete;

    const std::string& name() const override { return name_; }
    const skill::SkillDescription& description() const override { return description_; }
    std::string serverUrl() const override { return connection_.options().url; }
    std::string lacks() const override { return lacks_; }
    Result<void> available() const override;
    skill::State state() const override { return state_; }
    std::string reasonText() const override { return reason_text_; }
    bool leftOver() const override { return left_over_; }
    Result<void> reset(composition::UsedSkillListener& listener) override;
    bool runsOthers() const override { return runs_others_; }
    void check(const skill::CheckRequest& request, skill::CheckDone done) override;
    void compareClocks(std::function<void(Result<composition::ClockOffset>)> done) override;
    void begin(skill::StartRequest request, composition::UsedSkillListener& listener) override;
    Result<void> suspend() override;
    Result<void> resume() override { return command(skill::Method::resume); }
    void halt() override;
    void release() override;

    // Reports of the connection.
    void adopt(std::shared_ptr<OpenSkill> skill, const client::AsyncSkill::Now& now);
    void refresh(const client::AsyncSkill::Now& now);
    void lost(const std::string& why);
    void onTransition(const skill::TransitionEvent& event);
    void onStopping(const skill::StoppingEvent& event);
    /// Transitions may have been missed.
    void onMissed();

private:
    using UsedSkillEnd = composition::UsedSkillEnd;

    /// A Check that is not answered yet.
    struct OpenCheck {
        skill::CheckRequest request;
        skill::CheckDone done;
        SteadyTime deadline;
        skill::Timer pause{};  ///< until it is asked again
    };
    void askCheck(std::uint64_t number);
    void checked(std::uint64_t number, const opcua::Answer<skill::CheckReport>& answer);

    bool isOurs(const std::string& execution) const;
    void started(const std::string& id, const opcua::Answer<std::string>& answer);
    void finished();
    void caughtUp(const std::string& id, const opcua::Answer<skill::ExecutionRecord>& record);
    void tellMissed(const skill::ExecutionRecord& record);
    void tell(void (composition::UsedSkillListener::*event)());
    /// Reports Suspended or Running of the execution, unless that was reported last.
    void report(skill::State state);
    void end(UsedSkillEnd end);
    void endHalted(skill::Reason reason, std::string text);
    void endLost(std::string text);
    /// \param call the Reset that is answered
    void wasReset(std::uint64_t call, const opcua::Answer<>& answer);
    void tellReset(const Result<void>& outcome);
    /// Sends a command; a refusal goes to the listener.
    Result<void> command(skill::Method method);
    /// \param id of the execution that it was meant for
    void refused(skill::Method method, const std::string& id, const opcua::Failure& failure);
    void haltIfRuns(const std::string& id);
    void haltLeftOver(const std::string& id);
    /// Has `then` called with the skill's state and the server's reason for the last refusal, or
    /// else with `otherwise`, and Halted.
    void withReason(std::string otherwise,
                    std::function<void(RemoteUsedSkill&, const client::AsyncSkill::Now&)> then);
    void drop();

    Connection& connection_;
    std::shared_ptr<UsedSkillLink> link_;  // shared with messages that are on their way here
    std::string name_;
    std::string origin_;
    skill::SkillDescription description_;
    std::string lacks_;
    bool runs_others_ = false;
    std::map<std::uint64_t, OpenCheck> checks_;  // by their numbers
    std::uint64_t check_count_ = 0;
    // Shared with the work that waits for the server; null: lost
    std::shared_ptr<OpenSkill> skill_;
    std::string lost_;  // why there is none
    skill::State state_ = skill::State::halted;
    skill::State reported_ = skill::State::running;  // of the execution, to the listener
    std::string reason_text_;
    bool left_over_ = false;
    // An execution was under way when the connection was lost, at a server that names none.
    bool may_run_on_ = false;
    // The Reset whose answer is awaited; nothing if none is. Earlier ones have lower numbers.
    std::optional<std::uint64_t> reset_;
    std::uint64_t reset_count_ = 0;

    composition::UsedSkillListener* listener_ = nullptr;
    std::string execution_;  // begun here and not over
    std::string unsure_;     // maybe runs, to be asked for once execution_ is over
    bool started_ = false;   // the server has said so
    bool missed_ = false;    // transitions may have been missed before it said so
    bool halt_wanted_ = false;
    bool suspend_wanted_ = false;
};

}  // namespace metier::client
