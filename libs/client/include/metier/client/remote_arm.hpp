#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "metier/base/quantities.hpp"
#include "metier/client/lack.hpp"
#include "metier/device/arm.hpp"
#include "metier/opcua/security.hpp"
#include "metier/opcua_skill/kinematics_data.hpp"

namespace metier::client {

/// Model of an arm whose server does not publish its Kinematics.
struct GivenArm {
    /// Chain, limits and period of the set-points.
    opcua_skill::KinematicsData kinematics;
    /// Names of the joints, axis 1 first.
    std::vector<std::string> joint_names;
    /// Names of the joints in the order of the server's arrays. Empty: the server's axes have the
    /// names of the joints, in that order, or names that end with the numbers 1 to n.
    std::vector<std::string> array_order{};
    /// Computes base_from_flange [m, rad] at joint positions [rad]. Called on the arm's thread, for
    /// a stream that takes poses instead of joint positions; none: such a stream is refused.
    std::function<Frame(const device::JointArray&)> pose_at{};
    /// BrowseName of the arm's motion device; empty: the stream is part of it, or it is the only
    /// one.
    std::string device{};
};

/// Settings of an arm of another server.
struct RemoteArmOptions {
    /// Address of the server with the arm's PositionStreamSkill: "opc.tcp://host:port".
    std::string url;
    /// Pause between attempts to connect to a lost server.
    std::chrono::milliseconds retry_interval{500};
    /// Identity and user, as opcua::ClientOptions::security; none: an open connection.
    std::optional<opcua::Credentials> security{};
    /// Model of the arm; used if the server publishes no Kinematics.
    std::optional<GivenArm> given{};
    /// Controller of the stream, for a server with several arms; empty: the server has one stream.
    std::string controller{};
};

/// An arm of another OPC UA server. Its set-points are written to the position stream of that
/// server, one per cycle of the arm, each with the time for which it is meant:
///
///     auto arm = RemoteArm::connect({.url = "opc.tcp://127.0.0.1:4841"});
///     (*arm)->attach(source);  // as with any device::Arm
///
/// Each motion is a stream of its own. The motion's end is reported when the stream has ended, so
/// that the arm is free for other skills of its server. A stream that does not know EndOfStream is
/// halted and reset once the arm stands. A motion also ends when its stream ends by itself, when
/// the connection is lost, and in every safety state but normal; the server's arm then brakes by
/// itself. A lost server is looked for until it is back. If it then publishes another arm or other
/// limits, the arm stays disconnected, since earlier plans may not fit it.
///
/// The stream skill of a server of another maker needs Start, Halt, Reset and TargetJointPosition
/// (or TargetPosition), and a motion device of OPC 40010-1 whose axes have ActualPosition.
/// Position, stops and the skill's state are read there once per cycle.
///
/// Threading: as device::Arm. One thread of its own is the cycle. It sends messages, so unlike that
/// of a driver it may allocate, and a late answer of the server delays the next message.
class RemoteArm : public device::Arm {
public:
    /// Connects and reads the arm's description; waits.
    /// Errors: connection_lost, timeout; not_found if the server has no PositionStreamSkill or
    ///         publishes no Kinematics for it and no model is given; invalid_argument if the axes
    ///         of a given model are not those of the server, or if it has several streams, or
    ///         motion devices, and nothing says which.
    /// Threads: any but a server's; the result may be used on any.
    static Result<std::unique_ptr<RemoteArm>> connect(RemoteArmOptions options);
    /// Chain and limits, as the server published them at connect(), or as they were given.
    virtual const opcua_skill::KinematicsData& kinematics() const noexcept = 0;
    /// Whether the kinematics are the given ones.
    virtual bool usesGivenModel() const noexcept = 0;
    /// Lists what its motions cannot have, since its server is of another maker. Threads: any.
    virtual const std::vector<Lack>& lacks() const noexcept = 0;

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
