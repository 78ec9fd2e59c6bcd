#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "metier/device/arm.hpp"
#include "metier/opcua/security.hpp"
#include "metier/opcua_skill/kinematics_data.hpp"

namespace metier::client {

struct RemoteArmOptions {
    /// Address of the server that has the arm's PositionStreamSkill.
    std::string url;
    /// Pause between tries to reach a server that was lost.
    std::chrono::milliseconds retry_interval{500};
    std::optional<opcua::Credentials> security{};  ///< as opcua::ClientOptions::security
};

/// An arm behind another OPC UA server: its set-points go out as the position stream of that
/// server, each with the time it is meant for, one per cycle of the arm.
///
/// Each motion is a stream of its own, and is told its end when the stream has ended: then the arm
/// is free for other skills of its server. A server whose stream does not know EndOfStream ends it
/// by silence, half a second later. Its loss, a lost connection, and every
/// safety state but normal end the motion; the server's arm brakes by itself then. A lost server
/// is sought again until it is back. Should it tell of another arm then, or of other limits, the
/// arm stays disconnected: whoever has planned for the former must begin anew.
///
/// Threading: as device::Arm. One thread of its own is the cycle; it sends messages, so unlike
/// that of a driver it may allocate, and a request that its server answers late delays the next.
class RemoteArm final : public device::Arm {
public:
    /// Connects and reads what the arm is like.
    /// Errors: connection_lost, timeout; not_found if the server has no PositionStreamSkill or
    ///         publishes no Kinematics for it.
    static Result<std::unique_ptr<RemoteArm>> connect(RemoteArmOptions options);
    ~RemoteArm() override;
    RemoteArm(const RemoteArm&) = delete;
    RemoteArm& operator=(const RemoteArm&) = delete;

    /// Chain and limits, as the server published them at connect().
    const opcua_skill::KinematicsData& kinematics() const noexcept;

    /// Says whose motions it makes: the ApplicationUri of a server whose executions they are, which
    /// the position stream is told, if its server keeps records. Any thread.
    void nameOwner(std::string application_uri);

    /// Why the arm cannot be used, though its server may be.
    struct Absence {
        SteadyTime since;
        bool replaced = false;  ///< its server is there again, with another arm or other limits
    };
    /// Nothing while the arm is there. Threads: any.
    std::optional<Absence> absence() const;

    const device::ArmInfo& info() const noexcept override;
    device::ArmState state() const noexcept override;
    device::Safety safety() const override;
    Result<void> attach(std::shared_ptr<device::SetPointSource> source) override;
    void stop() noexcept override;
    Result<void> resetFault() override;
    device::Registration onSafetyChange(SafetyCallback callback) override;

private:
    class Worker;
    explicit RemoteArm(std::unique_ptr<Worker> worker);
    std::unique_ptr<Worker> worker_;
};

}  // namespace metier::client
