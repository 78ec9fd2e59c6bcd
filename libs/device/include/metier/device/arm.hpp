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
    /// The arm may move.
    normal,
    /// The controller stopped the arm, such as for a collision; resetFault() ends it.
    protective_stop,
    /// The button is pressed; release it first, then resetFault().
    emergency_stop,
    /// The controller needs a person, or does not do what the driver asks of it.
    fault,
    /// Nothing is known of the arm: there is no connection to its controller.
    disconnected,
};

/// Name for texts, with a blank instead of an underscore: "protective stop". Valid for ever.
std::string_view toString(SafetyState state) noexcept;

/// The safety state with its reason.
struct Safety {
    /// State that the controller reports, or that the driver sees by its connection.
    SafetyState state = SafetyState::normal;
    /// Reason for a person, with the device's name; empty while normal.
    std::string text{};
    /// Whether the reason is a set-point beyond a limit of the controller; skills end as
    /// limit_violated then.
    bool limit_violated = false;
};

/// Checks that the device may be used.
/// Errors: device_fault with text and state, unless the state is normal.
/// Threads: any; pure.
Result<void> checkNormal(const Safety& safety);

/// Properties of an arm that do not change while it is connected.
struct ArmInfo {
    /// Name of the server that has the arm, for messages.
    std::string name;
    /// One name per axis, axis 1 first; 1 to kMaxAxes.
    std::vector<std::string> axis_names;
    /// Period of the set-points, > 0.
    std::chrono::nanoseconds cycle{};

    /// Number of axes, 1 to kMaxAxes.
    std::size_t axisCount() const noexcept { return axis_names.size(); }
    /// Period of the set-points [s].
    double cycleSeconds() const noexcept { return std::chrono::duration<double>(cycle).count(); }
};

/// The arm as its controller reports it, once per cycle. Trivially copyable.
struct ArmState {
    /// Measured joint position [rad], axis 1 first, as are those below.
    JointArray position;
    /// Measured joint velocity [rad/s].
    JointArray velocity;
    /// Last set-point that the controller took [rad].
    JointArray commanded_position;
    /// Safety state when this was published; its reason is at Arm::safety().
    SafetyState safety = SafetyState::disconnected;
    /// Whether the measured arm does not move.
    bool standstill = true;
    /// Number of cycles of the controller since it was connected.
    std::uint64_t cycle = 0;
    /// Number of cycles among these that ran more than one period late.
    std::uint64_t missed_cycles = 0;
    /// Time at which this state was taken, on this machine's monotonic clock; SteadyTime{}: none
    /// yet.
    SteadyTime stamp{};
};

/// Reason for which an arm has let go of a set-point source.
enum class EndCause : std::uint8_t {
    /// The source returned Next::done.
    done,
    /// Arm::stop(); reported at standstill.
    stopped,
    /// The controller's safety stopped the arm; reported at standstill.
    safety,
    /// The controller is gone; reported at once, the arm brakes by itself.
    disconnected,
};

/// Source of an arm's motion: gives one set-point per cycle for as long as it is attached, from
/// Arm::attach() to ended().
///
///     class Hold final : public SetPointSource {
///         Next next(const ArmState&, JointArray&) noexcept override { return Next::set_point; }
///         void ended(EndCause, const Safety&) override { over_.set_value(); }
///         std::promise<void> over_;
///     };
class SetPointSource {
public:
    /// Answer of next().
    enum class Next : std::uint8_t {
        /// `set_point` was filled: the arm goes there in this cycle.
        set_point,
        /// Nothing more: the arm holds its last set-point, and ended() follows with EndCause::done.
        done,
    };

    virtual ~SetPointSource() = default;

    /// Computes the set-point of this cycle. Called by the arm's cycle thread, once per cycle: must
    /// not allocate, lock, wait, log or throw. No limit is checked here but those of the
    /// controller.
    /// \param state      the arm at the begin of this cycle
    /// \param set_point  [rad], axis 1 first; comes in as the last commanded position
    virtual Next next(const ArmState& state, JointArray& set_point) noexcept = 0;

    /// Reports that the arm has let go of this source: no next() follows, and everything that
    /// next() wrote is visible. Called exactly once for each attach, by the arm's notifying thread
    /// (never its cycle thread), or by the thread that destroys the arm; may lock, should not wait.
    /// It may attach a source to the arm again.
    /// \param safety the arm's safety state at this call, with its reason
    virtual void ended(EndCause cause, const Safety& safety) = 0;

    /// Name of the execution for which this source moves the arm, for records; empty: not known.
    /// Called from any thread while it is attached.
    virtual std::string_view execution() const noexcept { return {}; }
};

/// Registration of a callback; its destructor ends it. No call begins after that, but one that
/// already runs may still be running.
///
/// Threading: one thread at a time; may outlive the object that gave it.
class Registration {
public:
    /// A registration of nothing.
    Registration() = default;
    /// \param end called once, by the destructor; must not throw
    explicit Registration(std::function<void()> end) : end_(std::move(end)) {}
    Registration(Registration&& other) noexcept : end_(std::exchange(other.end_, nullptr)) {}
    /// Exchanges the two: the former registration ends with `other`.
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
///     auto source = std::make_shared<MySource>();  // a SetPointSource
///     if (auto attached = arm.attach(source); !attached) { ... attached.error().message ... }
///
/// It may be disconnected at any time, also at first; it connects again by itself, and moves
/// nothing when it does.
/// Threading: every function from any thread but the arm's own cycle thread; none waits for the
/// arm. state() neither locks nor allocates.
class Arm {
public:
    /// Callback for a change of the safety state, with the newest state; may lock, should not wait.
    using SafetyCallback = std::function<void(const Safety&)>;

    virtual ~Arm() = default;

    /// Properties of the arm; the reference is valid as long as the arm.
    virtual const ArmInfo& info() const noexcept = 0;

    /// The newest state; before the first connection all zero, disconnected.
    virtual ArmState state() const noexcept = 0;

    /// The newest safety state with its reason.
    /// May lock: for a cycle thread ArmState::safety is there.
    virtual Safety safety() const = 0;

    /// Histogram of |time from one cycle to the next - period| [s]; nullptr: not measured.
    virtual const TimeHistogram* cycleJitter() const noexcept { return nullptr; }

    /// Lets `source` move the arm from the next cycle on, until it is done or the arm is stopped.
    /// The controller checks the first set-point against state().commanded_position. The source is
    /// shared: the arm keeps it alive until its cycle thread has let go of it.
    /// \param source not null
    /// Errors: resource_unavailable while another source moves the arm or its end was not reported
    ///         yet, device_fault if the safety state is not normal (the text says why).
    virtual Result<void> attach(std::shared_ptr<SetPointSource> source) = 0;

    /// Stops the arm with the controller's own stop, which brakes as hard as it may and follows no
    /// path, and lets go of the source: ended() follows at standstill. Does nothing if the arm
    /// stands still.
    virtual void stop() noexcept = 0;

    /// Asks the controller to leave a stop or fault; returns success if the safety state is normal.
    /// Does not wait for the controller, since a server's thread calls it.
    /// Errors: timeout: the reset has begun or goes on, call again for its outcome; device_fault,
    ///         connection_lost: the text says what is still wrong.
    virtual Result<void> resetFault() = 0;

    /// Calls `callback` on the arm's notifying thread after each change of the safety state.
    virtual Registration onSafetyChange(SafetyCallback callback) = 0;
};

}  // namespace metier::device
