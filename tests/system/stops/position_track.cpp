#include "position_track.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "../metier_program.hpp"

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;

// As near as a skill takes for arrived [rad].
constexpr double kThere = 1e-3;
constexpr std::uint32_t kMostSamples = 10'000;

bool isNear(const std::vector<double>& left, const std::vector<double>& right) {
    return std::equal(left.begin(), left.end(), right.begin(), right.end(),
                      [](double a, double b) { return std::abs(a - b) < kThere; });
}

}  // namespace

PositionTrack::PositionTrack(const std::string& url, const std::string& skill)
    : client_(connectTo(url)) {
    const auto address = openSkill(*client_, skill).address();
    nodes_ = client::findKinematics(*client_, address).value();
    subscription_ = client_
                        ->subscribeData(nodes_.actual_joint_position,
                                        {.sampling_interval = 5ms, .queue_size = kMostSamples},
                                        [samples = samples_](const opcua::DataValue& data) {
                                            auto position = data.value.as<std::vector<double>>();
                                            if (!position) {
                                                return;
                                            }
                                            const auto time = data.source_time == UtcTime{}
                                                                  ? data.server_time
                                                                  : data.source_time;
                                            const std::lock_guard lock(samples->mutex);
                                            samples->taken.push_back({time, std::move(*position)});
                                            samples->came.notify_all();
                                        })
                        .value();
}

void PositionTrack::restart() {
    const std::lock_guard lock(samples_->mutex);
    auto& taken = samples_->taken;
    taken.erase(taken.begin(), taken.empty() ? taken.end() : std::prev(taken.end()));
}

UtcTime PositionTrack::restSince() {
    const auto rest = client::readJointPosition(*client_, nodes_).value();
    std::unique_lock lock(samples_->mutex);
    const auto& taken = samples_->taken;
    const auto came = samples_->came.wait_until(
        lock, inAMinute(), [&] { return !taken.empty() && isNear(taken.back().position, rest); });
    if (!came) {
        throw std::runtime_error("the arm's last samples do not come");
    }
    const auto moving = std::find_if(taken.rbegin(), taken.rend(), [&](const Sample& sample) {
        return !isNear(sample.position, rest);
    });
    return std::prev(moving)->time;
}

}  // namespace metier::system_tests
