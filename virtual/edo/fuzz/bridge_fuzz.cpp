// The rosbridge protocol alone, without a robot that moves: each line of the input is a message of
// a client, as text or, behind a '!', a known request with what stands there in its place.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "robot.hpp"

using namespace metier;
using namespace metier::virtual_edo;

namespace {

constexpr std::array<std::string_view, 15> kRequests{
    R"({"op":"publish","topic":"/bridge_move","msg":{"move_command":77,"target":{%}}})",
    R"({"op":"publish","topic":"/algo_jnt_ctrl","msg":{"joints":[%]}})",
    R"({"op":"publish","topic":"/machine_state","msg":{%}})",
    R"({"op":"publish","topic":"/t","type":"std_msgs/Int8","msg":{"data":%}})",
    R"({"op":"subscribe","topic":"/machine_state","throttle_rate":%,"queue_length":2})",
    R"({"op":"subscribe","topic":"/machine_state","id":"x","fragment_size":%})",
    R"({"op":"unsubscribe","topic":"/machine_state","id":"%"})",
    R"({"op":"call_service","service":"/algo_control_switch_srv","id":"1","args":[%]})",
    R"({"op":"call_service","service":"/algo_control_switch_srv","args":{%}})",
    R"({"op":"advertise","topic":"/%","type":"std_msgs/Bool"})",
    R"({"op":"fragment","id":"f","data":"%","num":0,"total":1})",
    R"({"op":"set_level","level":"%"})",
    R"({"op":"subscribe","topic":"/machine_state","compression":"%"})",
    R"({"op":"call_service","service":"/rosapi/%","args":["/machine_state"]})",
    R"({"op":"call_service","service":"rosapi/topic_type","args":{"topic":"%"}})",
};

struct Release {
    explicit Release(const std::string& version)
        : software(Software::find(version).value()),
          types(software),
          model(motion::RobotModel::load(METIER_MODELS_DIR "/edo.toml").value()),
          robot({.software = software}, model),
          graph(robot.graph()) {
        graph.on_message = [](const std::string&, const Json& message) {
            if (!message.is_object()) {
                std::abort();
            }
        };
        for (auto& [name, service] : graph.services) {
            service.call = [](const Json&) -> Result<Json> { return Json::object(); };
        }
    }

    Software software;
    MessageTypes types;
    motion::RobotModel model;
    Robot robot;
    RosGraph graph;
};

std::string requestOf(std::string_view line) {
    if (!line.starts_with('!') || line.size() < 2) {
        return std::string(line);
    }
    std::string request(kRequests.at(static_cast<std::uint8_t>(line[1]) % kRequests.size()));
    return request.replace(request.find('%'), 1, line.substr(2));
}

}  // namespace

/// The first byte chooses the release and how fast the time goes.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const Release kOld("2.4.0");
    static const Release kNew("3.2.0");
    if (size == 0) {
        return 0;
    }
    const auto& release = data[0] % 2 == 0 ? kOld : kNew;
    Rosbridge bridge(release.types, release.graph);
    const auto check = [](const std::string& text) {
        if (!Json::accept(text)) {
            std::abort();
        }
    };
    const auto sender = bridge.addClient(check);
    const auto other = bridge.addClient(check);
    bridge.receive(other, R"({"op":"subscribe","topic":"/machine_state","throttle_rate":9})");
    std::string_view rest(reinterpret_cast<const char*>(data + 1), size - 1);
    SteadyTime now;
    while (!rest.empty()) {
        const auto line = rest.substr(0, rest.find('\n'));
        rest.remove_prefix(std::min(rest.size(), line.size() + 1));
        bridge.receive(sender, requestOf(line));
        bridge.setTime(now += std::chrono::milliseconds(data[0] / 2));
    }
    bridge.removeClient(sender);
    return 0;
}
