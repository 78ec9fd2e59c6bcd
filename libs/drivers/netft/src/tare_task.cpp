#include "tare_task.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace metier::netft_driver {
namespace {

double largest(const std::array<double, 3>& sum) {
    const auto magnitude = [](double left, double right) {
        return std::abs(left) < std::abs(right);
    };
    return std::abs(*std::max_element(sum.begin(), sum.end(), magnitude)) / TareTask::kRecords;
}

}  // namespace

bool TareTask::toSend(SteadyTime now) {
    if (now < attempt_end_ || attempts_ == kAttempts) {
        return false;
    }
    ++attempts_;
    attempt_end_ = now + kAttemptTime;
    beginMean();
    return true;
}

void TareTask::beginMean() noexcept {
    records_ = 0;
    force_sum_ = {};
    torque_sum_ = {};
}

std::optional<Result<void>> TareTask::take(const device::WrenchSample& sample, SteadyTime now) {
    for (std::size_t i = 0; i < force_sum_.size(); ++i) {
        force_sum_[i] += sample.force[i];
        torque_sum_[i] += sample.torque[i];
    }
    if (++records_ == kRecords) {
        force_left_ = largest(force_sum_);
        torque_left_ = largest(torque_sum_);
        beginMean();
        if (force_left_ <= kZeroForce && torque_left_ <= kZeroTorque) {
            return Result<void>();
        }
    }
    if (attempts_ == kAttempts && now >= attempt_end_) {
        return fail(Errc::timeout,
                    fmt::format("after {} requests the load is still {:.2f} N and {:.3f} Nm, "
                                "expected at most {} N and {} Nm",
                                kAttempts, force_left_, torque_left_, kZeroForce, kZeroTorque));
    }
    return std::nullopt;
}

}  // namespace metier::netft_driver
