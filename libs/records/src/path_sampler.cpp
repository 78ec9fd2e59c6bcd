#include "metier/records/path_sampler.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace metier::records {
namespace {

// Smaller differences are no motion.
constexpr double kAngle = 1e-4;   // [rad]
constexpr double kForce = 0.5;    // [N]
constexpr double kTorque = 0.05;  // [Nm]
constexpr std::chrono::seconds kLongestPause{1};

bool differs(const device::WrenchSample& one, const device::WrenchSample& other) {
    for (std::size_t i = 0; i < one.force.size(); ++i) {
        if (std::abs(one.force.at(i) - other.force.at(i)) > kForce ||
            std::abs(one.torque.at(i) - other.torque.at(i)) > kTorque) {
            return true;
        }
    }
    return false;
}

SampleValues valuesOf(const device::JointArray& joints) {
    return SampleValues({joints.begin(), joints.size()});
}

SampleValues valuesOf(const std::optional<device::WrenchSample>& sample) {
    if (!sample) {
        return {};
    }
    const auto& f = sample->force;
    const auto& t = sample->torque;
    return SampleValues(std::array{f[0], f[1], f[2], t[0], t[1], t[2]});
}

}  // namespace

PathSampler::PathSampler(const device::Arm& arm, const device::ForceTorqueSensor* sensor,
                         Recorder& recorder)
    : arm_(arm),
      sensor_(sensor),
      recorder_(recorder),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

PathSampler::~PathSampler() {
    thread_.request_stop();
    thread_ = {};
}

void PathSampler::begin(Recorder::Key key) {
    if (key == 0) {
        return;
    }
    const auto reading = read();
    {
        const std::lock_guard lock(mutex_);
        paths_.push_back(
            {.key = key, .begin = reading.time, .missed_at_begin = reading.arm.missed_cycles});
        send(paths_.back(), reading);
    }
    changed_.notify_all();
}

std::uint64_t PathSampler::end(Recorder::Key key) {
    const std::lock_guard lock(mutex_);
    const auto path =
        std::find_if(paths_.begin(), paths_.end(), [&](const Path& one) { return one.key == key; });
    if (path == paths_.end()) {
        return 0;
    }
    const auto reading = read();
    if (reading.arm.stamp != path->sent->arm.stamp) {
        if (path->skipped && path->skipped->arm.stamp != reading.arm.stamp) {
            send(*path, *path->skipped);
        }
        send(*path, reading);
    }
    const auto before = path->missed_at_begin;
    paths_.erase(path);
    return reading.arm.missed_cycles > before ? reading.arm.missed_cycles - before : 0;
}

void PathSampler::run(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (!stop.stop_requested()) {
        changed_.wait(lock, stop, [this] { return !paths_.empty(); });
        const auto due = std::chrono::steady_clock::now() + kPeriod;
        changed_.wait_until(lock, stop, due, [] { return false; });
        if (paths_.empty()) {
            continue;
        }
        const auto reading = read();
        for (auto& path : paths_) {
            take(path, reading);
        }
    }
}

PathSampler::Reading PathSampler::read() const {
    Reading reading{.arm = arm_.state(), .time = std::chrono::steady_clock::now()};
    if (sensor_ != nullptr) {
        const auto sample = sensor_->sample();
        if (sample.health == device::SafetyState::normal) {
            reading.force = sample;
        }
    }
    return reading;
}

/// The end of a pause is recorded too, so that what is drawn between two samples is true.
void PathSampler::take(Path& path, const Reading& reading) {
    const auto& sent = *path.sent;
    const bool moves =
        device::largestDifference(sent.arm.position, reading.arm.position) > kAngle ||
        device::largestDifference(sent.arm.commanded_position, reading.arm.commanded_position) >
            kAngle ||
        sent.force.has_value() != reading.force.has_value() ||
        (sent.force && differs(*sent.force, *reading.force));
    if (!moves && reading.time - sent.time < kLongestPause) {
        path.skipped = reading;
        return;
    }
    if (const auto skipped = path.skipped; moves && skipped) {
        send(path, *skipped);
    }
    send(path, reading);
}

void PathSampler::send(Path& path, const Reading& reading) {
    const std::chrono::duration<double> time = reading.time - path.begin;
    recorder_.sample(path.key, {.time = time.count(),
                                .actual = valuesOf(reading.arm.position),
                                .commanded = valuesOf(reading.arm.commanded_position),
                                .force = valuesOf(reading.force)});
    path.sent = reading;
    path.skipped.reset();
}

}  // namespace metier::records
