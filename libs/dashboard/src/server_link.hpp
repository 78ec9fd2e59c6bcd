#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "board.hpp"
#include "metier/client/async_skill.hpp"
#include "metier/client/kinematics_reader.hpp"
#include "metier/client/skill_finder.hpp"
#include "metier/dashboard/cell.hpp"
#include "metier/opcua/client.hpp"

namespace metier::motion {
class RobotModel;
}

namespace metier::dashboard {

/// Facts of the cell that a link to one server needs.
struct LinkContext {
    CellServer server;
    /// Name of the server at an address; empty: none of the cell. Any thread.
    std::function<std::string(const std::string& url)> server_at;
    const std::vector<motion::RobotModel>& models;
    Board& board;
};

/// One skill of a server that is connected.
struct LinkedSkill {
    std::string key;
    client::SkillAddress address;
    std::string control;  ///< key of its controller's control
    opcua::NodeId halt;   ///< its Method; null: it has none
    std::unique_ptr<client::AsyncSkill> skill;
};

/// A controller of a server, of whose skills a tab may take control. Skills outside of any
/// controller have one without a name and a node.
struct LinkedController {
    std::string key;
    std::string name;
    opcua::NodeId node;
    bool leases;  ///< whether the server gives control of it; else only this page knows who has it
};

/// A connection to one server, with all that the server publishes, and the subscriptions that keep
/// the board up to date. Valid for one run of the server.
///
/// Threading: made by one thread; then any, but showLive(), which is of that thread.
class ServerLink {
public:
    /// Connects and reads; from then on reports every skill's state to the board. Waits, at most
    /// seconds for each request.
    /// \param on_lost called once, on the client's thread
    /// Errors: those of the server.
    static opcua::Answer<std::shared_ptr<ServerLink>> open(
        const LinkContext& context, opcua::ClientOptions options,
        std::function<void(const opcua::Failure&)> on_lost);

    /// Content of the server, for the board.
    const ServerShown& offer() const noexcept { return offer_; }
    opcua::Client& client() noexcept { return *client_; }
    const std::vector<LinkedSkill>& skills() const noexcept { return skills_; }
    const std::vector<LinkedController>& controllers() const noexcept { return controllers_; }
    /// nullptr: none of that key.
    const LinkedSkill* find(const std::string& key) const;

    /// Subscribes to what changes all the time, or no longer. Waits.
    void showLive(bool shown);

private:
    friend class Survey;
    explicit ServerLink(std::unique_ptr<opcua::Client> client) : client_(std::move(client)) {}

    /// An arm of its own.
    struct Arm {
        std::string key;
        client::KinematicsNodes nodes;
    };
    void showArm(const Arm& arm);
    void showCycles(const Arm& arm);
    /// \param object that a gripper's skills belong to, maybe
    void showGripper(const opcua::NodeId& object, std::uint16_t metier);
    void showController(const LinkedController& controller);
    void showSkill(const LinkedSkill& skill);
    /// A node below an object; null if there is none.
    opcua::NodeId below(const opcua::NodeId& object, std::vector<opcua::QualifiedName> path);
    /// \param callback called with values of that type only, and the time at which they were true
    template <typename T>
    void subscribe(const opcua::NodeId& node, std::chrono::milliseconds interval,
                   std::function<void(const T&, UtcTime)> callback);
    template <typename T>
    void subscribeLive(const opcua::NodeId& node, std::chrono::milliseconds interval,
                       std::function<void(LiveValues&, const T&, UtcTime)> change);

    std::unique_ptr<opcua::Client> client_;  // first: all below use it
    Board* board_ = nullptr;
    std::string server_;
    ServerShown offer_;
    std::vector<LinkedSkill> skills_;
    std::vector<LinkedController> controllers_;
    std::vector<Arm> arms_;
    opcua::Subscription alarms_;
    std::vector<opcua::Subscription> live_;
};

}  // namespace metier::dashboard
