#include "metier/skill/control.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "metier/base/random.hpp"

namespace metier::skill {

namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

/// Random, so that no server that starts again gives the same one out.
std::uint64_t newEpoch() {
    return randomNumber() | 1U;
}

std::string nameOf(const Caller& caller) {
    return caller.client_name.empty() ? "a client" : "\"" + caller.client_name + "\"";
}

Result<void> refusedTo(std::string_view what, const Caller& holder) {
    return fail(Errc::locked, fmt::format("{} {} it", nameOf(holder), what));
}

}  // namespace

Control::Control(std::shared_ptr<Executor> executor, const Clock& clock)
    : executor_(std::move(executor)), clock_(clock) {}

void Control::attach(Listener& listener) {
    listeners_.push_back(&listener);
}

void Control::detach(Listener& listener) {
    std::erase(listeners_, &listener);
}

Result<std::uint64_t> Control::acquire(const Caller& caller, milliseconds lease,
                                       OwnerLossAction action) {
    METIER_TRY(checkFree(caller));
    const auto wanted = lease == milliseconds(0) ? kDefaultLease : lease;
    if (wanted < kShortestLease || wanted > kLongestLease) {
        return fail(Errc::out_of_range,
                    fmt::format("LeaseMs: {} ms is outside {} to {} ms", wanted.count(),
                                kShortestLease.count(), kLongestLease.count()));
    }
    stale_sessions_.erase(caller.session_id);
    leased_ = true;
    leaser_ = caller;
    epoch_ = newEpoch();
    on_loss_ = action;
    lease_ = wanted;
    lease_end_ = clock_.now() + lease_;
    armLease();
    return epoch_;
}

Result<void> Control::checkHolds(const Caller& caller, std::uint64_t epoch) const {
    if (leased_ && epoch == epoch_ && leaser_.session_id == caller.session_id) {
        return {};
    }
    return fail(Errc::locked,
                fmt::format("epoch {} is not the caller's: its lease has ended", epoch));
}

Result<void> Control::heartbeat(const Caller& caller, std::uint64_t epoch) {
    METIER_TRY(checkHolds(caller, epoch));
    lease_end_ = clock_.now() + lease_;
    return {};
}

Result<void> Control::release(const Caller& caller, std::uint64_t epoch) {
    METIER_TRY(checkHolds(caller, epoch));
    endLease();
    return {};
}

/// The timer is not moved by a heartbeat: when it is due it looks how much is left.
void Control::armLease() {
    lease_timer_ = executor_->after(lease_end_ - clock_.now(), [this] { leaseDue(); });
}

void Control::leaseDue() {
    if (clock_.now() < lease_end_) {
        armLease();
        return;
    }
    stale_sessions_.insert(leaser_.session_id);
    lose(fmt::format("no heartbeat of {} for {} ms", nameOf(leaser_),
                     std::chrono::duration_cast<milliseconds>(lease_).count()));
}

void Control::lose(const std::string& text) {
    const auto session = leaser_.session_id;
    const auto action = on_loss_;
    losses_.fetch_add(1, std::memory_order_relaxed);
    endLease();
    for (auto* listener : listeners_) {
        listener->onControlLost(session, action, text);
    }
}

void Control::endLease() {
    leased_ = false;
    leaser_ = {};
    lease_timer_.cancel();
}

Result<void> Control::lock(const Caller& caller) {
    METIER_TRY(checkFree(caller));
    stale_sessions_.erase(caller.session_id);
    locked_ = true;
    locker_ = caller;
    lock_end_ = clock_.now() + kLockTime;
    armLock();
    return {};
}

Result<void> Control::renewLock(const Caller& caller) {
    if (!locked_ || locker_.session_id != caller.session_id) {
        return fail(Errc::invalid_state, "the caller does not hold the lock");
    }
    lock_end_ = clock_.now() + kLockTime;
    return {};
}

Result<void> Control::unlock(const Caller& caller) {
    if (!locked_ || locker_.session_id != caller.session_id) {
        return fail(Errc::invalid_state, "the caller does not hold the lock");
    }
    endLock();
    return {};
}

Result<void> Control::breakLock() {
    if (!locked_) {
        return fail(Errc::invalid_state, "nobody holds the lock");
    }
    endLock();
    return {};
}

void Control::armLock() {
    lock_timer_ = executor_->after(lock_end_ - clock_.now(), [this] {
        if (clock_.now() < lock_end_) {
            armLock();
        } else {
            endLock();
        }
    });
}

void Control::endLock() {
    locked_ = false;
    locker_ = {};
    lock_timer_.cancel();
}

Result<void> Control::checkCommand(const Caller& caller) const {
    if (caller.of_this_server) {
        return {};
    }
    if (stale_sessions_.contains(caller.session_id)) {
        return fail(Errc::locked,
                    fmt::format("the lease of {} has run out: it commands again once it has taken "
                                "control anew",
                                nameOf(caller)));
    }
    return checkFree(caller);
}

Result<void> Control::checkFree(const Caller& caller) const {
    if (leased_ && leaser_.session_id != caller.session_id) {
        return refusedTo("has control of", leaser_);
    }
    if (locked_ && locker_.session_id != caller.session_id) {
        return refusedTo("has locked", locker_);
    }
    return {};
}

Result<void> Control::checkEpoch(const Caller& caller, std::uint64_t epoch) const {
    return epoch == 0 ? checkCommand(caller) : checkHolds(caller, epoch);
}

void Control::sessionClosed(std::string_view session_id) {
    if (locked_ && locker_.session_id == session_id) {
        endLock();
    }
    if (leasedBy(session_id)) {
        lose(fmt::format("the session of {} has ended", nameOf(leaser_)));
    }
    if (const auto stale = stale_sessions_.find(session_id); stale != stale_sessions_.end()) {
        stale_sessions_.erase(stale);
    }
}

const Caller& Control::holder() const noexcept {
    return leased_ ? leaser_ : locker_;
}

bool Control::leasedBy(std::string_view session_id) const noexcept {
    return leased_ && leaser_.session_id == session_id;
}

nanoseconds Control::leaseRemaining() const noexcept {
    return leased_ ? std::max(nanoseconds(0), nanoseconds(lease_end_ - clock_.now()))
                   : nanoseconds(0);
}

nanoseconds Control::lockRemaining() const noexcept {
    return locked_ ? std::max(nanoseconds(0), nanoseconds(lock_end_ - clock_.now()))
                   : nanoseconds(0);
}

}  // namespace metier::skill
