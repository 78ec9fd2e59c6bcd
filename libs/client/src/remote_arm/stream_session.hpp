#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/client/remote_arm.hpp"
#include "metier/client/skill_handle.hpp"
#include "metier/opcua/client.hpp"
#include "remote_arm/arm_poll.hpp"
#include "remote_arm/notes.hpp"
#include "remote_arm/published_arm.hpp"
#include "remote_arm/stream_target.hpp"
#include "remote_arm/wake_up.hpp"

namespace metier::client {

/// One connection to the server of an arm, for as long as it holds.
///
/// Threading: one owner; what comes in is noted by the client's thread, which wakes the owner.
class StreamSession {
public:
    /// \param wake_up notified after each change of what is observed; shared with late answers
    static Result<std::unique_ptr<StreamSession>> open(const RemoteArmOptions& remote,
                                                       std::shared_ptr<WakeUp> wake_up);

    const PublishedArm& arm() const noexcept { return arm_; }
    Observed observed() const { return notes_->observed(); }
    std::vector<Lack> lacks() const;
    /// Reads the values that the server does not publish by itself, at most once in a period.
    /// Nothing waits.
    void poll(std::chrono::nanoseconds period) { poll_->ask(period); }

    /// Starts the stream skill; a stream that was halted is not reset here. A stream of another
    /// maker gets its first set-point before.
    /// \param parent the execution that it is started for, if that is known
    /// \param first  set-point at which the arm stands
    Result<void> startStream(const skill::ParentExecution& parent, const device::JointArray& first);
    /// Sends a set-point; nothing waits. Its failure shows in observed().
    void send(const device::JointArray& set_point, UtcTime meant_for);

    /// How a stream ends after its last set-point.
    enum class Ending {
        awaited,  ///< the skill will be Ready; nothing waited
        reached,  ///< the skill was halted and is Ready again
    };
    /// Ends the stream, by EndOfStream, or else by Halt and Reset, which wait.
    Result<Ending> endStream();
    /// Whether the stream is of another maker: it does not end by silence.
    bool isForeign() const noexcept { return foreign_; }
    /// Whether the measured position is read again and again; else the server publishes it.
    bool asksForPosition() const noexcept { return !arm_.nodes; }
    /// Whether the server has not answered set-points for so long that more would reach the arm in
    /// one leap.
    bool isBehind() const;
    /// Halts the stream. Waits for the answer, not for standstill.
    /// \return false if it had ended by itself
    Result<bool> haltStream();
    /// Resets the stream skill, by way of Halted if it is not there; one of another maker is halted
    /// also while it runs, since nobody else would end what a component that was killed has left.
    /// \param stopped whether the arm is stopped
    Result<void> resetStream(bool stopped);
    /// Resets a stream skill that was halted. Waits for the answer.
    Result<void> resetHalted();

private:
    StreamSession(std::unique_ptr<opcua::Client> client, PublishedArm arm,
                  client::SkillHandle stream, std::optional<ForeignStream> foreign,
                  std::shared_ptr<WakeUp> wake_up);

    Result<void> subscribe();
    void subscribeTransitions();
    Result<void> subscribePosition(const KinematicsNodes& nodes);
    Result<void> subscribeState(const KinematicsNodes& nodes);
    Result<void> subscribeStandstill(const KinematicsNodes& nodes);
    Result<void> presetTarget(const device::JointArray& first);
    void write(std::string_view parameter, const skill::Value& value,
               std::optional<UtcTime> meant_for);

    std::unique_ptr<opcua::Client> client_;
    const PublishedArm arm_;
    client::SkillHandle stream_;
    const std::shared_ptr<Notes> notes_;  // shared with callbacks and answers
    const bool foreign_;
    const StreamTarget target_;
    std::unique_ptr<ArmPoll> poll_;
    bool sends_times_ = true;  // SourceTimestamps
    opcua::Subscription joints_;
    opcua::Subscription standstill_;
    opcua::Subscription safety_;
    opcua::Subscription missed_cycles_;
};

}  // namespace metier::client
