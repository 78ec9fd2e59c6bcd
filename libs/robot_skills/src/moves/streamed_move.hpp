#pragma once

#include <memory>
#include <optional>

#include "metier/motion/trajectory.hpp"
#include "moves/move_skills.hpp"
#include "moves/move_source.hpp"
#include "moves/path_deviation.hpp"

namespace metier::robot_skills {

/// A move whose set-points the arm's cycle thread takes from metier's plan.
struct StreamedMove {
    motion::Trajectory trajectory;
    PathDeviationMeter::Path path;
    std::optional<double> start_time{};  ///< [s since 1970-01-01 UTC]; none: at once
    /// Duration of a Suspend [s]; none: as short as the limits allow
    std::optional<double> stop_time{};
    std::unique_ptr<ContactWatch> contact{};  ///< nullptr: none is watched for
};

/// The execution of that move; nothing moves yet. \param arm must outlive it
std::unique_ptr<skill::ExecutionWork> makeStreamedWork(const StreamedArm& arm, StreamedMove move);

}  // namespace metier::robot_skills
