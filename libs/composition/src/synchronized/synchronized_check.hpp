#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "metier/composition/synchronized_move_skill.hpp"
#include "metier/skill/executor.hpp"
#include "synchronized/arm_move.hpp"

namespace metier::composition {

/// Asks all arms of a synchronized move whether they can reach their poses, and in what time.
///
/// Threading: the owner's thread; nothing waits.
class SynchronizedCheck {
public:
    /// \param arms           what they name must outlive this
    /// \param least_duration [s]
    SynchronizedCheck(std::vector<ArmTarget> arms, double least_duration)
        : arms_(std::move(arms)), least_duration_(least_duration) {}
    ~SynchronizedCheck() { *alive_ = false; }
    SynchronizedCheck(const SynchronizedCheck&) = delete;
    SynchronizedCheck& operator=(const SynchronizedCheck&) = delete;

    /// Asks them. Once.
    /// \param done called once, unless this ends before; with timeout if one does not answer
    void start(const skill::ArmPositions& starts, skill::Executor& executor, skill::CheckDone done);
    bool over() const noexcept { return done_ == nullptr; }

private:
    void answered(const Arm& arm, const Result<skill::CheckReport>& report);
    void finish(Result<skill::CheckReport> report);

    std::vector<ArmTarget> arms_;
    double least_duration_;
    std::size_t answers_ = 0;
    skill::CheckReport all_{.ends_known = true};
    skill::CheckDone done_;
    skill::Timer limit_;
    // Answers that come late ask it whether this is still there.
    std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
};

}  // namespace metier::composition
