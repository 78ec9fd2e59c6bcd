#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/device/arm.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/robot_skills/stream_report.hpp"
#include "metier/skill/field_list.hpp"
#include "metier/skill/skill.hpp"

namespace metier::robot_skills {

/// Parameters of a position stream.
struct PositionStreamParameters {
    /// Set-point [rad], one value per axis, axis 1 first. Live: each write is a set-point, with its
    /// SourceTimestamp as the time for which it is meant.
    std::optional<std::vector<double>> target_joint_position{};
    /// Delay between the time for which a set-point is meant and the cycle in which the arm gets it
    /// [s], rounded up to cycles. Not set: 20 ms, but at least three cycles. 0: every cycle sends
    /// the newest set-point.
    std::optional<double> play_out_delay{};
    /// Whether the last set-point was written; written true while the skill runs. Live.
    std::optional<bool> end_of_stream{};
};

/// Settings of a position stream, from the cell file.
struct PositionStreamOptions {
    /// Silence [s] that ends a stream while it moves; at least 6 cycles are waited for. The arm
    /// goes on to its last set-points meanwhile. Do not make it much shorter: a busy computer
    /// without a real-time kernel delays a thread by some 50 ms.
    double longest_silence = 0.15;
    /// Largest time that the arm may be behind its client, besides PlayOutDelay [s]; at least
    /// longest_silence.
    double largest_lag = 0.25;
    /// Receives the timing of the set-points; shared with those who publish it; not null.
    std::shared_ptr<StreamReport> report = std::make_shared<StreamReport>();
};

/// Results of a position stream.
struct PositionStreamResults {
    /// Number of set-points that the arm followed.
    std::uint64_t set_points = 0;
    /// Number of cycles without a set-point in time, up to the last one.
    std::uint64_t missed_cycles = 0;
    /// Time from Running to rest [s].
    double duration = 0.0;
    /// Largest lag of a set-point, as StreamReport::Figures [s].
    double largest_lag = 0.0;
    /// Largest step of the client's clock, as StreamReport::Figures [s].
    double clock_step = 0.0;
    /// Number of set-points that were refused when they were written.
    std::uint64_t refused_set_points = 0;
    /// Number of set-points that were dropped, since they were not later than the one before.
    std::uint64_t dropped_set_points = 0;
};

/// Fields of the parameters as a server publishes them for `model`, which must outlive the list.
skill::FieldList<PositionStreamParameters> positionStreamFields(const motion::RobotModel& model);
/// Fields of the results; lives as long as the program. Any thread.
const skill::FieldList<PositionStreamResults>& positionStreamResultFields();

/// Makes a skill that follows the joint positions that its client writes while it runs.
///
/// The arm plays the stream a few cycles after the times it was meant for (motion::StreamFollower),
/// within the limits of its axes. With PlayOutDelay 0 it is sent the newest set-point at once;
/// while set-points are late it goes on as before for 20 ms, but at least three
/// cycles, and brakes then. A stream ends
/// - by Halt or Suspend: brakes. The number of set-points is the IntermediateResult. After Resume
///   the stream begins anew where the arm stands;
/// - by EndOfStream, written while the stream stands: as soon as the arm stands at the last
///   set-point, with its results;
/// - by silence while the stream stands, that is its last two set-points differ by less than
///   0.02 rad/s: the arm goes to the last one, and after 0.5 s it is finished, with its results;
/// - by silence of over PositionStreamOptions::longest_silence while it moves: brakes, then Halted
/// with an error;
/// - by a lag of over PositionStreamOptions::largest_lag, as when the client's clock steps ahead:
///   brakes, then Halted, limit_violated. A smaller lag is shown in the report, and ends when the
///   arm rests;
/// - by set-points whose times are not after the last one's, as when the client's clock steps back:
///   as silence, but always an error;
/// - by a set-point that no axis could follow (a jump): brakes, then Halted, limit_violated.
///   A single set-point that is not finite or outside the axes' ranges is refused when it is
///   written, and counted in the report.
/// A stream that never begins is finished after 10 s.
///
/// \param arm, model, clock must outlive the skill
/// \param model with as many axes as the arm
std::unique_ptr<skill::Skill> makePositionStreamSkill(device::Arm& arm,
                                                      const motion::RobotModel& model,
                                                      const Clock& clock,
                                                      const PositionStreamOptions& options);

}  // namespace metier::robot_skills
