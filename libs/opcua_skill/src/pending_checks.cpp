#include "pending_checks.hpp"

#include <chrono>
#include <utility>

namespace metier::opcua_skill {

namespace {

using namespace std::chrono_literals;

// Longer than any check takes; an answer that nobody fetched is of no use after that time.
constexpr auto kForgotten = 30s;

}  // namespace

Result<skill::CheckReport> PendingChecks::answer(const opcua::NodeId& session,
                                                 const skill::CheckRequest& request,
                                                 skill::Executor& executor, const Ask& ask) {
    auto found = questions_.find(session);
    if (found == questions_.end() || found->second->request != request) {
        auto question = std::make_shared<Question>(Question{request});
        question->forgotten =
            executor.after(kForgotten, [this, session] { questions_.erase(session); });
        found = questions_.insert_or_assign(session, question).first;
        ask(request, [asked = std::weak_ptr(question)](Result<skill::CheckReport> answer) {
            if (const auto open = asked.lock()) {
                open->answer = std::move(answer);
            }
        });
    }
    if (!found->second->answer) {
        return fail(Errc::timeout, "Check: the used skills are asked; call it again");
    }
    auto answer = std::move(*found->second->answer);
    questions_.erase(found);
    return answer;
}

}  // namespace metier::opcua_skill
