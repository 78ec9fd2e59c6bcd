#pragma once

#include <asio/io_context.hpp>
#include <asio/steady_timer.hpp>
#include <chrono>
#include <functional>
#include <optional>

#include "metier/joint_simulator/time_base.hpp"
#include "metier/virtual_controller/lifetime.hpp"

namespace metier::virtual_controller {

/// Calls a function once per period on an exact grid, on the thread that runs the io_context. Late
/// calls are caught up by the rule of TimeBase.
///
/// Threading: created, used and destroyed on the thread that runs the io_context.
///
///     CycleTimer cycle(context, 8ms, [this] { step(); });   // 125 Hz, as a UR5 has
///
/// Its end cancels the next call; a call that is under way cannot be interrupted.
class CycleTimer {
public:
    /// Begins at once; the first call is one period later.
    /// \param context must outlive the timer
    /// \param period  > 0
    /// \param cycle   must not throw, nor destroy the timer
    CycleTimer(asio::io_context& context, std::chrono::nanoseconds period,
               std::function<void()> cycle);
    CycleTimer(const CycleTimer&) = delete;
    CycleTimer& operator=(const CycleTimer&) = delete;

    /// Sets the period from the next call on; the grid begins anew there.
    /// \param period > 0
    void setPeriod(std::chrono::nanoseconds period) noexcept { next_period_ = period; }

private:
    /// Waits for the next time of the grid, calls the function, applies a new period, waits again.
    void wait();

    asio::steady_timer timer_;
    joint_simulator::TimeBase time_base_;
    std::function<void()> cycle_;
    std::optional<std::chrono::nanoseconds> next_period_;
    Lifetime lifetime_;
};

}  // namespace metier::virtual_controller
