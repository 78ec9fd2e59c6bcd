#pragma once

#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "metier/base/error.hpp"
#include "metier/composition/force_source.hpp"
#include "metier/opcua/security.hpp"
#include "metier/skill/executor.hpp"

namespace metier::client {

/// Settings of a RemoteForce.
struct RemoteForceOptions {
    /// Name of the server that measures, for messages.
    std::string server_name;
    /// Its address: "opc.tcp://host:port".
    std::string url;
    /// Force, a Variable with three Doubles or Floats or a 3DVector [N], as "ns=2;s=Force" or
    /// "nsu=urn:lab;s=Force"; empty: FlangeForce, and FlangeTorque, of the server's first arm with
    /// Kinematics.
    std::string force;
    /// Torque, likewise [N m]; empty: it is not measured.
    std::string torque;
    /// Address of the server whose arm carries the sensor; empty: the axes of the force are those
    /// of the base frame.
    std::string arm_url;
    /// Frame of the sensor in the base frame, a Variable with a 3DFrame at `arm_url`; empty:
    /// ActualPose, that of the flange.
    std::string pose;
    /// Name of this client in the sessions of both servers.
    std::string application_name = "metier composition";
    /// Identity and user; none: open connections.
    std::optional<opcua::Credentials> security{};
};

/// A force that a server publishes, followed at 5 ms, or as fast as the server allows. A Bad value,
/// a value of another type or a lost connection is a lost force; a server that is silent for 2 s is
/// lost. It is found and subscribed to again by itself.
///
/// Threading: connect() and the destructor wait, on any thread but the executor's; all else on the
/// executor's. A thread of its own connects again.
class RemoteForce final : public composition::ForceSource {
public:
    /// Connects, finds the Variables and subscribes; the first force comes later.
    /// Errors: connection_lost, timeout, access_denied, with the address; not_found,
    ///         invalid_argument (no NodeId, a unit that is not N), with the name.
    static Result<std::shared_ptr<RemoteForce>> connect(RemoteForceOptions options,
                                                        std::shared_ptr<skill::Executor> executor);
    /// Nothing may be left to run on the executor's thread.
    ~RemoteForce() override;
    RemoteForce(const RemoteForce&) = delete;
    RemoteForce& operator=(const RemoteForce&) = delete;

    const std::string& name() const override;
    Result<composition::MeasuredForce> newest() const override;
    void add(composition::ForceListener& listener) override;
    void remove(composition::ForceListener& listener) override;

private:
    class State;
    class Watch;
    struct Connections;

    RemoteForce(RemoteForceOptions options, std::shared_ptr<State> state,
                std::shared_ptr<Watch> watch, std::unique_ptr<Connections> connections);
    void run(const std::stop_token& stop);

    const RemoteForceOptions options_;
    std::shared_ptr<State> state_;              // shared with what was posted to the executor
    std::shared_ptr<Watch> watch_;              // shared with the clients' callbacks
    std::unique_ptr<Connections> connections_;  // the thread's
    std::jthread thread_;
};

}  // namespace metier::client
