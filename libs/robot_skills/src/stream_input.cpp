#include "metier/robot_skills/stream_input.hpp"

#include <algorithm>
#include <chrono>

namespace metier::robot_skills {

void StreamTimes::restart() noexcept {
    sender_start_.reset();
    arrival_start_.reset();
}

motion::Seconds StreamTimes::next(std::optional<UtcTime> meant_for) noexcept {
    const auto now = clock_.now();
    const bool first = !arrival_start_;
    arrival_start_ = arrival_start_.value_or(now);
    const std::chrono::nanoseconds arrival = now - *arrival_start_;
    if (!meant_for) {
        last_ = first ? arrival : std::max(arrival, last_ + least_step_);
        return last_;
    }
    if (!sender_start_) {
        sender_start_ = *meant_for - std::chrono::duration_cast<UtcTime::duration>(arrival);
    }
    last_ = *meant_for - *sender_start_;
    return last_;
}

}  // namespace metier::robot_skills
