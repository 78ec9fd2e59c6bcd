#include "motion_slot.hpp"

#include <fmt/format.h>

#include <utility>

#include "commands.hpp"

namespace metier::iiwa_driver {

namespace {

std::string errorNote(int code) {
    return code == 0 ? "" : fmt::format(" (error {}: {})", code, errorText(code));
}

}  // namespace

bool MotionSlot::occupied() const {
    const std::lock_guard lock(mutex_);
    return job_ != nullptr;
}

bool MotionSlot::post(const device::ControllerPlannedMotion& motion, Done done) {
    const std::lock_guard lock(mutex_);
    if (job_) {
        return false;
    }
    job_ = std::make_unique<Job>(Job{motion, std::move(done)});
    stop_target_.store(nullptr);
    posted_.store(&job_->motion);
    return true;
}

bool MotionSlot::stopRequested() noexcept {
    const auto* motion = posted_.load();
    if (motion != nullptr && stop_target_.exchange(nullptr) == motion) {
        stopping_ = true;
    }
    return stopping_;
}

void MotionSlot::end(const RunEnd& end) noexcept {
    if (posted_.exchange(nullptr) == nullptr) {
        return;
    }
    stopping_ = false;
    end_ = end;
    ended_.store(true);
}

void MotionSlot::dispatch(const std::string& name, const std::string& lost) {
    if (!ended_.exchange(false)) {
        return;
    }
    const RunEnd end = end_;
    std::unique_ptr<Job> job;
    {
        const std::lock_guard lock(mutex_);
        job = std::move(job_);
    }
    job->done(outcomeOf(end, name, lost));
}

Result<device::MotionOutcome> outcomeOf(const RunEnd& end, const std::string& name,
                                        const std::string& lost) {
    using Cause = RunEnd::Cause;
    switch (end.cause) {
        case Cause::at_target:
        case Cause::stopped:
        case Cause::force:
            return end.outcome;
        case Cause::refused:
            return fail(Errc::device_fault,
                        fmt::format("{}: the cabinet refused: {}{}", name, describe(end.command),
                                    errorNote(end.error)));
        case Cause::not_ready:
            return fail(Errc::device_fault, fmt::format("{}: not ready to move: {}{}", name,
                                                        toString(end.miss), errorNote(end.error)));
        case Cause::off_target:
            return fail(Errc::device_fault, fmt::format("{}: the motion ended with {}{}", name,
                                                        toString(end.miss), errorNote(end.error)));
        case Cause::stalled:
            return fail(Errc::device_fault,
                        fmt::format("{}: the motion neither went on nor ended: {}{}", name,
                                    toString(end.miss), errorNote(end.error)));
        case Cause::disconnected:
            return fail(Errc::connection_lost, lost);
    }
    return fail(Errc::internal, name + ": a motion ended in no known way");
}

}  // namespace metier::iiwa_driver
