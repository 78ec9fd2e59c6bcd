#include "moves/motion_run_source.hpp"

namespace metier::robot_skills {

using device::EndCause;
using skill::Reason;

void MotionRunSource::ended(EndCause cause, const device::Safety& safety) {
    released();
    attached_.store(false);
    switch (cause) {
        case EndCause::done:
            tellDone(tell_);
            return;
        case EndCause::stopped:
            tell_.atRest();
            return;
        case EndCause::disconnected:
            tell_.fail(Reason::device_lost, safety.text);
            return;
        case EndCause::safety:
            tell_.fail(safety.limit_violated ? Reason::limit_violated : Reason::error, safety.text);
            return;
    }
}

}  // namespace metier::robot_skills
