#include "host/device_opening.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <netdb.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "metier/link/name_lock.hpp"

namespace metier::server {
namespace {

using device::Safety;
using device::SafetyState;

// A controller that answers later than this finds its skills Halted.
constexpr std::chrono::seconds kFirstAnswer{10};
// One that powers on or homes by itself does so meanwhile.
constexpr std::chrono::seconds kSettling{2};
constexpr int kLastPort = 65535;

/// Calls the function with any interface that the device has: each has a safety state.
template <typename Use>
auto withAnInterface(const device::OpenDevice& device, Use use) {
    return device.arm != nullptr       ? use(*device.arm)
           : device.gripper != nullptr ? use(*device.gripper)
                                       : use(*device.force_torque_sensor);
}

Safety safetyOf(const device::OpenDevice& device) {
    return withAnInterface(device, [](const auto& part) { return part.safety(); });
}

struct LockedDevice {
    link::NameLock lock;
    std::shared_ptr<void> device;  // as OpenDevice::owner
};

/// The same text for all names of one host; the name itself if it is not known.
std::string addressOf(const std::string& host) {
    addrinfo wanted{};
    wanted.ai_socktype = SOCK_STREAM;
    addrinfo* found = nullptr;
    if (getaddrinfo(host.c_str(), nullptr, &wanted, &found) != 0) {
        return host;
    }
    std::array<char, NI_MAXHOST> text{};
    const bool known = getnameinfo(found->ai_addr, found->ai_addrlen, text.data(), text.size(),
                                   nullptr, 0, NI_NUMERICHOST) == 0;
    freeaddrinfo(found);
    return known ? text.data() : host;
}

/// \return nothing for a device that several processes may use
Result<std::optional<link::NameLock>> lockDevice(const device::Driver& driver,
                                                 const cell::DriverChoice& choice,
                                                 const std::string& name) {
    if (driver.port.setting.empty()) {
        return std::optional<link::NameLock>();
    }
    const auto port = static_cast<int>(
        choice.settings.numberOr(driver.port.setting, driver.port.preset, 0, kLastPort));
    if (port == 0) {  // a free port is used by no other process
        return std::optional<link::NameLock>();
    }
    const auto device =
        fmt::format("{} at {}, port {}", driver.name, addressOf(choice.controller), port);
    METIER_ASSIGN(auto lock,
                  link::NameLock::take("device " + device, name + ": the controller " + device));
    return std::optional(std::move(lock));
}

}  // namespace

Result<device::OpenDevice> openDevice(const cell::DriverChoice& choice, const DeviceUser& user) {
    const auto& all = user.drivers;
    const auto found = std::find_if(all.begin(), all.end(),
                                    [&](const auto& known) { return known.name == choice.type; });
    if (found == all.end()) {
        std::vector<std::string_view> names;
        for (const auto& known : all) {
            names.push_back(known.name);
        }
        return fail(Errc::invalid_argument,
                    fmt::format("{}: no driver of type \"{}\"; there are: {}", user.name,
                                choice.type, fmt::join(names, ", ")));
    }
    METIER_ASSIGN(auto lock, lockDevice(*found, choice, user.name));
    auto device = found->open({user.name, choice.controller, choice.settings, user.model});
    if (device && lock) {
        // Shared, as OpenDevice asks for; the connection ends before its lock.
        device->owner = std::make_shared<LockedDevice>(
            LockedDevice{std::move(*lock), std::move(device->owner)});
    }
    return device;
}

void awaitConnection(const device::OpenDevice& device) {
    struct Seen {
        std::mutex mutex;
        std::condition_variable changed;
        std::optional<SafetyState> state;
    };
    // Shared with a callback that may still run when this function has returned.
    const auto seen = std::make_shared<Seen>();
    const auto note = [seen](const Safety& safety) {
        const std::lock_guard lock(seen->mutex);
        seen->state = safety.state;
        seen->changed.notify_one();
    };
    const auto registration =
        withAnInterface(device, [&](auto& part) { return part.onSafetyChange(note); });
    const auto waitFor = [&](std::chrono::milliseconds longest, auto reached) {
        std::unique_lock lock(seen->mutex);
        return seen->changed.wait_for(lock, longest, [&] { return reached(*seen->state); });
    };
    {
        const auto now = safetyOf(device).state;
        const std::lock_guard lock(seen->mutex);
        seen->state = seen->state.value_or(now);  // a change is newer
    }
    if (!waitFor(kFirstAnswer, [](auto state) { return state != SafetyState::disconnected; }) ||
        !waitFor(kSettling, [](auto state) { return state == SafetyState::normal; })) {
        spdlog::warn("{}", safetyOf(device).text);
    }
}

}  // namespace metier::server
