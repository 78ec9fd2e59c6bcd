#include "pending_checks.hpp"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <utility>

namespace metier::opcua_skill {

namespace {

using namespace std::chrono_literals;

// Longer than any check takes; an answer that nobody fetched is of no use after that time.
constexpr auto kForgotten = 30s;
// Questions of one session, which may be that of a component with clients of its own.
constexpr std::size_t kMost = 8;

}  // namespace

Result<skill::CheckReport> PendingChecks::answer(const opcua::NodeId& session,
                                                 const skill::CheckRequest& request,
                                                 skill::Executor& executor, const Ask& ask) {
    auto& questions = questions_[session];
    auto found = std::find_if(questions.begin(), questions.end(),
                              [&](const auto& one) { return one->request == request; });
    if (found == questions.end()) {
        if (questions.size() == kMost) {
            questions.pop_front();
        }
        questions.push_back(std::make_shared<Question>(Question{request}));
        found = std::prev(questions.end());
        begin(session, *found, executor, ask);
    }
    if (!(*found)->answer) {
        return fail(Errc::timeout, "Check: the used skills are asked; call it again");
    }
    auto answer = std::move(*(*found)->answer);
    questions.erase(found);
    return answer;
}

void PendingChecks::begin(const opcua::NodeId& session, const std::shared_ptr<Question>& question,
                          skill::Executor& executor, const Ask& ask) {
    question->forgotten = executor.after(kForgotten, [this, session, old = question.get()] {
        std::erase_if(questions_[session], [old](const auto& one) { return one.get() == old; });
    });
    ask(question->request, [asked = std::weak_ptr(question)](Result<skill::CheckReport> answer) {
        if (const auto open = asked.lock()) {
            open->answer = std::move(answer);
        }
    });
}

}  // namespace metier::opcua_skill
