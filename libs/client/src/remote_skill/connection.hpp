#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "metier/client/async_skill.hpp"
#include "metier/client/remote_server.hpp"
#include "metier/opcua/client.hpp"

namespace metier::client {

class RemoteUsedSkill;

/// A skill together with the client that leads to it, which ends after it.
struct OpenSkill {
    std::shared_ptr<opcua::Client> client;  // shared by the skills of one session
    client::AsyncSkill skill;
};

/// The way to a used skill on the owner's thread, for as long as both are there.
class UsedSkillLink : public std::enable_shared_from_this<UsedSkillLink> {
public:
    explicit UsedSkillLink(std::shared_ptr<skill::Executor> executor)
        : executor_(std::move(executor)) {}

    /// Runs `work` with the used skill, on the owner's thread. Any thread.
    void post(std::function<void(RemoteUsedSkill&)> work);
    /// The owner's thread.
    void attach(RemoteUsedSkill* used) { used_ = used; }
    /// Runs `work` after the delay, unless the Timer has ended. The owner's thread.
    [[nodiscard]] skill::Timer after(std::chrono::nanoseconds delay, std::function<void()> work) {
        return executor_->after(delay, std::move(work));
    }

    // Shared by what its thread owns
private:
    std::shared_ptr<skill::Executor> executor_;
    RemoteUsedSkill* used_ = nullptr;
};

/// The thread that waits for the other server: connects again, reads, and ends what takes time.
class Connection {
public:
    /// A skill that is opened again with each session.
    struct Use {
        std::string skill;  ///< "Controller/Name"
        std::shared_ptr<UsedSkillLink> link;
    };

    Connection(RemoteServerOptions options, std::shared_ptr<opcua::Client> client);
    ~Connection();
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;

    const RemoteServerOptions& options() const noexcept { return options_; }
    opcua::Client& client() { return *client_; }
    /// Opens a skill of the present session, and of each one to come.
    Result<std::shared_ptr<OpenSkill>> open(const client::SkillAddress& address,
                                            const std::shared_ptr<UsedSkillLink>& link);
    /// Runs `job` on this thread; jobs may wait.
    void run(std::function<void()> job);
    /// Has the thread connect again, as after a loss. Any thread.
    /// \param client whose connection is of no use any more
    void noteLoss(const opcua::Client& client, const std::string& why);
    /// As RemoteServer::awaySince().
    std::optional<SteadyTime> awaySince() const;

    static opcua::Answer<std::unique_ptr<opcua::Client>> connect(
        const RemoteServerOptions& options);

private:
    void work(const std::stop_token& stop);
    void watch(opcua::Client& client);
    client::AsyncSkill::Watch watchFor(const opcua::Client& client,
                                       const std::shared_ptr<UsedSkillLink>& link);
    std::shared_ptr<DeviceLocks> locksOf(opcua::Client& client);
    void lose(const std::string& why);
    /// Whether all is there again.
    bool reconnect();
    /// Has the used skill of a use go on with the present session; nothing if its skill is not
    /// there.
    std::function<void()> adoptionOf(const Use& use);
    /// Warns of a reason that is not the last one of its kind; the log of what comes again and
    /// again is for those who look for it.
    void warn(std::string& last, std::string text) const;
    std::shared_ptr<opcua::Client> present() const;

    const RemoteServerOptions options_;
    // Both guarded by mutex_; the client with its OpenSkills, whichever ends last.
    std::shared_ptr<opcua::Client> client_;
    std::vector<Use> uses_;
    // Locks of the skills of locked_client_, which share them; guarded by mutex_.
    std::weak_ptr<DeviceLocks> locks_;
    const opcua::Client* locked_client_ = nullptr;

    mutable std::mutex mutex_;
    std::optional<SteadyTime> away_since_;  // guarded by mutex_
    std::condition_variable_any changed_;
    std::vector<std::function<void()>> jobs_;
    std::string lost_;         // why; empty while connected
    bool loss_noted_ = false;  // loss of client_ was noted; guarded by mutex_
    // Used by the thread only: text of the loss that was logged, since the last connection.
    std::string reported_loss_;
    std::string reported_attempt_;
    std::jthread thread_;
};

}  // namespace metier::client
