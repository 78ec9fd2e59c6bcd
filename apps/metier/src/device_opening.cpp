#include "device_opening.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <vector>

namespace metier::app {
namespace {

using device::Safety;
using device::SafetyState;

// A controller that answers later than this finds its skills Halted.
constexpr std::chrono::seconds kFirstAnswer{10};
// One that powers on or homes by itself does so meanwhile.
constexpr std::chrono::seconds kSettling{2};

/// Whichever face a device has tells of its safety.
template <typename Callback>
device::Registration onSafetyChange(const driver::OpenDevice& device, Callback callback) {
    if (device.arm != nullptr) {
        return device.arm->onSafetyChange(callback);
    }
    if (device.gripper != nullptr) {
        return device.gripper->onSafetyChange(callback);
    }
    return device.force_torque_sensor->onSafetyChange(callback);
}

Safety safetyOf(const driver::OpenDevice& device) {
    if (device.arm != nullptr) {
        return device.arm->safety();
    }
    return device.gripper != nullptr ? device.gripper->safety()
                                     : device.force_torque_sensor->safety();
}

}  // namespace

Result<driver::OpenDevice> openDevice(const configuration::DriverChoice& choice,
                                      const std::string& name, const motion::RobotModel* model) {
    const auto& all = driver::drivers();
    const auto found = std::find_if(all.begin(), all.end(),
                                    [&](const auto& known) { return known.name == choice.type; });
    if (found == all.end()) {
        std::vector<std::string_view> names;
        for (const auto& known : all) {
            names.push_back(known.name);
        }
        return fail(Errc::invalid_argument,
                    fmt::format("{}: no driver of type \"{}\"; there are: {}", name, choice.type,
                                fmt::join(names, ", ")));
    }
    return found->open({name, choice.controller, choice.settings, model});
}

void awaitConnection(const driver::OpenDevice& device) {
    struct Seen {
        std::mutex mutex;
        std::condition_variable changed;
        SafetyState state = SafetyState::disconnected;
    };
    // Shared with a callback that may still run when this function has returned.
    const auto seen = std::make_shared<Seen>();
    const auto registration = onSafetyChange(device, [seen](const Safety& safety) {
        const std::lock_guard lock(seen->mutex);
        seen->state = safety.state;
        seen->changed.notify_one();
    });
    const auto waitFor = [&](std::chrono::milliseconds longest, auto reached) {
        std::unique_lock lock(seen->mutex);
        return seen->changed.wait_for(lock, longest, [&] { return reached(seen->state); });
    };
    {
        const auto now = safetyOf(device).state;
        const std::lock_guard lock(seen->mutex);
        seen->state = now;
    }
    if (!waitFor(kFirstAnswer, [](auto state) { return state != SafetyState::disconnected; }) ||
        !waitFor(kSettling, [](auto state) { return state == SafetyState::normal; })) {
        spdlog::warn("{}", safetyOf(device).text);
    }
}

}  // namespace metier::app
