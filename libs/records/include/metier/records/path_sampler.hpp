#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/device/arm.hpp"
#include "metier/device/force_torque_sensor.hpp"
#include "metier/records/recorder.hpp"

namespace metier::records {

/// Records the positions of an arm while executions are under way: at their begin, at their end,
/// and every 10 ms while it moves; once a second while it stands.
///
/// Threading: a thread of its own reads the newest state of arm and sensor; no cycle thread waits
/// for it. begin() and end() may be called on any thread; they wait for at most one reading of that
/// thread.
///
/// A reading counts as a motion if an axis, measured or commanded, differs by more than 0.0001 rad
/// from the last sample, the force by more than 0.5 N or the torque by more than 0.05 N m. The last
/// reading of a pause is recorded too, so that a straight line between two samples is true.
class PathSampler {
public:
    /// Time between two readings while an execution is under way.
    static constexpr std::chrono::milliseconds kPeriod{10};

    /// Starts the thread.
    /// \param arm      must outlive this, as must the sensor and the recorder
    /// \param sensor   may be null: samples have no force then
    PathSampler(const device::Arm& arm, const device::ForceTorqueSensor* sensor,
                Recorder& recorder);
    /// Ends the thread, within one reading. Executions that are still under way get no further
    /// sample.
    ~PathSampler();
    PathSampler(const PathSampler&) = delete;
    PathSampler& operator=(const PathSampler&) = delete;

    /// Starts recording for an execution; several may be under way.
    /// Records the first sample at once. A key of 0, of an execution that was dropped, is ignored.
    /// \param key from Recorder::begin()
    void begin(Recorder::Key key);
    /// Stops recording for an execution; no sample of it comes after this.
    /// Records a last sample if the arm has reported a newer state. An unknown key gives 0.
    /// \return number of cycles that the arm has missed since begin()
    std::uint64_t end(Recorder::Key key);

private:
    /// State of arm and sensor at one time; no force while the sensor is not in order.
    struct Reading {
        device::ArmState arm;
        std::optional<device::WrenchSample> force{};
        SteadyTime time{};
    };
    /// An execution that is under way.
    struct Path {
        Recorder::Key key = 0;
        SteadyTime begin{};
        std::uint64_t missed_at_begin = 0;
        std::optional<Reading> sent{};     ///< the last sample
        std::optional<Reading> skipped{};  ///< read after it, and nearly the same
    };

    void run(const std::stop_token& stop);
    /// Copies the newest state that the devices have published.
    Reading read() const;
    /// Decides whether the reading is a sample of this path, or is skipped. With the lock.
    void take(Path& path, const Reading& reading);
    /// Hands a sample to the recorder and keeps it for the next comparison. With the lock.
    void send(Path& path, const Reading& reading);

    const device::Arm& arm_;
    const device::ForceTorqueSensor* sensor_;
    Recorder& recorder_;

    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::vector<Path> paths_;
    std::jthread thread_;
};

}  // namespace metier::records
