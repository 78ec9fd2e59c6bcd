#include "metier/robot_skills/stall_watch.hpp"

#include <fmt/format.h>

#include <utility>

namespace metier::robot_skills {

namespace {

double seconds(std::chrono::nanoseconds time) {
    return std::chrono::duration<double>(time).count();
}

std::string whatHappened(const std::string& name, std::chrono::nanoseconds silent,
                         std::chrono::nanoseconds limit) {
    return fmt::format("{}: the server's thread did not work for {:.2f} s, limit {:.2f} s", name,
                       seconds(silent), seconds(limit));
}

device::Watchdog::Actions actionsOf(const StallWatch::Setup& setup,
                                    const std::shared_ptr<skill::Executor>& executor,
                                    std::vector<skill::Program*> programs) {
    const bool device = setup.stop != nullptr;
    const auto text = [name = setup.name, limit = setup.limit](std::chrono::nanoseconds silent) {
        return whatHappened(name, silent, limit);
    };
    return {.stop = device ? setup.stop : [] {},
            .post = [executor](std::function<void()> work) { executor->post(std::move(work)); },
            .tell =
                [text, device, programs = std::move(programs)](std::chrono::nanoseconds stalled) {
                    for (auto* program : programs) {
                        program->deviceStopped(text(stalled) +
                                               (device ? ": its watchdog stopped the device"
                                                       : ": the skills that it uses are halted"));
                    }
                },
            .noticed =
                [text, device, log = setup.log](std::chrono::nanoseconds silent) {
                    log(text(silent) + (device ? ": what moves is stopped"
                                               : ": what runs is halted once it works again"));
                }};
}

}  // namespace

/// The sign of life of the owner's thread: a timer there that begins itself anew.
class StallWatch::Pulse : public std::enable_shared_from_this<Pulse> {
public:
    Pulse(device::Watchdog::Actions actions, std::chrono::nanoseconds limit, const Clock& clock,
          std::shared_ptr<skill::Executor> executor)
        : executor_(std::move(executor)),
          period_(device::Watchdog::tickPeriod(limit)),
          watchdog_(std::move(actions), limit, clock) {}

    /// Owner's thread.
    void beat() {
        watchdog_.tick();
        timer_ = executor_->after(period_, [weak = weak_from_this()] {
            if (const auto alive = weak.lock()) {
                alive->beat();
            }
        });
    }

    /// Any thread.
    void end() { watchdog_.end(); }
    /// Owner's thread.
    void release() { timer_.cancel(); }

private:
    std::shared_ptr<skill::Executor> executor_;
    std::chrono::nanoseconds period_;
    skill::Timer timer_;
    device::Watchdog watchdog_;
};

StallWatch::StallWatch(Setup setup, std::shared_ptr<skill::Executor> executor,
                       std::vector<skill::Program*> programs, const Clock& clock)
    : pulse_(std::make_shared<Pulse>(actionsOf(setup, executor, std::move(programs)), setup.limit,
                                     clock, executor)),
      executor_(std::move(executor)) {
    executor_->post([pulse = std::weak_ptr(pulse_)] {
        if (const auto alive = pulse.lock()) {
            alive->beat();
        }
    });
}

StallWatch::~StallWatch() {
    pulse_->end();
    executor_->post([pulse = std::move(pulse_)] { pulse->release(); });
}

}  // namespace metier::robot_skills
