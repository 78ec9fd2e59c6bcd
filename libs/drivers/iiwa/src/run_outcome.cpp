#include "run_outcome.hpp"

#include <fmt/format.h>

#include "commands.hpp"

namespace metier::iiwa_driver {
namespace {

std::string errorNote(int code) {
    return code == 0 ? "" : fmt::format(" (error {}: {})", code, errorText(code));
}

}  // namespace

Result<device::MotionOutcome> outcomeOf(const RunEnd& end, const std::string& name,
                                        const std::string& lost) {
    switch (end.cause) {
        case RunEnd::Cause::at_target:
        case RunEnd::Cause::stopped:
        case RunEnd::Cause::force:
            return end.outcome;
        case RunEnd::Cause::refused:
            return fail(Errc::device_fault,
                        fmt::format("{}: the cabinet refused: {}{}", name, describe(end.command),
                                    errorNote(end.error)));
        case RunEnd::Cause::not_ready:
            return fail(Errc::device_fault, fmt::format("{}: not ready to move: {}{}", name,
                                                        toString(end.miss), errorNote(end.error)));
        case RunEnd::Cause::off_target:
            return fail(Errc::device_fault, fmt::format("{}: the motion ended with {}{}", name,
                                                        toString(end.miss), errorNote(end.error)));
        case RunEnd::Cause::stalled:
            return fail(Errc::device_fault,
                        fmt::format("{}: the motion neither went on nor ended: {}{}", name,
                                    toString(end.miss), errorNote(end.error)));
        case RunEnd::Cause::disconnected:
            return fail(Errc::connection_lost, lost);
    }
    return fail(Errc::internal, name + ": a motion ended in no known way");
}

}  // namespace metier::iiwa_driver
