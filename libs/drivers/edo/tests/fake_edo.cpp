#include "fake_edo.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace metier::edo_driver::testing {
namespace {

using Json = nlohmann::json;

constexpr int kCommandTicks = 30;
constexpr double kTickSeconds = 0.01;

}  // namespace

bool FakeEdo::classic() const {
    return software.find("_2.") != std::string::npos || software.find("_3.0") != std::string::npos;
}

int FakeEdo::count(std::string_view part_of_text) const {
    return static_cast<int>(std::count_if(received.begin(), received.end(), [&](const auto& text) {
        return text.find(part_of_text) != std::string::npos;
    }));
}

void FakeEdo::receive(std::string_view text) {
    const auto json = Json::parse(text);
    const auto op = json.at("op").get<std::string>();
    const auto topic = json.value("topic", std::string());
    const bool set_point =
        op == "publish" && (topic == "/algo_jnt_ctrl" || topic == "/external_control");
    if (!set_point) {
        received.emplace_back(text);
    }
    if (op == "publish") {
        onPublish(topic, &json.at("msg"));
    } else if (op == "call_service" && !faults.mute_services) {
        onCall(json.at("id"), json.at("service"), json.at("args").value("mode", 0));
    }
}

void FakeEdo::onPublish(const std::string& topic, const void* message) {
    const auto& msg = *static_cast<const Json*>(message);
    if (topic == "/bridge_init" && state == 0 && !faults.drop_init) {
        if (msg.at("joints_mask") == (1 << joint_count) - 1) {
            state = 255;
            command_result_ = 6;
            command_ticks_ = kCommandTicks;
        }
    } else if (topic == "/bridge_jnt_reset" && state == 6 && !faults.drop_reset) {
        state = 255;
        opcode = 0;
        command_result_ = faults.brakes_stay_closed ? 6 : 1;
        command_ticks_ = kCommandTicks;
    } else if (topic == "/algo_jnt_ctrl" && classic()) {
        std::vector<double> positions;
        for (const auto& joint : msg.at("joints")) {
            positions.push_back(joint.at("position"));
        }
        if (msg.at("size") == joint_count) {
            onSetPoint(positions);
        }
    } else if (topic == "/external_control" && !classic()) {
        onSetPoint(msg.at("position").get<std::vector<double>>());
    } else if (topic == "/bridge_move" && msg.at("move_command") == 'C') {
        if (faults.drop_cancels) {
            return;
        }
        moving_ = false;
        publish("/machine_movement_ack", R"({"type":2,"data":60})");
    } else if (topic == "/bridge_move" && state == 2 && !faults.drop_moves) {
        if (faults.move_feedback < 0) {
            publish("/machine_movement_ack",
                    fmt::format(R"({{"type":{},"data":-103}})", faults.move_feedback));
            return;
        }
        publish("/machine_movement_ack", R"({"type":0,"data":0})");
        state = 3;
        moving_ = true;
        jaw_target_ = msg.at("target").at("joints_data").at(6);
    }
}

void FakeEdo::onCall(const std::string& id, const std::string& service, int mode) {
    if (service == "/machine_bridge_sw_version_srv") {
        send_(fmt::format(
            R"({{"op":"service_response","id":"{}","service":"{}","result":true,"values":)"
            R"({{"version":{{"nodes":[{{"id":0,"version":"USB"}},{{"id":255,"version":"{}"}}]}},)"
            R"("tool_id":1}}}})",
            id, service, software));
        return;
    }
    const int take = classic() ? 1 : 2;
    const int give = classic() ? 2 : 0;
    int result = 1;
    if (mode == take && !control_taken && !faults.refuse_control) {
        result = 0;
        control_taken = !faults.grant_without_doing;
    } else if (mode == give && control_taken) {
        result = 0;
        control_taken = faults.keep_control;
    }
    send_(fmt::format(R"({{"op":"service_response","id":"{}","service":"{}","result":true,)"
                      R"("values":{{"result":{}}}}})",
                      id, service, result));
}

void FakeEdo::onSetPoint(const std::vector<double>& positions) {
    ++set_points;
    set_points_while_not_taken += control_taken ? 0 : 1;
    if (!control_taken || faults.drop_set_points || state != 2) {
        return;
    }
    for (std::size_t i = 0; i < joint_count; ++i) {
        if (i < 6) {
            longest_step = std::max(longest_step, std::abs(positions[i] - joints[i]));
        }
        joints[i] = positions[i];
    }
    jaw_target_ = joints[6];
}

void FakeEdo::restart() {
    state = 0;
    opcode = 0;
    control_taken = false;
    moving_ = false;
    joints = {0, 10, 90, 0, 80, 0, 40};
}

void FakeEdo::brake(std::uint32_t bits) {
    state = 6;
    opcode = bits;
    moving_ = false;
}

void FakeEdo::finishCommand() {
    if (command_ticks_ > 0 && --command_ticks_ == 0) {
        state = command_result_;
        opcode = uncalibrated ? 8 : 0;
    } else if (state == 1 && !uncalibrated && command_ticks_ == 0) {
        state = 2;
    }
}

void FakeEdo::moveJaws() {
    if (!moving_) {
        state = state == 3 ? 2 : state;
        return;
    }
    const double step = jaw_speed * kTickSeconds;
    const double way = std::clamp(jaw_target_ - joints[6], -step, step);
    joints[6] += way;
    if (part >= 0.0 && joints[6] < part) {
        joints[6] = part;
    }
    const bool blocked = std::abs(way) < 1e-9 || (part >= 0.0 && joints[6] == part);
    const bool stopped = blocked && !faults.believes_in_jaws;
    if (stopped) {
        moving_ = false;
        publish("/machine_movement_ack", R"({"type":2,"data":1})");
    }
}

int FakeEdo::algorithmState() const {
    return control_taken ? (classic() ? switched_off_state : 10) : (moving_ ? 2 : 5);
}

void FakeEdo::tick() {
    ++ticks_;
    finishCommand();
    moveJaws();
    const bool switched_off = classic() && control_taken && !tells_switched_off;
    const bool told = !faults.mute_algorithm && state != 0 && !switched_off;
    if (told) {
        publish("/algorithm_state", fmt::format(R"({{"data":{}}})", algorithmState()));
    }
    if (ticks_ % 10 == 0 && !faults.mute_machine) {
        publish("/machine_state",
                fmt::format(R"({{"current_state":{},"opcode":{}}})", state, opcode));
    }
    if (!faults.mute_joints && state != 0) {
        publishJoints();
    }
}

void FakeEdo::publishJoints() {
    std::string list;
    for (std::size_t i = 0; i < joint_count; ++i) {
        list += fmt::format(
            R"({}{{"position":{},"velocity":{:.6f},"current":{:.3f},)"
            R"("commandFlag":0,"R_jnt":0.0}})",
            i > 0 ? "," : "", faults.null_positions ? "null" : fmt::format("{:.6f}", joints[i]),
            faults.restless ? 5.0 : (joints[i] - last_[i]) / kTickSeconds, currents[i]);
    }
    last_ = joints;
    publish("/usb_jnt_state",
            fmt::format(R"({{"joints_mask":{},"joints":[{}]}})", (1U << joint_count) - 1, list));
}

void FakeEdo::publish(std::string_view topic, const std::string& message) {
    send_(fmt::format(R"({{"topic":"{}","msg":{},"op":"publish"}})", topic, message));
}

}  // namespace metier::edo_driver::testing
