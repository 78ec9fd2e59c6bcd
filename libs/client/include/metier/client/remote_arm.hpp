#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "metier/device/arm.hpp"
#include "metier/opcua/security.hpp"
#include "metier/opcua_skill/kinematics_data.hpp"

namespace metier::client {

/// Settings of an arm of another server.
struct RemoteArmOptions {
    /// Address of the server with the arm's PositionStreamSkill: "opc.tcp://host:port".
    std::string url;
    /// Pause between attempts to connect to a lost server.
    std::chrono::milliseconds retry_interval{500};
    /// Identity and user, as opcua::ClientOptions::security; none: an open connection.
    std::optional<opcua::Credentials> security{};
};

/// An arm of another OPC UA server. Its set-points are written to the position stream of that
/// server, one per cycle of the arm, each with the time for which it is meant:
///
///     auto arm = RemoteArm::connect({.url = "opc.tcp://127.0.0.1:4841"});
///     (*arm)->attach(source);  // as with any device::Arm
///
/// Each motion is a stream of its own. The motion's end is reported when the stream has ended, so
/// that the arm is free for other skills of its server. A server whose stream does not know
/// EndOfStream ends it by silence, half a second later. A motion also ends when its stream ends by
/// itself, when the connection is lost, and in every safety state but normal; the server's arm then
/// brakes by itself. A lost server is looked for until it is back. If it then publishes another arm
/// or other limits, the arm stays disconnected, since earlier plans may not fit it.
///
/// Threading: as device::Arm. One thread of its own is the cycle. It sends messages, so unlike that
/// of a driver it may allocate, and a late answer of the server delays the next message.
class RemoteArm : public device::Arm {
public:
    /// Connects and reads the arm's description; waits.
    /// Errors: connection_lost, timeout; not_found if the server has no PositionStreamSkill or
    ///         publishes no Kinematics for it.
    /// Threads: any but a server's; the result may be used on any.
    static Result<std::unique_ptr<RemoteArm>> connect(RemoteArmOptions options);
    /// Chain and limits, as the server published them at connect().
    virtual const opcua_skill::KinematicsData& kinematics() const noexcept = 0;

    /// Sets the ApplicationUri of the server on whose behalf motions are made; the position stream
    /// gets it with its start, if its server keeps records. Any thread.
    virtual void nameOwner(std::string application_uri) = 0;

    /// Reason why the arm cannot be used.
    struct Absence {
        /// Moment of the loss on this machine's monotonic clock.
        SteadyTime since;
        /// Whether its server is back, with another arm or other limits: connect() anew.
        bool replaced = false;
    };
    /// Absence of the arm; nothing while it can be used. Threads: any.
    virtual std::optional<Absence> absence() const = 0;
};

}  // namespace metier::client
