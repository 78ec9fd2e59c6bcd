#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>

#include "metier/opcua/node_id.hpp"
#include "metier/skill/executor.hpp"
#include "metier/skill/skill.hpp"

namespace metier::opcua_skill {

/// Answers of Check that take longer than the call. The session that asks again gets the answer.
///
/// Eight questions of each session; one more replaces the oldest. Threading: the server's thread.
class PendingChecks {
public:
    using Ask = std::function<void(const skill::CheckRequest& request, skill::CheckDone done)>;

    /// Asks, or takes the answer to the same question of that session.
    /// \param executor of the server's thread
    /// Errors: timeout: the answer is not there yet, or there will be none.
    Result<skill::CheckReport> answer(const opcua::NodeId& session,
                                      const skill::CheckRequest& request, skill::Executor& executor,
                                      const Ask& ask);
    void sessionClosed(const opcua::NodeId& session) { questions_.erase(session); }

private:
    struct Question {
        skill::CheckRequest request;
        std::optional<Result<skill::CheckReport>> answer{};
        skill::Timer forgotten{};
    };
    void begin(const opcua::NodeId& session, const std::shared_ptr<Question>& question,
               skill::Executor& executor, const Ask& ask);

    // Oldest first. Not shared: an answer that comes later looks whether its question is still
    // there.
    std::map<opcua::NodeId, std::deque<std::shared_ptr<Question>>> questions_;
};

}  // namespace metier::opcua_skill
