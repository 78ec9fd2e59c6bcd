#include "command_wait.hpp"

#include <algorithm>

namespace metier::virtual_edo {

void CommandWait::begin(std::uint64_t mask, std::size_t axes) {
    age_ = 0;
    for (std::size_t axis = 0; axis < phases_.size(); ++axis) {
        phases_[axis] = axis < axes && inMask(mask, axis) ? Phase::low : Phase::done;
    }
}

bool CommandWait::take(const BusReport& report) {
    for (std::size_t axis = 0; axis < std::min(phases_.size(), report.joints.size()); ++axis) {
        if (!inMask(report.mask, axis)) {
            continue;
        }
        const bool raised = (report.joints[axis].flags & 0x000FU) != 0;
        if (phases_[axis] == Phase::low && raised) {
            phases_[axis] = Phase::raised;
        } else if (phases_[axis] == Phase::raised && !raised) {
            phases_[axis] = Phase::done;
        }
    }
    return std::all_of(phases_.begin(), phases_.end(),
                       [](Phase phase) { return phase == Phase::done; });
}

}  // namespace metier::virtual_edo
