#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <utility>
#include <vector>

#include "metier/client/remote_arm.hpp"
#include "metier/device/arm.hpp"
#include "metier/device/reset_slot.hpp"
#include "metier/device/safety_publisher.hpp"
#include "metier/device/shared_value.hpp"
#include "remote_arm/stream_session.hpp"
#include "remote_arm/wake_up.hpp"

namespace metier::client {

/// The thread of a RemoteArm: keeps the connection, and is the cycle while something moves.
class RemoteArmWorker final : public RemoteArm {
public:
    RemoteArmWorker(RemoteArmOptions options, std::shared_ptr<WakeUp> wake_up,
                    std::unique_ptr<StreamSession> session);
    ~RemoteArmWorker() override;
    RemoteArmWorker(const RemoteArmWorker&) = delete;
    RemoteArmWorker& operator=(const RemoteArmWorker&) = delete;

    const opcua_skill::KinematicsData& kinematics() const noexcept override {
        return arm_.kinematics;
    }
    bool usesGivenModel() const noexcept override { return !arm_.nodes.has_value(); }
    const std::vector<Lack>& lacks() const noexcept override { return lacks_; }
    const device::ArmInfo& info() const noexcept override { return info_; }
    device::ArmState state() const noexcept override { return published_.read(); }
    device::Safety safety() const override { return safety_.safety(); }
    std::optional<Absence> absence() const override;
    void nameOwner(std::string application_uri) override;
    Result<void> attach(std::shared_ptr<device::SetPointSource> source) override;
    void stop() noexcept override;
    Result<void> resetFault() override;
    device::Registration onSafetyChange(SafetyCallback callback) override {
        return safety_.onChange(std::move(callback));
    }

private:
    enum class Stream {
        none,
        running,
        ending,  ///< without further set-points; the skill is Ready soon
    };
    void run(const std::stop_token& stop);
    void reconnect(const std::stop_token& stop);
    void noteAbsence(std::optional<Absence> absence);
    void observe();
    void observeStream(const Observed& seen);
    /// End of the stream that runs; nothing while it goes on.
    std::optional<skill::TransitionEvent> endOf(const Observed& seen) const;
    void noteEnd(const skill::TransitionEvent& end);
    void observeArm(const Observed& seen);
    void checkFollowing();
    /// \param at_target whether the measured arm is at its last set-point
    bool judgeStandstill(const Observed& seen, bool at_target) const;
    device::Safety judge(const Observed& seen) const;
    bool awaitsWords(const Observed& seen) const;
    void enter(device::Safety safety);
    void publish();
    void takeRequests();
    void serveSource();
    void beginReset();
    void answerReset();
    void endReset(Result<void> outcome);
    void stopNow();

    void startStream();
    skill::ParentExecution parent() const;
    void cycle();
    void nextSetPoint();
    void finishStream();
    void leaveStream();
    void haltStream();
    void enterEnding();
    void letGo(device::EndCause cause);
    SteadyTime nextWake() const;
    bool isBusy() const;
    UtcTime meantFor() const;

    const RemoteArmOptions options_;
    const std::shared_ptr<WakeUp> wake_up_;  // notified by the session's late answers, too
    std::unique_ptr<StreamSession> session_;
    const PublishedArm arm_;
    const std::vector<Lack> lacks_;
    const device::ArmInfo info_;
    device::SharedValue<device::ArmState> published_;
    device::SafetyPublisher safety_{device::Safety()};

    device::ResetSlot resets_;
    mutable std::mutex mutex_;
    std::string owner_;  // ApplicationUri of the server whose motions these are
    bool stop_asked_ = false;
    bool taken_ = false;  // a source is attached or about to be
    std::shared_ptr<device::SetPointSource> pending_;
    std::optional<Absence> absence_;

    // Used by the thread only.
    device::ArmState state_;
    SteadyTime sampled_;  // when its position was measured
    std::shared_ptr<device::SetPointSource> source_;
    std::optional<SteadyTime> reset_deadline_;  // deadline of a Reset under way
    Stream stream_ = Stream::none;
    bool leaves_running_ = false;  // the skill of the stream that runs is not Running any more
    // The source has no more set-points; it gets its end when the stream has ended.
    bool done_ = false;
    bool settled_ = false;        // the last source came to its end, where the arm stands
    bool at_own_target_ = false;  // the commanded position is a set-point that was sent
    bool halted_by_stop_ = false;
    SteadyTime ending_since_;
    SteadyTime stream_start_;
    UtcTime stream_start_utc_;
    std::uint64_t sent_ = 0;
    std::string fault_;  // a stop of the stream that only resetFault() ends
    bool fault_is_limit_ = false;
    std::jthread thread_;  // last: it uses everything above
};

}  // namespace metier::client
