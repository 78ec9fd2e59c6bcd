#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>

#include "metier/motion/stream_follower.hpp"
#include "metier/robot_skills/position_stream_skill.hpp"
#include "metier/robot_skills/stream_report.hpp"
#include "moves/motion_run_source.hpp"
#include "moves/settling.hpp"
#include "stream/stream_input.hpp"

namespace metier::robot_skills {

/// Gives an arm the set-points of a stream, as the stream follower allows them.
class StreamSource final : public MotionRunSource {
public:
    struct Setup {
        double cycle = 0.0;                      ///< period of the arm [s]
        motion::JointVector start;               ///< commanded joint position [rad]
        std::optional<double> play_out_delay{};  ///< [s], PositionStreamParameters
        PositionStreamOptions options{};         ///< its report is shared with the next stream, too
    };

    /// \param model must outlive the source
    /// Errors: those of motion::StreamFollower::create().
    static Result<std::shared_ptr<StreamSource>> create(const motion::RobotModel& model,
                                                        const Setup& setup);

    StreamSource(const motion::RobotModel& model, const Setup& setup,
                 const motion::StreamFollower& follower);

    /// Whether the stream could begin with this set-point. Before begin().
    Result<void> checkFirst(const motion::JointVector& position) const;

    /// Queue into which the owner's thread writes the set-points.
    StreamQueue& queue() noexcept { return queue_; }

    /// Owner's thread: no set-point comes after those in the queue. The stream ends when the arm
    /// stands at the last one.
    void finish() noexcept { finish_asked_.store(true, std::memory_order_release); }
    /// Owner's thread: whether finish() was called.
    bool finishing() const noexcept { return finish_asked_.load(std::memory_order_relaxed); }

    Next next(const device::ArmState& state, device::JointArray& set_point) noexcept override;
    device::JointArray restingPlace() const noexcept override { return commanded_; }

private:
    /// Why the stream comes to rest.
    enum class End : std::uint8_t {
        none,
        asked,
        silent,
        silent_moving,
        went_back,  ///< silent, but for set-points whose times are not after the last one's
        late,
        refused,
        off_target
    };

    void goOnFrom(const device::JointArray& from) override;
    void tellDone(const skill::ExecutionHandle& tell) override;

    void takeSetPoints() noexcept;
    void dropAllButNewest() noexcept;
    void take(const StreamedPosition& set_point) noexcept;
    /// Whether the arm would be too far behind its client with the set-point.
    bool isLate(const StreamedPosition& set_point, motion::Seconds now) noexcept;
    double largestLag() const noexcept;
    /// The report's text for it, to be put behind another text.
    std::string reported() const;
    void watchSilence() noexcept;
    /// Whether nothing more is to be waited for.
    bool isFinished() const noexcept;
    /// Silence of a moving stream that ends it [s].
    double longestSilence() const noexcept;
    static motion::StreamOptions followerOptions(const Setup& setup) noexcept;
    void hold() noexcept;
    void endBecause(End end) noexcept;
    PositionStreamResults results() const noexcept;

    const motion::RobotModel& model_;
    const Setup setup_;
    const int play_out_cycles_;
    motion::StreamFollower follower_;
    StreamQueue queue_;
    std::atomic<bool> finish_asked_{false};
    Settling settling_;
    End end_ = End::none;
    device::JointArray commanded_;

    // Since the stream began, or began anew after a rest.
    std::uint64_t cycles_ = 0;
    std::optional<StreamedPosition> last_;
    double speed_ = 0.0;      ///< speed of the stream's fastest axis [rad/s]
    double silence_ = 0.0;    ///< since the last set-point [s]
    bool finishing_ = false;  ///< no further set-point will come
    std::uint64_t set_points_ = 0;
    std::uint64_t missed_cycles_ = 0;
    std::uint64_t dropped_ = 0;  ///< since the last set-point that was followed
    std::optional<motion::StreamRefusal> refusal_;

    PositionStreamResults before_rest_;
};

}  // namespace metier::robot_skills
