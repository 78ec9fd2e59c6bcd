#include "synchronized/synchronized_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace metier::composition {

namespace {

using namespace std::chrono_literals;

// As long as the arms are asked before a motion.
constexpr auto kLongestArmAnswer = 10s;

/// The place of the arm of that server.
skill::ArmPositions startOf(const std::string& server, const skill::ArmPositions& starts) {
    const auto found = starts.find(server);
    return found == starts.end() || found->second.empty()
               ? skill::ArmPositions()
               : skill::ArmPositions{{found->first, found->second}};
}

}  // namespace

void SynchronizedCheck::start(const skill::ArmPositions& starts, skill::Executor& executor,
                              skill::CheckDone done) {
    done_ = std::move(done);
    all_.planned_duration = least_duration_;
    limit_ = executor.after(kLongestArmAnswer, [this] {
        finish(fail(Errc::timeout,
                    fmt::format("{} of {} arms have answered", answers_, arms_.size())));
    });
    for (const auto& [arm, target, tool_frame] : arms_) {
        auto& move = *arm.pose_move;
        move.check({.parameters = {{"TargetPosition", target}, {"ToolFrame", tool_frame}},
                    .starts = startOf(move.serverUrl(), starts)},
                   [this, alive = alive_, &arm = arm](const Result<skill::CheckReport>& report) {
                       if (*alive && !over()) {
                           answered(arm, report);
                       }
                   });
    }
}

/// The first arm that cannot do its part is the reason.
void SynchronizedCheck::answered(const Arm& arm, const Result<skill::CheckReport>& report) {
    if (!report) {
        finish(
            fail(report.error().code == Errc::timeout ? Errc::connection_lost : report.error().code,
                 fmt::format("{} does not answer: {}", arm.name, report.error().message)));
        return;
    }
    if (!report->possible) {
        auto refusal = *report;
        refusal.reason = fmt::format("{} cannot get to its target: {}", arm.name, report->reason);
        finish(std::move(refusal));
        return;
    }
    all_.planned_duration = std::max(all_.planned_duration, report->planned_duration);
    all_.ends_known = all_.ends_known && report->ends_known;
    all_.ends.insert(report->ends.begin(), report->ends.end());
    if (++answers_ == arms_.size()) {
        finish(std::move(all_));
    }
}

void SynchronizedCheck::finish(Result<skill::CheckReport> report) {
    limit_.cancel();
    if (const auto done = std::exchange(done_, nullptr)) {
        done(std::move(report));
    }
}

}  // namespace metier::composition
