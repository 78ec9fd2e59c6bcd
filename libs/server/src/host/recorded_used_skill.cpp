#include "host/recorded_used_skill.hpp"

#include <optional>
#include <utility>

#include "metier/composition/wrapped_used_skill.hpp"

namespace metier::server {
namespace {

using composition::UsedSkill;
using composition::UsedSkillEnd;
using skill::State;

class RecordedUsedSkill final : public composition::WrappedUsedSkill {
public:
    RecordedUsedSkill(std::unique_ptr<UsedSkill> used, std::shared_ptr<ForeignRecords> records,
                      ForeignPlace place)
        : WrappedUsedSkill(std::move(used)),
          records_(std::move(records)),
          place_(std::move(place)) {}

    void begin(skill::StartRequest request, UsedSkillListener& listener) override {
        execution_.reset();
        if (const auto lacks = used().lacks(); !lacks.empty()) {
            execution_.emplace(records_, place_, request, lacks);
        }
        WrappedUsedSkill::begin(std::move(request), listener);
    }
    void release() override {
        execution_.reset();
        WrappedUsedSkill::release();
    }

private:
    void onSuspended() override {
        if (execution_) {
            execution_->add(State::running, State::suspended);
        }
        WrappedUsedSkill::onSuspended();
    }
    void onResumed() override {
        if (execution_) {
            execution_->add(State::suspended, State::running);
        }
        WrappedUsedSkill::onResumed();
    }
    void onEnd(UsedSkillEnd end) override {
        if (execution_) {
            execution_->end(end);
        }
        WrappedUsedSkill::onEnd(std::move(end));
    }

    std::shared_ptr<ForeignRecords> records_;  // shared with the other used skills
    const ForeignPlace place_;
    std::optional<ForeignExecution> execution_;  // the last one that is recorded
};

}  // namespace

std::unique_ptr<composition::UsedSkill> recorded(std::unique_ptr<composition::UsedSkill> used,
                                                 std::shared_ptr<ForeignRecords> records,
                                                 ForeignPlace place) {
    return std::make_unique<RecordedUsedSkill>(std::move(used), std::move(records),
                                               std::move(place));
}

}  // namespace metier::server
