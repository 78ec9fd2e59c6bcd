#include "metier/virtual_controller/cycle_timer.hpp"

#include <utility>

namespace metier::virtual_controller {

CycleTimer::CycleTimer(asio::io_context& context, std::chrono::nanoseconds period,
                       std::function<void()> cycle)
    : timer_(context),
      time_base_(std::chrono::steady_clock::now() + period, period),
      cycle_(std::move(cycle)) {
    wait();
}

void CycleTimer::wait() {
    timer_.expires_at(time_base_.next());
    timer_.async_wait(lifetime_.guard([this](const asio::error_code&) {
        const auto due = time_base_.begin(std::chrono::steady_clock::now());
        cycle_();
        if (next_period_) {
            time_base_ = joint_simulator::TimeBase(due + *next_period_, *next_period_);
            next_period_.reset();
        }
        wait();
    }));
}

}  // namespace metier::virtual_controller
