#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>

#include "metier/base/clock.hpp"
#include "metier/base/histogram.hpp"
#include "metier/skill/program.hpp"

namespace metier::server {

/// Counts the executions and calls of one Program.
///
/// Threading: made and ended by the Program's owner; any thread may read its figures; nothing
/// waits.
class ProgramMeter final : private skill::ProgramObserver {
public:
    static constexpr std::size_t kReasons = 8;  ///< number of values of skill::Reason
    static constexpr std::size_t kMethods = 6;  ///< number of values of skill::Method

    /// \param program must outlive this
    explicit ProgramMeter(skill::Program& program);
    ~ProgramMeter() override;
    ProgramMeter(const ProgramMeter&) = delete;
    ProgramMeter& operator=(const ProgramMeter&) = delete;

    const std::string& skill() const noexcept { return skill_; }
    skill::State state() const noexcept { return state_; }
    std::uint64_t starts() const noexcept { return starts_; }
    /// Executions that reached their end.
    std::uint64_t finished() const noexcept { return finished_; }
    std::uint64_t suspends() const noexcept { return suspends_; }
    /// Executions that were Halted, and why.
    std::uint64_t halts(skill::Reason reason) const noexcept {
        return halts_.at(static_cast<std::size_t>(reason));
    }
    /// Calls of a method that were refused.
    std::uint64_t refusals(skill::Method method) const noexcept {
        return refusals_.at(static_cast<std::size_t>(method));
    }
    /// Times from Running to the end, for any outcome [s].
    const TimeHistogram& durations() const noexcept { return durations_; }

private:
    using Counter = std::atomic<std::uint64_t>;

    void onTransition(const skill::TransitionEvent& event) override;
    void onDiagnostic(const skill::Diagnostic& diagnostic) override;
    void ended();

    skill::Program& program_;
    const std::string skill_;
    std::atomic<skill::State> state_;
    SteadyTime started_{};
    bool runs_ = false;
    Counter starts_ = 0;
    Counter finished_ = 0;
    Counter suspends_ = 0;
    std::array<Counter, kReasons> halts_{};
    std::array<Counter, kMethods> refusals_{};
    TimeHistogram durations_;
};

}  // namespace metier::server
