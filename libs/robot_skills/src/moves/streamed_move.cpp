#include "moves/streamed_move.hpp"

#include <utility>

#include "moves/move_skill.hpp"
#include "moves/source_work.hpp"
#include "moves/stop_time.hpp"

namespace metier::robot_skills {

std::unique_ptr<skill::ExecutionWork> makeStreamedWork(const StreamedArm& arm, StreamedMove move) {
    auto source = std::make_shared<MoveSource>(
        MoveSource::Setup{arm.arm.info(), move.trajectory, move.path,
                          Timetable(arm.clock, move.start_time), std::move(move.contact),
                          stopTimeFor(move.trajectory, arm.model, move.stop_time), arm.stopping});
    return std::make_unique<SourceWork>(arm.arm, std::move(source), toolDistance(move.trajectory));
}

}  // namespace metier::robot_skills
