#include "moves/source_body.hpp"

#include <utility>

namespace metier::robot_skills {

using Request = ExecutionSource::Request;

SourceBody::SourceBody(device::Arm& arm, std::shared_ptr<ExecutionSource> source,
                       ToolDistance tool_distance)
    : ArmBody(arm, std::move(tool_distance)), source_(std::move(source)) {}

SourceBody::~SourceBody() {
    source_->request(Request::halt);
}

void SourceBody::start(skill::Execution execution) {
    begin(std::move(execution), [source = source_] { return source->attached(); });
    source_->begin(this->execution());
    if (auto attached = arm().attach(source_); !attached) {
        source_->abandon();
        this->execution().fail(skill::Reason::error, attached.error().message);
    }
}

Result<void> SourceBody::suspend() {
    source_->request(Request::suspend);
    return {};
}

Result<void> SourceBody::resume() {
    if (auto checked = checkNotMoved(source_->restingPlace()); !checked) {
        return checked;
    }
    source_->beginAgain(arm().state().commanded_position);
    auto attached = arm().attach(source_);
    if (!attached) {
        source_->abandon();
    }
    return attached;
}

void SourceBody::halt() {
    if (source_->attached()) {
        source_->request(Request::halt);
    } else {
        execution().atRest();
    }
}

void SourceBody::forceStop() noexcept {
    if (source_->attached()) {
        arm().stop();
    }
}

}  // namespace metier::robot_skills
