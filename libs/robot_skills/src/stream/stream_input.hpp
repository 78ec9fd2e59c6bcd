#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "metier/base/clock.hpp"
#include "metier/motion/joint_vector.hpp"
#include "metier/motion/trajectory.hpp"

namespace metier::robot_skills {

/// One set-point of a stream on its way to the cycle thread.
struct StreamedPosition {
    motion::JointVector position;     ///< [rad]
    motion::Seconds intended_time{};  ///< when it was meant, since the first of its stream
};

/// Brings streamed set-points from the server's thread to the arm's cycle thread.
///
/// Threading: one writer, one reader; neither locks, waits or allocates.
class StreamQueue {
public:
    static constexpr std::size_t kCapacity = 256;

    /// False when it is full. Writer only.
    bool tryPush(const StreamedPosition& position) noexcept {
        const auto end = written_.load(std::memory_order_relaxed);
        if (end - read_.load(std::memory_order_acquire) == kCapacity) {
            return false;
        }
        slots_[end % kCapacity] = position;
        written_.store(end + 1, std::memory_order_release);
        return true;
    }

    /// The oldest. Reader only.
    std::optional<StreamedPosition> tryPop() noexcept {
        const auto begin = read_.load(std::memory_order_relaxed);
        if (begin == written_.load(std::memory_order_acquire)) {
            return std::nullopt;
        }
        const auto position = slots_[begin % kCapacity];
        read_.store(begin + 1, std::memory_order_release);
        return position;
    }

    /// Number of waiting set-points. Reader only.
    std::size_t size() const noexcept {
        return written_.load(std::memory_order_acquire) - read_.load(std::memory_order_relaxed);
    }

private:
    std::array<StreamedPosition, kCapacity> slots_{};
    std::atomic<std::size_t> written_{0};
    std::atomic<std::size_t> read_{0};
};

/// Times for which streamed set-points are meant: by the sender's clock if the sender gives times,
/// else by arrival.
///
/// Set-points without a time that arrive together are spread by half a cycle of the arm, so that a
/// client that sends one per cycle is followed although the network bunches them. Where no play-out
/// delay evens them out later, the mean rhythm of the arrivals is used instead of each arrival.
/// Threading: the owner's thread.
class StreamTimes {
public:
    enum class Arrivals : std::uint8_t { each, rhythm };

    /// \param clock must outlive this
    /// \param cycle of the arm
    StreamTimes(const Clock& clock, std::chrono::nanoseconds cycle,
                Arrivals arrivals = Arrivals::each)
        : clock_(clock),
          cycle_(cycle),
          least_step_(cycle / 2),
          arrivals_(arrivals),
          interval_(cycle) {}

    /// A new stream begins with the next set-point.
    void restart() noexcept;
    /// Time of the set-point that arrives now, counted from the first one of its stream. Any time
    /// is accepted; it is limited to some years from the first.
    /// \param meant_for by the sender's clock; the smallest time stands for none
    motion::Seconds next(std::optional<UtcTime> meant_for) noexcept;
    /// Step of the sender's clock against ours between the last two set-points: ahead, or negative:
    /// back; 0 without times.
    motion::Seconds clockStep() const noexcept { return clock_step_; }

private:
    /// Time of a set-point that has one.
    /// \param first whether it is the first of its stream
    std::chrono::nanoseconds bySender(UtcTime meant_for, std::chrono::nanoseconds arrival,
                                      bool first) noexcept;
    /// Expected time of the set-point, corrected a little by its arrival.
    std::chrono::nanoseconds inRhythm(std::chrono::nanoseconds arrival) noexcept;

    const Clock& clock_;
    const std::chrono::nanoseconds cycle_;
    const std::chrono::nanoseconds least_step_;
    const Arrivals arrivals_;
    std::chrono::nanoseconds interval_;  ///< between two set-points, if in rhythm
    std::chrono::nanoseconds last_{};
    /// First time that the sender gave, and the stream time that it stands for.
    std::optional<std::pair<UtcTime, std::chrono::nanoseconds>> sender_start_;
    std::optional<std::chrono::nanoseconds> sender_before_;  ///< time of the set-point before
    std::chrono::nanoseconds sender_arrival_{};              ///< when that one came
    motion::Seconds clock_step_{};
    std::optional<SteadyTime> arrival_start_;
    std::chrono::nanoseconds last_arrival_{};
};

}  // namespace metier::robot_skills
