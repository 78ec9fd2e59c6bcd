#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "metier/client/async_skill.hpp"
#include "metier/server/foreign_records.hpp"

namespace metier::dashboard {

/// Store for what is started at one server that records nothing itself.
struct ForeignStore {
    std::shared_ptr<server::ForeignRecords> records;  // shared by all sessions; null: none
    std::string server_url;                           // as records name the server
};

/// Record of what a session has started last at one skill whose server records nothing.
///
/// Threading: any.
class ForeignRun : public std::enable_shared_from_this<ForeignRun> {
public:
    explicit ForeignRun(ForeignStore store) : store_(std::move(store)) {}

    /// Begins the record of a start that is about to be sent. The one before is settled first,
    /// which may wait for the server.
    /// \param request with the name of the execution
    void begin(const std::shared_ptr<client::AsyncSkill>& skill,
               const skill::StartRequest& request);
    /// Notes the answer to the start; a refusal ends the record.
    void answered(const opcua::Answer<std::string>& answer);
    /// Adds a Suspend or Resume of the skill.
    void note(const skill::TransitionEvent& event);
    /// Asks the server what has become of the execution; does not wait. If it is over, the record
    /// ends.
    void look();
    /// Notes that a Halt is about to be sent here: if the skill is halted next, this is why.
    /// \param why for a person
    void expectHalt(const std::string& why);
    /// Asks what has become of the execution, and ends the record with it; waits for the server. If
    /// it is not over, it ends with the Halt that was expected, or as lost.
    void settle();

private:
    struct Open {
        std::shared_ptr<client::AsyncSkill> skill;  // null: none is open
        std::string id;
    };
    /// The execution whose record is open and whose start was accepted.
    Open open();
    void looked(const std::string& id, const opcua::Answer<skill::ExecutionRecord>& record);
    void end(const std::string& id, const composition::UsedSkillEnd& end);

    const ForeignStore store_;
    std::mutex mutex_;
    // Guarded by mutex_. The skill belongs to the session.
    std::weak_ptr<client::AsyncSkill> skill_;
    std::string id_;         // of the execution whose record is open
    bool started_ = false;   // its start was accepted
    std::string halted_by_;  // expectHalt()
    std::optional<server::ForeignExecution> execution_;
};

}  // namespace metier::dashboard
