#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "metier/base/clock.hpp"
#include "metier/client/kinematics_reader.hpp"
#include "metier/client/remote_arm.hpp"
#include "metier/client/skill_handle.hpp"
#include "metier/device/arm.hpp"
#include "metier/opcua/client.hpp"
#include "metier/opcua_skill/kinematics_data.hpp"
#include "remote_arm/wake_up.hpp"

namespace metier::client {

/// One connection to the server of an arm, for as long as it holds.
///
/// Threading: one owner; what comes in is noted by the client's thread, which wakes the owner.
class StreamSession {
public:
    /// Values that the server published last.
    struct Observed {
        device::JointArray position;     ///< measured [rad]; empty before the first
        SteadyTime sampled{};            ///< when `position` came
        SteadyTime moved{};              ///< when the measured arm was last seen in motion
        std::optional<bool> standstill;  ///< as the server judges; none if it does not publish it
        device::SafetyState safety = device::SafetyState::normal;
        SteadyTime safety_since{};  ///< when `safety` became what it is
        std::string words;          ///< the robot's own, of why the stream skill is Halted
        std::uint64_t missed_cycles = 0;
        /// End of the stream that was started last
        std::optional<skill::TransitionEvent> stream_end;
        std::string refused;  ///< why a set-point was refused, since the stream was started
        std::string broken;   ///< why nothing more will come
    };

    /// \param wake_up notified after each change of what is observed; shared with late answers
    static Result<std::unique_ptr<StreamSession>> open(const RemoteArmOptions& remote,
                                                       std::shared_ptr<WakeUp> wake_up);

    const opcua_skill::KinematicsData& kinematics() const noexcept { return kinematics_; }
    const std::string& deviceName() const noexcept { return nodes_.device_name; }
    Observed observed() const;

    /// Starts the stream skill; a stream that was halted is not reset here.
    /// \param parent the execution that it is started for, if that is known
    Result<void> startStream(const skill::ParentExecution& parent);
    /// Sends a set-point; nothing waits. Its failure shows in observed().
    void send(const device::JointArray& set_point, UtcTime meant_for);
    /// Writes EndOfStream, without waiting. False if the server ends a stream only by silence.
    bool endStream();
    client::SkillHandle& stream() noexcept { return stream_; }

private:
    StreamSession(std::unique_ptr<opcua::Client> client, client::KinematicsNodes nodes,
                  opcua_skill::KinematicsData kinematics, client::SkillHandle stream,
                  std::shared_ptr<WakeUp> wake_up);
    // Shared with callbacks and answers that are still under way when the session ends.
    struct Notes {
        std::mutex mutex;
        Observed observed;
        std::shared_ptr<WakeUp> wake_up;

        template <typename Change>
        void note(Change change) {
            {
                const std::lock_guard lock(mutex);
                change(observed);
            }
            wake_up->notify();
        }
        void notePosition(const device::JointArray& position);
        void noteBroken(const std::string& why);
        void noteAnswer(const opcua::Answer<>& answer);
        void noteTransition(const skill::TransitionEvent& event);
        void noteSafety(device::SafetyState safety);
    };

    Result<void> subscribe();
    void subscribeTransitions();
    Result<void> subscribeState();
    Result<void> subscribeStandstill();
    void write(std::string_view parameter, const skill::Value& value, UtcTime meant_for);

    std::unique_ptr<opcua::Client> client_;
    client::KinematicsNodes nodes_;
    opcua_skill::KinematicsData kinematics_;
    client::SkillHandle stream_;
    std::shared_ptr<Notes> notes_ = std::make_shared<Notes>();
    const bool takes_end_;
    opcua::Subscription joints_;
    opcua::Subscription standstill_;
    opcua::Subscription safety_;
    opcua::Subscription missed_cycles_;
};

}  // namespace metier::client
