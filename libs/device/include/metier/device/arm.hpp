#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/base/histogram.hpp"
#include "metier/device/joint_array.hpp"

namespace metier::device {

/// What the controller's own safety allows. It is observed and obeyed, never commanded.
enum class SafetyState : std::uint8_t {
    normal,           ///< the arm may move
    protective_stop,  ///< the controller stopped the arm; resetFault() ends it
    emergency_stop,   ///< someone pressed it; release it first, then resetFault()
    fault,            ///< the controller needs a person
    disconnected,     ///< nothing is known of the arm
};

/// The enumerator's name, for texts.
std::string_view toString(SafetyState state) noexcept;

/// The safety state and why it is so.
struct Safety {
    SafetyState state = SafetyState::normal;
    std::string text{};           ///< for a person; empty while normal
    bool limit_violated = false;  ///< because a set-point broke a limit of the controller
};

/// What does not change while the arm is connected.
struct ArmInfo {
    std::string name;
    std::vector<std::string> axis_names;  ///< one per axis, axis 1 first
    std::chrono::nanoseconds cycle{};     ///< period of the set-points, > 0

    std::size_t axisCount() const noexcept { return axis_names.size(); }
    double cycleSeconds() const noexcept { return std::chrono::duration<double>(cycle).count(); }
};

/// The arm as its controller reports it, once per cycle. Trivially copyable.
struct ArmState {
    JointArray position;            ///< measured [rad]
    JointArray velocity;            ///< measured [rad/s]
    JointArray commanded_position;  ///< last set-point that the controller took [rad]
    SafetyState safety = SafetyState::disconnected;
    bool standstill = true;           ///< the measured arm does not move
    std::uint64_t cycle = 0;          ///< cycles of the controller since it was connected
    std::uint64_t missed_cycles = 0;  ///< of these, run later than one whole period
    SteadyTime stamp{};               ///< when this state was taken
};

/// Why the arm no longer asks a source.
enum class EndCause : std::uint8_t {
    done,          ///< the source said so
    stopped,       ///< Arm::stop(); reported at standstill
    safety,        ///< the controller's safety stopped the arm; reported at standstill
    disconnected,  ///< the controller is gone; reported at once, the arm brakes by itself
};

/// Whoever moves an arm: gives one set-point per cycle for as long as it is attached.
class SetPointSource {
public:
    enum class Next : std::uint8_t {
        set_point,  ///< `set_point` was filled: go there in this cycle
        done,       ///< nothing more; the arm holds its last set-point
    };

    virtual ~SetPointSource() = default;

    /// The set-point of this cycle. Called by the arm's cycle thread, once per cycle: must not
    /// allocate, lock, wait, log or throw.
    /// \param state      the arm at the begin of this cycle
    /// \param set_point  [rad]; comes in as the last commanded position
    virtual Next next(const ArmState& state, JointArray& set_point) noexcept = 0;

    /// The arm let go: no next() comes after it, and all that next() wrote is visible. Called
    /// exactly once for each attach, by the arm's notifying thread (never its cycle thread); may
    /// lock, should not wait. The arm can be attached to again from within.
    virtual void ended(EndCause cause, const Safety& safety) = 0;

    /// Names what it moves the arm for, for records; empty: nothing is known. Any thread, while it
    /// is attached.
    virtual std::string_view execution() const noexcept { return {}; }
};

/// Ends a registration when it is destroyed: from then on no call begins, but one that already
/// runs may still end.
class Registration {
public:
    Registration() = default;
    explicit Registration(std::function<void()> end) : end_(std::move(end)) {}
    Registration(Registration&& other) noexcept : end_(std::exchange(other.end_, nullptr)) {}
    Registration& operator=(Registration&& other) noexcept {
        std::swap(end_, other.end_);
        return *this;
    }
    Registration(const Registration&) = delete;
    Registration& operator=(const Registration&) = delete;
    ~Registration() {
        if (end_) {
            end_();
        }
    }

private:
    std::function<void()> end_;
};

/// A robot arm that follows joint set-points: what every driver of an arm offers.
///
/// Threading: every function from any thread but the arm's own cycle thread; none waits for the
/// arm. state() neither locks nor allocates.
class Arm {
public:
    using SafetyCallback = std::function<void(const Safety&)>;

    virtual ~Arm() = default;

    virtual const ArmInfo& info() const noexcept = 0;

    /// The newest state.
    virtual ArmState state() const noexcept = 0;

    /// The newest safety state with its reason.
    virtual Safety safety() const = 0;

    /// How far the time from one cycle to the next was off the period [s]; null: not measured.
    virtual const TimeHistogram* cycleJitter() const noexcept { return nullptr; }

    /// Lets `source` move the arm from the next cycle on, until it is done or the arm is stopped.
    /// The source's first set-point is judged against state().commanded_position.
    /// Shared: the arm keeps the source alive until its cycle thread has let go of it.
    /// Errors: resource_unavailable while another source moves the arm,
    ///         device_fault if the safety state is not normal (the text says why).
    virtual Result<void> attach(std::shared_ptr<SetPointSource> source) = 0;

    /// The controller's own stop: brakes as hard as it may, not on any path, and lets go of the
    /// source. Does nothing to an arm that stands.
    virtual void stop() noexcept = 0;

    /// Asks the controller to leave a stop or fault. Does not wait for it: it is called on the
    /// thread of a server. Errors: timeout: the reset has begun or goes on, ask again for its
    /// outcome; device_fault,
    ///         connection_lost: the text says what is still wrong.
    virtual Result<void> resetFault() = 0;

    /// Calls `callback` on the arm's notifying thread after each change of the safety state.
    virtual Registration onSafetyChange(SafetyCallback callback) = 0;
};

}  // namespace metier::device
