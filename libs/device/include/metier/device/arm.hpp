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

/// Safety state of a device, as its controller decides it. It is observed and obeyed, never
/// commanded.
enum class SafetyState : std::uint8_t {
    normal,           ///< the arm may move
    protective_stop,  ///< the controller stopped the arm; resetFault() ends it
    emergency_stop,   ///< the button is pressed; release it first, then resetFault()
    fault,            ///< the controller needs a person
    disconnected,     ///< nothing is known of the arm
};

/// The enumerator's name, for texts.
std::string_view toString(SafetyState state) noexcept;

/// The safety state with its reason.
struct Safety {
    SafetyState state = SafetyState::normal;
    std::string text{};           ///< reason, for a person; empty while normal
    bool limit_violated = false;  ///< the reason is a set-point beyond a limit of the controller
};

/// Errors: device_fault with text and state, unless the state is normal.
Result<void> checkNormal(const Safety& safety);

/// Properties of an arm that do not change while it is connected.
struct ArmInfo {
    std::string name;
    std::vector<std::string> axis_names;  ///< one per axis, axis 1 first
    std::chrono::nanoseconds cycle{};     ///< period of the set-points, > 0

    std::size_t axisCount() const noexcept { return axis_names.size(); }
    /// Period of the set-points [s].
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
    std::uint64_t missed_cycles = 0;  ///< cycles among these that ran more than one period late
    SteadyTime stamp{};               ///< time at which this state was taken
};

/// Reason for which an arm has let go of a set-point source.
enum class EndCause : std::uint8_t {
    done,          ///< the source returned Next::done
    stopped,       ///< Arm::stop(); reported at standstill
    safety,        ///< the controller's safety stopped the arm; reported at standstill
    disconnected,  ///< the controller is gone; reported at once, the arm brakes by itself
};

/// Source of an arm's motion: gives one set-point per cycle for as long as it is attached.
class SetPointSource {
public:
    enum class Next : std::uint8_t {
        set_point,  ///< `set_point` was filled: the arm goes there in this cycle
        done,       ///< nothing more; the arm holds its last set-point
    };

    virtual ~SetPointSource() = default;

    /// Computes the set-point of this cycle. Called by the arm's cycle thread, once per cycle: must
    /// not allocate, lock, wait, log or throw.
    /// \param state      the arm at the begin of this cycle
    /// \param set_point  [rad]; comes in as the last commanded position
    virtual Next next(const ArmState& state, JointArray& set_point) noexcept = 0;

    /// Reports that the arm has let go of this source: no next() follows, and everything that
    /// next() wrote is visible. Called exactly once for each attach, by the arm's notifying thread
    /// (never its cycle thread); may lock, should not wait. It may attach a source to the arm
    /// again.
    virtual void ended(EndCause cause, const Safety& safety) = 0;

    /// Name of the execution for which this source moves the arm, for records; empty: not known.
    /// Called from any thread while it is attached.
    virtual std::string_view execution() const noexcept { return {}; }
};

/// Registration of a callback; its destructor ends it. No call begins after that, but one that
/// already runs may still be running.
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

/// A robot arm that follows joint set-points: the interface of every arm driver.
///
/// Threading: every function from any thread but the arm's own cycle thread; none waits for the
/// arm. state() neither locks nor allocates.
class Arm {
public:
    using SafetyCallback = std::function<void(const Safety&)>;

    virtual ~Arm() = default;

    /// Properties of the arm; the reference is valid as long as the arm.
    virtual const ArmInfo& info() const noexcept = 0;

    /// The newest state.
    virtual ArmState state() const noexcept = 0;

    /// The newest safety state with its reason.
    virtual Safety safety() const = 0;

    /// Histogram of |time from one cycle to the next - period| [s]; nullptr: not measured.
    virtual const TimeHistogram* cycleJitter() const noexcept { return nullptr; }

    /// Lets `source` move the arm from the next cycle on, until it is done or the arm is stopped.
    /// The controller checks the first set-point against state().commanded_position. The source is
    /// shared: the arm keeps it alive until its cycle thread has let go of it.
    /// Errors: resource_unavailable while another source moves the arm,
    ///         device_fault if the safety state is not normal (the text says why).
    virtual Result<void> attach(std::shared_ptr<SetPointSource> source) = 0;

    /// Stops the arm with the controller's own stop, which brakes as hard as it may and follows no
    /// path, and lets go of the source. Does nothing if the arm stands still.
    virtual void stop() noexcept = 0;

    /// Asks the controller to leave a stop or fault. Does not wait for it, since a server's thread
    /// calls it.
    /// Errors: timeout: the reset has begun or goes on, call again for its outcome;
    ///         device_fault, connection_lost: the text says what is still wrong.
    virtual Result<void> resetFault() = 0;

    /// Calls `callback` on the arm's notifying thread after each change of the safety state.
    virtual Registration onSafetyChange(SafetyCallback callback) = 0;
};

}  // namespace metier::device
