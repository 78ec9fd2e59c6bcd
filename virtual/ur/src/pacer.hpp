#pragma once

#include <asio/io_context.hpp>
#include <asio/steady_timer.hpp>
#include <chrono>
#include <functional>

#include "metier/virtual_controller/lifetime.hpp"

namespace metier::virtual_ur {

/// Calls a function once per period. Late calls are caught up evenly, four times as fast at most,
/// because clients take two packages at once for an error. After 0.1 s the rest is left out.
///
/// Threading: the thread that runs the io_context.
class Pacer {
public:
    Pacer(asio::io_context& context, std::chrono::nanoseconds period, std::function<void()> cycle)
        : timer_(context),
          period_(period),
          due_(std::chrono::steady_clock::now()),
          cycle_(std::move(cycle)) {
        wait();
    }

private:
    static constexpr std::chrono::milliseconds kLongestCatchUp{100};

    void wait() {
        const auto now = std::chrono::steady_clock::now();
        due_ += period_;
        if (now - due_ > kLongestCatchUp) {
            due_ = now;
        }
        timer_.expires_at(std::max(due_, now + period_ / 4));
        timer_.async_wait(lifetime_.guard([this](const asio::error_code&) {
            cycle_();
            wait();
        }));
    }

    asio::steady_timer timer_;
    const std::chrono::nanoseconds period_;
    std::chrono::steady_clock::time_point due_;
    std::function<void()> cycle_;
    virtual_controller::Lifetime lifetime_;
};

}  // namespace metier::virtual_ur
