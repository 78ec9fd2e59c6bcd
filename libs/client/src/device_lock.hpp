#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/client/skill_finder.hpp"
#include "metier/opcua/client.hpp"

namespace metier::client {

/// Lock of a device (LockingServices, OPC 10000-100, 7) with its nodes.
struct LockNodes {
    std::string device{};         ///< BrowseName of the object that has the lock
    opcua::NodeId lock{};         ///< object of LockingServicesType; null: there is no lock
    opcua::NodeId init{};         ///< InitLock
    opcua::NodeId renew{};        ///< RenewLock; may be null
    opcua::NodeId exit{};         ///< ExitLock
    opcua::NodeId client{};       ///< LockingClient; may be null
    opcua::NodeId remaining{};    ///< RemainingLockTime; may be null
    opcua::NodeId most_silent{};  ///< MaxInactiveLockTime of the server; may be null

    bool isThere() const { return !lock.isNull(); }
};

/// Finds the lock of the skill itself, or else of the nearest object above it that has one.
/// Errors: those of the server; none if there is no lock.
opcua::Answer<LockNodes> findLock(opcua::Client& client, const SkillAddress& skill);

/// The locks that one client holds. Skills of the same device share its lock. A lock is renewed
/// three times within the time after which the server would end it.
///
/// Threading: any thread; nothing waits. `done` runs on the caller's or the client's thread. Must
/// end before its Client.
class DeviceLocks : public std::enable_shared_from_this<DeviceLocks> {
public:
    using Done = std::function<void(opcua::Answer<>)>;

    explicit DeviceLocks(opcua::Client& client) : client_(client) {}
    /// Gives back what is held.
    ~DeviceLocks();
    DeviceLocks(const DeviceLocks&) = delete;
    DeviceLocks& operator=(const DeviceLocks&) = delete;

    /// Takes a lock, or counts one user more of it. A server that has the nodes of a lock and does
    /// not implement them counts as one without.
    /// Errors, given to `done`: locked, with the name of the client that holds it; those of the
    ///         server.
    void take(const LockNodes& nodes, const Done& done);
    /// Ends one use; the last one gives the lock back.
    /// \param done gets the server's answer; the lock counts as given back whatever it is
    void giveBack(const LockNodes& nodes, const Done& done);

private:
    enum class Stage { asking, held, leaving, missing };
    struct Lock {
        LockNodes nodes;
        Stage stage = Stage::asking;
        int users = 0;
        std::vector<Done> waiting{};  // for the lock
        std::vector<Done> leaving{};  // for the answer to ExitLock
        std::chrono::milliseconds renewal{};
        SteadyTime next_renewal{};
        bool loss_reported = false;
    };
    using Locks = std::map<opcua::NodeId, Lock>;

    void ask(const LockNodes& nodes);
    void asked(const LockNodes& nodes, const opcua::Answer<opcua::CallResult>& answer);
    void explainRefusal(const LockNodes& nodes, opcua::Failure failure);
    void settle(const LockNodes& nodes, Stage stage, const opcua::Answer<>& outcome);
    void left(const LockNodes& nodes, const opcua::Answer<>& outcome);
    void learnTime(const LockNodes& nodes);
    std::vector<LockNodes> dueRenewals(const std::stop_token& stop);
    void renewAll(const std::stop_token& stop);
    void renew(const LockNodes& nodes);
    void renewed(const opcua::NodeId& id, const opcua::Answer<opcua::CallResult>& answer);

    opcua::Client& client_;
    std::mutex mutex_;
    std::condition_variable_any changed_;
    Locks locks_;                // guarded by mutex_
    std::uint64_t changes_ = 0;  // of the times of renewals; guarded by mutex_
    std::jthread thread_;        // renews; made with the first lock
};

/// Use of a device's lock by one skill.
///
/// Threading: as DeviceLocks.
class LockUse : public std::enable_shared_from_this<LockUse> {
public:
    using Done = DeviceLocks::Done;

    LockUse(std::shared_ptr<DeviceLocks> locks, LockNodes nodes)
        : locks_(std::move(locks)), nodes_(std::move(nodes)) {}
    /// Gives the lock back.
    ~LockUse();
    LockUse(const LockUse&) = delete;
    LockUse& operator=(const LockUse&) = delete;

    const LockNodes& nodes() const noexcept { return nodes_; }
    /// Takes the lock; nothing to do if there is none, or it is held.
    /// Errors, given to `done`: as DeviceLocks::take(); cancelled, if it was given back meanwhile.
    void take(Done done);
    /// Gives the lock back; nothing to do if it is not held.
    void giveBack(const Done& done);

private:
    enum class State { free, asking, taken, unwanted };
    opcua::Answer<> taken(opcua::Answer<> outcome);

    // Shared by the skills of one client, and by the answers that are on their way.
    std::shared_ptr<DeviceLocks> locks_;
    const LockNodes nodes_;
    std::mutex mutex_;
    State state_ = State::free;  // guarded by mutex_
};

/// Waits for what `request` passes to its Done.
opcua::Answer<> awaitDone(const std::function<void(DeviceLocks::Done)>& request);

}  // namespace metier::client
