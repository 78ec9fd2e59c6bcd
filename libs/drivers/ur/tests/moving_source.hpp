#pragma once

#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <future>
#include <string>

#include "metier/base/testing/allocation_count.hpp"
#include "metier/device/arm.hpp"

namespace metier::ur_driver {

/// Moves axis 1 from where the arm is by a distance in so many cycles, smoothly, and remembers how
/// that ended.
class MovingSource final : public device::SetPointSource {
public:
    MovingSource(double distance, int cycles) : distance_(distance), cycles_(cycles) {}

    Next next(const device::ArmState& state, device::JointArray& set_point) noexcept override {
        const auto count = allocationCount();
        if (step_ > 0) {
            allocations_ += count - last_count_;
        } else {
            start_ = state.commanded_position;
        }
        last_count_ = count;
        ++step_;
        asked_.store(step_);
        if (step_ > cycles_) {
            return Next::done;
        }
        const double share = 0.5 - 0.5 * std::cos(3.14159265358979 * step_ / cycles_);
        set_point = start_;
        set_point[0] += distance_ * share;
        return Next::set_point;
    }

    void ended(device::EndCause cause, const device::Safety& safety) override {
        ends_.fetch_add(1);
        safety_ = safety;
        outcome_.set_value(cause);
    }

    /// Cause of the end; fails the calling test if there is none within 10 s.
    device::EndCause outcome() {
        auto future = outcome_.get_future();
        if (future.wait_for(std::chrono::seconds(10)) != std::future_status::ready) {
            throw std::runtime_error("the motion did not end");
        }
        return future.get();
    }
    const device::Safety& safety() const { return safety_; }
    int asked() const { return asked_.load(); }
    int ends() const { return ends_.load(); }
    /// By the cycle thread, from the first call of next() to the last.
    std::size_t allocations() const { return allocations_; }

private:
    const double distance_;
    const int cycles_;
    int step_ = 0;
    std::atomic<int> asked_{0};
    std::atomic<int> ends_{0};
    device::JointArray start_;
    std::size_t allocations_ = 0;
    std::size_t last_count_ = 0;
    std::promise<device::EndCause> outcome_;
    device::Safety safety_;
};

}  // namespace metier::ur_driver
