#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "metier/virtual_edo/robot.hpp"

using namespace metier;
using namespace metier::virtual_edo;

namespace {

motion::RobotModel makeModel() {
    motion::ChainDescription chain;
    chain.cycle_time = 0.01;
    chain.home = motion::JointVector(kArmAxes);
    chain.cartesian_limits = {.velocity = 0.25,
                              .acceleration = 0.12,
                              .jerk = 2.4,
                              .angular_velocity = 0.5,
                              .angular_acceleration = 0.3,
                              .angular_jerk = 6.0};
    const double heights[kArmAxes] = {0.0, 0.337, 0.2105, 0.268, 0.0, 0.0};
    for (std::size_t axis = 0; axis < kArmAxes; ++axis) {
        motion::JointDescription joint;
        joint.name = "J" + std::to_string(axis + 1);
        joint.parent_from_joint.translation.z() = heights[axis];
        const bool is_about_y = axis == 1 || axis == 2 || axis == 4;
        joint.axis = is_about_y ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
        joint.limits = {
            .lower = -1.7, .upper = 1.7, .velocity = 0.4, .acceleration = 0.8, .jerk = 8};
        chain.joints.push_back(joint);
    }
    chain.last_from_flange.translation.z() = 0.1745;
    return motion::RobotModel::fromChain(std::move(chain)).value();
}

}  // namespace

/// The input is requests of a client, one a line, with some cycles after each. The first byte
/// chooses the release and the state at the start.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const motion::RobotModel kModel = makeModel();
    if (size == 0) {
        return 0;
    }
    const auto software = Software::find((data[0] & 1U) != 0 ? "2.4.0" : "3.2.0").value();
    const MessageTypes types(software);
    Robot robot({.software = software, .axes = kMostAxes, .ready = (data[0] & 2U) != 0}, kModel);
    Rosbridge bridge(types, robot.graph());
    robot.connect(
        [&](const std::string& topic, const Json& message) { bridge.publish(topic, message); },
        [&](std::string_view topic) { return bridge.hasSubscribers(topic); });
    const auto client = bridge.addClient([](const std::string& text) {
        if (Json::parse(text, nullptr, false).is_discarded()) {
            std::abort();
        }
    });
    bridge.receive(client, R"({"op":"subscribe","topic":"/usb_jnt_state"})");
    std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
    SteadyTime now{};
    while (!text.empty()) {
        const auto end = text.find('\n');
        bridge.receive(client, text.substr(0, end));
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
        for (int cycle = 0; cycle < 3; ++cycle) {
            bridge.setTime(now += kCycle);
            robot.step({});
        }
    }
    return 0;
}
