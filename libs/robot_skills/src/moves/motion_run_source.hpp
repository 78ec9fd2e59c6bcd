#pragma once

#include <atomic>
#include <cstdint>
#include <string_view>
#include <utility>

#include "metier/device/arm.hpp"
#include "metier/skill/execution_handle.hpp"

namespace metier::robot_skills {

/// A source of set-points that reports to a skill's execution why the arm has stopped using it.
///
/// While attached() the arm's cycle thread owns what next() uses; ended() hands it back to the
/// owner's thread.
class MotionRunSource : public device::SetPointSource {
public:
    enum class Request : std::uint8_t { none, suspend, halt };

    /// Owner's thread, once, before the arm is asked to attach it.
    void begin(skill::ExecutionHandle execution) {
        tell_ = std::move(execution);
        attached_.store(true);
    }

    /// Owner's thread, instead of begin() after a rest; then the arm is asked again.
    /// \param from where the arm is commanded to stand now, near restingPlace()
    void beginAgain(const device::JointArray& from) {
        request_.store(Request::none);
        goOnFrom(from);
        attached_.store(true);
    }

    /// Owner's thread: the arm did not take it.
    void abandon() noexcept { attached_.store(false); }

    /// Any thread: come to rest on the path.
    void request(Request request) noexcept { request_.store(request); }

    /// Any thread: whether an arm has it.
    bool attached() const noexcept { return attached_.load(); }

    /// Owner's thread while not attached: where it came to rest [rad].
    virtual device::JointArray restingPlace() const noexcept = 0;

    void ended(device::EndCause cause, const device::Safety& safety) final;
    std::string_view execution() const noexcept final { return tell_.id(); }

protected:
    /// Cycle thread: what was asked since the last cycle.
    Request takeRequest() noexcept { return request_.exchange(Request::none); }

private:
    /// Prepares next() to go on from rest.
    virtual void goOnFrom(const device::JointArray& from) = 0;
    /// The arm has let go, for whatever cause. Notifying thread.
    virtual void released() noexcept {}
    /// Tells how it ended after next() returned done. Notifying thread.
    virtual void tellDone(const skill::ExecutionHandle& tell) = 0;

    skill::ExecutionHandle tell_;
    std::atomic<bool> attached_{false};
    std::atomic<Request> request_{Request::none};
};

}  // namespace metier::robot_skills
