#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "input.hpp"
#include "robot.hpp"

using namespace metier;
using namespace metier::virtual_edo;
using fuzz::Input;

namespace {

/// Requests in which % stands for a number.
constexpr std::array<std::string_view, 15> kRequests{
    R"({"op":"publish","topic":"/bridge_init","msg":{"mode":0,"joints_mask":%}})",
    R"({"op":"publish","topic":"/bridge_jnt_reset","msg":{"joints_mask":127}})",
    R"({"op":"publish","topic":"/bridge_jnt_calib","msg":{"joints_mask":%}})",
    R"({"op":"publish","topic":"/bridge_move","msg":{"move_command":77,"move_type":74,"ovr":%,
        "target":{"data_type":74,"joints_mask":127,"joints_data":[%,-%,%]}}})",
    R"({"op":"publish","topic":"/bridge_move","msg":{"move_command":77,"move_type":76,"ovr":100,
        "delay":255,"target":{"data_type":80,"cartesian_data":{"x":%,"y":-%,"z":%,"e":%}}}})",
    R"({"op":"publish","topic":"/bridge_move","msg":{"move_command":77,"move_type":67,
        "target":{"data_type":80,"cartesian_data":{"x":%,"z":%}},
        "via":{"data_type":74,"joints_mask":63,"joints_data":[%,%]}}})",
    R"({"op":"publish","topic":"/bridge_move","msg":{"move_command":80}})",
    R"({"op":"publish","topic":"/bridge_move","msg":{"move_command":82}})",
    R"({"op":"publish","topic":"/bridge_move","msg":{"move_command":67}})",
    R"({"op":"publish","topic":"/bridge_jog","msg":{"move_command":74,"move_type":74,
        "target":{"data_type":74,"joints_mask":127,"joints_data":[1,-%]}}})",
    R"({"op":"publish","topic":"/bridge_jog","msg":{"move_command":74,"move_type":76,
        "target":{"data_type":80,"cartesian_data":{"x":%,"z":-%,"a":%}}}})",
    R"({"op":"call_service","service":"/algo_control_switch_srv","args":[%]})",
    R"({"op":"publish","topic":"/external_control","msg":{"position":[%,%,%,0,0,0,%]}})",
    R"({"op":"publish","topic":"/algo_jnt_ctrl","msg":{"joints":[{"position":%},{},{}]}})",
    R"({"op":"subscribe","topic":"/usb_jnt_state","throttle_rate":%,"fragment_size":%})",
};

std::string requestFrom(Input& input) {
    std::string request;
    for (const char character : kRequests[input.next() % kRequests.size()]) {
        if (character == '%') {
            request += std::to_string(input.next());
        } else {
            request += character;
        }
    }
    return request;
}

/// A robot that a client talks to.
class Session {
public:
    Session(const Software& software, bool ready, const motion::RobotModel& model)
        : types_(software),
          robot_({.software = software, .axes = kMostAxes, .ready = ready}, model),
          bridge_(types_, robot_.graph()),
          client_(bridge_.addClient([](const std::string& text) {
              if (!Json::accept(text)) {
                  __builtin_trap();
              }
          })) {
        robot_.connect([this](const std::string& topic,
                              const Json& message) { bridge_.publish(topic, message); },
                       [this](std::string_view topic) { return bridge_.hasSubscribers(topic); });
        take(R"({"op":"subscribe","topic":"/cartesian_pose"})", 0);
    }

    void take(const std::string& request, unsigned cycles) {
        bridge_.receive(client_, request);
        for (unsigned cycle = 0; cycle < cycles; ++cycle) {
            bridge_.setTime(now_ += kCycle);
            robot_.step({});
        }
    }

private:
    MessageTypes types_;
    Robot robot_;
    Rosbridge bridge_;
    Rosbridge::ClientId client_;
    SteadyTime now_{};
};

}  // namespace

/// The first byte chooses the release, the state at the start, and whether the rest is requests as
/// text, one a line, or choices among known requests with numbers.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const auto kModel = motion::RobotModel::load(METIER_MODELS_DIR "/edo.toml").value();
    Input input(data, size);
    const unsigned choice = input.next();
    Session session(Software::find((choice & 1U) != 0 ? "2.4.0" : "3.2.0").value(),
                    (choice & 2U) != 0, kModel);
    constexpr int kMostRequests = 5;  // a line may take a thousand inverse kinematics to plan
    for (int request_count = 0; request_count < kMostRequests && !input.isEmpty();
         ++request_count) {
        if ((choice & 4U) != 0) {
            session.take(input.line(), 1);
        } else {
            const auto request = requestFrom(input);
            session.take(request, input.next() % 64U);
        }
    }
    return 0;
}
