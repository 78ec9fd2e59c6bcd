#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/skill/caller.hpp"
#include "metier/skill/executor.hpp"
#include "metier/skill/state.hpp"

namespace metier::skill {

/// The right to command the skills of one controller, and the check that its holder is still there.
///
/// A client holds control by a lease, which ends unless heartbeats renew it, or by a lock, which
/// only keeps others out. One session holds either or both; while it does, others are refused
/// everything but Halt. The lease is the dead-man switch: when it runs out, or its session ends,
/// the listeners are notified and every execution of that session does what its start asked for. A
/// session whose lease ran out is refused everything but Halt until it takes a lease or the lock
/// anew: commands that it sent before it noticed, or that the network delivers late, move nothing.
///
/// Give the same Control to the ProgramOptions of all skills of the controller; they listen by
/// themselves. In a server SkillServer::serveControl() connects it to the nodes.
/// Threading: the owner's thread, which all its Programs share.
class Control {
public:
    /// Lease that acquire() gives when it is asked for 0.
    static constexpr std::chrono::milliseconds kDefaultLease{1'000};
    /// Shortest lease that acquire() accepts: a client must be able to renew it in time.
    static constexpr std::chrono::milliseconds kShortestLease{100};
    /// Longest lease that acquire() accepts: one hour.
    static constexpr std::chrono::milliseconds kLongestLease{3'600'000};
    /// Time after which a lock ends if it is not renewed.
    static constexpr std::chrono::milliseconds kLockTime{60'000};

    /// Observer of the loss of control. Called on the owner's thread.
    class Listener {
    public:
        virtual ~Listener() = default;
        /// \param session id of the session that held the lease
        /// \param action  as given to acquire(); skill_default leaves it to each skill
        /// \param text    reason, for a person at the client
        /// May not attach or detach a listener, nor destroy the Control.
        virtual void onControlLost(std::string_view session, OwnerLossAction action,
                                   const std::string& text) = 0;
    };

    /// \param executor runs the timers of lease and lock; calls of this class come from its thread
    /// \param clock    measures lease and lock; must outlive this
    Control(std::shared_ptr<Executor> executor, const Clock& clock);
    Control(const Control&) = delete;
    Control& operator=(const Control&) = delete;

    /// Adds a listener, which must be detached before its life ends. Listeners are called in the
    /// order of their attach().
    void attach(Listener& listener);
    /// Ends the calls to a listener; nothing happens if it was not attached.
    void detach(Listener& listener);

    /// Takes the lease, or begins a new one with a new epoch if the caller holds it already. A
    /// session whose lease ran out may command again.
    /// \param lease  time until it ends without a heartbeat, kShortestLease to kLongestLease; 0:
    ///               kDefaultLease
    /// \param action for the executions of this session when the lease is lost, unless their start
    ///               says otherwise
    /// \return the epoch, which names this time of control; random and never 0, so that no epoch is
    /// given out again after a restart
    /// Errors: locked (another session holds the lease or the lock); out_of_range (lease).
    Result<std::uint64_t> acquire(const Caller& caller, std::chrono::milliseconds lease,
                                  OwnerLossAction action);
    /// Begins the lease anew, with the length that acquire() was given.
    /// Errors: locked, if the caller does not hold this epoch any more, or never did.
    Result<void> heartbeat(const Caller& caller, std::uint64_t epoch);
    /// Gives the lease back. Nothing is stopped, and no listener is called.
    /// Errors: as heartbeat().
    Result<void> release(const Caller& caller, std::uint64_t epoch);

    /// Takes the lock for kLockTime, or begins that time anew if the caller holds it. A session
    /// whose lease ran out may command again.
    /// Errors: locked (another session holds the lease or the lock).
    Result<void> lock(const Caller& caller);
    /// Begins the lock's time anew.
    /// Errors: invalid_state, if the caller does not hold the lock.
    Result<void> renewLock(const Caller& caller);
    /// Gives the lock back.
    /// Errors: invalid_state, if the caller does not hold the lock.
    Result<void> unlock(const Caller& caller);
    /// Takes the lock from its holder; a lease stays. The caller's right to do so is checked
    /// elsewhere.
    /// Errors: invalid_state, if nobody holds it.
    Result<void> breakLock();

    /// Checks that the caller may command. A skill of this server (Caller::of_this_server) always
    /// may.
    /// Errors: locked, with the name of the holder, or because the caller's own lease ran out.
    Result<void> checkCommand(const Caller& caller) const;
    /// Checks that the caller may command and holds the lease of this epoch; 0: no epoch is needed,
    /// as checkCommand().
    /// Errors: locked.
    Result<void> checkEpoch(const Caller& caller, std::uint64_t epoch) const;

    /// Ends lock and lease of a session that has ended. If it held the lease, the listeners are
    /// notified before this returns.
    void sessionClosed(std::string_view session_id);

    /// Holder of the lease, or else of the lock; empty session id: there is none. The reference
    /// stays valid, its content changes with the holder.
    const Caller& holder() const noexcept;
    /// Epoch of the present lease, or else of the last one; 0 before the first.
    std::uint64_t epoch() const noexcept { return epoch_; }
    /// Whether `session_id` holds the lease.
    bool leasedBy(std::string_view session_id) const noexcept;
    /// Time until the lease ends without a heartbeat; 0 if there is no lease.
    std::chrono::nanoseconds leaseRemaining() const noexcept;
    /// Number of leases that ran out or ended with their session, since this was made. Threads:
    /// any.
    std::uint64_t losses() const noexcept { return losses_.load(std::memory_order_relaxed); }
    /// Whether a session holds the lock.
    bool isLocked() const noexcept { return locked_; }
    /// Holder of the lock; empty session id: there is none.
    const Caller& locker() const noexcept { return locker_; }
    /// Time until the lock ends without a renewal; 0 if there is no lock.
    std::chrono::nanoseconds lockRemaining() const noexcept;

private:
    /// Checks that no session but the caller's holds lease or lock.
    Result<void> checkFree(const Caller& caller) const;
    /// Checks that the caller holds the lease of this epoch. Errors: locked.
    Result<void> checkHolds(const Caller& caller, std::uint64_t epoch) const;
    /// Sets the timer to the end of the lease.
    void armLease();
    /// Ends the lease if its time is over; a heartbeat may have moved the end meanwhile.
    void leaseDue();
    /// Ends the lease and notifies the listeners.
    void lose(const std::string& text);
    /// Ends the lease without a word to the listeners.
    void endLease();
    /// Sets the timer to the end of the lock.
    void armLock();
    void endLock();

    // Shared by the Programs of its thread.
    std::shared_ptr<Executor> executor_;
    const Clock& clock_;
    // Not owned; in the order of attach().
    std::vector<Listener*> listeners_;

    std::atomic<std::uint64_t> losses_{0};
    bool leased_ = false;
    Caller leaser_;
    std::uint64_t epoch_ = 0;
    OwnerLossAction on_loss_ = OwnerLossAction::skill_default;
    std::chrono::nanoseconds lease_{0};
    SteadyTime lease_end_;
    Timer lease_timer_;
    std::set<std::string, std::less<>> stale_sessions_;  // their lease ran out, they live

    bool locked_ = false;
    Caller locker_;
    SteadyTime lock_end_;
    Timer lock_timer_;
};

}  // namespace metier::skill
