#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robot.hpp"

namespace metier::virtual_edo {

inline const motion::RobotModel& edoModel() {
    static const auto kModel =
        motion::RobotModel::load(std::string(METIER_MODELS_DIR) + "/edo.toml").value();
    return kModel;
}

/// One client of a bridge, which keeps what it got.
class ScriptedClient {
public:
    explicit ScriptedClient(Rosbridge& bridge)
        : bridge_(bridge), id_(bridge.addClient([this](const std::string& text) {
              received.push_back(Json::parse(text));
          })) {}
    ScriptedClient(const ScriptedClient&) = delete;
    ScriptedClient& operator=(const ScriptedClient&) = delete;
    ~ScriptedClient() { bridge_.removeClient(id_); }

    void say(const Json& message) { bridge_.receive(id_, message.dump()); }
    void sayText(const std::string& text) { bridge_.receive(id_, text); }
    void subscribe(const std::string& topic) { say({{"op", "subscribe"}, {"topic", topic}}); }
    void publish(const std::string& topic, const Json& message) {
        say({{"op", "publish"}, {"topic", topic}, {"msg", message}});
    }
    /// The answer's values; the whole response if it failed.
    Json call(const std::string& service, const Json& arguments = Json::object()) {
        say({{"op", "call_service"}, {"service", service}, {"args", arguments}, {"id", "c"}});
        const auto response = std::find_if(
            received.rbegin(), received.rend(),
            [](const auto& message) { return message.at("op") == "service_response"; });
        if (response == received.rend()) {
            return nullptr;
        }
        return (*response)["result"].get<bool>() ? (*response)["values"] : *response;
    }
    std::vector<Json> messages(const std::string& topic) const {
        std::vector<Json> found;
        for (const auto& message : received) {
            if (message["op"] == "publish" && message["topic"] == topic) {
                found.push_back(message["msg"]);
            }
        }
        return found;
    }
    Json last(const std::string& topic) const {
        const auto found = messages(topic);
        return found.empty() ? Json(nullptr) : found.back();
    }
    /// Texts of the error statuses.
    std::vector<std::string> errors() const {
        std::vector<std::string> found;
        for (const auto& message : received) {
            if (message["op"] == "status") {
                found.push_back(message["msg"].get<std::string>());
            }
        }
        return found;
    }

    std::vector<Json> received;

private:
    Rosbridge& bridge_;
    Rosbridge::ClientId id_;
};

struct RigOptions {
    std::string software = "3.2.0";
    bool ready = true;
    std::size_t axes = kMostAxes;
    bool kinematics_services = false;
};

/// A robot behind its bridge, whose time is moved by hand.
class Rig {
public:
    explicit Rig(const RigOptions& options = {})
        : software(Software::find(options.software).value()),
          types(software),
          robot({.software = software,
                 .axes = options.axes,
                 .ready = options.ready,
                 .kinematics_services = options.kinematics_services},
                edoModel()),
          bridge(types, robot.graph()),
          client(bridge) {
        robot.connect([this](const std::string& topic,
                             const Json& message) { bridge.publish(topic, message); },
                      [this](std::string_view topic) { return bridge.hasSubscribers(topic); });
        for (const char* topic : {"/machine_state", "/machine_movement_ack", "/usb_jnt_state",
                                  "/algorithm_state", "/cartesian_pose"}) {
            client.subscribe(topic);
        }
    }

    void run(int cycles) {
        for (int i = 0; i < cycles; ++i) {
            now += kCycle;
            bridge.setTime(now);
            report = robot.step(effect);
            noteState();
        }
    }
    void runSeconds(double seconds) { run(static_cast<int>(std::lround(seconds * 100.0))); }
    /// Runs until the machine reports that state. \return after how long [s]; nothing after 20 s
    std::optional<double> runUntilState(int wanted) {
        for (int cycles = 0; cycles < 2000; ++cycles) {
            if (state() == wanted) {
                return cycles / 100.0;
            }
            run(1);
        }
        return std::nullopt;
    }
    bool runUntil(const std::function<bool()>& condition) {
        for (int cycles = 0; cycles < 6000; ++cycles) {
            if (condition()) {
                return true;
            }
            run(1);
        }
        return false;
    }

    int state() const { return robot.state()["machine_state"].get<int>(); }
    unsigned opcode() const { return robot.state()["opcode"].get<unsigned>(); }
    /// [deg], [mm]
    double joint(std::size_t axis) const {
        return client.last("/usb_jnt_state")["joints"][axis]["position"].get<double>();
    }
    /// Type and data of every feedback so far; forgets them.
    std::vector<std::pair<int, int>> feedback() {
        std::vector<std::pair<int, int>> found;
        for (const auto& message : client.messages("/machine_movement_ack")) {
            found.emplace_back(message["type"].get<int>(), message["data"].get<int>());
        }
        std::erase_if(client.received, [](const Json& message) {
            return message.value("topic", "") == "/machine_movement_ack";
        });
        return found;
    }
    Result<void> inject(const std::string& name, const std::string& value = "") {
        return performOneOf(robot.injections(), {.name = name, .value = value});
    }
    void moveJoints(std::vector<double> joints, int delay = 0, int override_percent = 100) {
        client.publish("/bridge_move", {{"move_command", 77},
                                        {"move_type", 74},
                                        {"ovr", override_percent},
                                        {"delay", delay},
                                        {"target",
                                         {{"data_type", 74},
                                          {"joints_mask", (1U << joints.size()) - 1},
                                          {"joints_data", joints}}}});
    }
    void command(int code) { client.publish("/bridge_move", {{"move_command", code}}); }

    Software software;
    MessageTypes types;
    Robot robot;
    Rosbridge bridge;
    ScriptedClient client;
    SteadyTime now{};
    virtual_controller::WorldEffect effect;
    virtual_controller::WorldReport report;
    std::vector<int> states;  ///< states of the machine, each change

private:
    void noteState() {
        if (states.empty() || states.back() != state()) {
            states.push_back(state());
        }
    }
};

}  // namespace metier::virtual_edo
