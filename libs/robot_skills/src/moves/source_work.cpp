#include "moves/source_work.hpp"

#include <utility>

namespace metier::robot_skills {

using Request = MotionRunSource::Request;

SourceWork::SourceWork(device::Arm& arm, std::shared_ptr<MotionRunSource> source,
                       ToolPose tool_pose)
    : ArmWork(arm, std::move(tool_pose)), source_(std::move(source)) {}

SourceWork::~SourceWork() {
    source_->request(Request::halt);
}

void SourceWork::start(skill::ExecutionHandle execution) {
    begin(std::move(execution), [source = source_] { return source->attached(); });
    source_->begin(this->execution());
    if (auto attached = arm().attach(source_); !attached) {
        source_->abandon();
        this->execution().fail(skill::Reason::error, attached.error().message);
    }
}

Result<void> SourceWork::suspend() {
    source_->request(Request::suspend);
    return {};
}

Result<void> SourceWork::resume() {
    METIER_TRY(checkNotMoved(source_->restingPlace()));
    source_->beginAgain(arm().state().commanded_position);
    auto attached = arm().attach(source_);
    if (!attached) {
        source_->abandon();
    }
    return attached;
}

void SourceWork::halt() {
    if (source_->attached()) {
        source_->request(Request::halt);
    } else {
        execution().atRest();
    }
}

void SourceWork::forceStop() noexcept {
    if (source_->attached()) {
        arm().stop();
    }
}

}  // namespace metier::robot_skills
