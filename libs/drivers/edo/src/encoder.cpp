#include "metier/edo_driver/encoder.hpp"

#include <algorithm>

#include "units.hpp"

namespace metier::edo_driver {
namespace {

constexpr int kMove = 'M';
constexpr int kCancel = 'C';
constexpr int kJoint = 'J';  // as type of a motion and as kind of a point

constexpr std::string_view kZeros = "[0.0,0.0,0.0,0.0,0.0,0.0,0.0]";
constexpr std::string_view kFrame = R"({"x":0.0,"y":0.0,"z":0.0,"a":0.0,"e":0.0,"r":0.0})";

std::string point(int kind, std::uint64_t mask, std::string_view values) {
    return fmt::format(
        R"({{"data_type":{},"cartesian_data":{{"x":0.0,"y":0.0,"z":0.0,"a":0.0,"e":0.0,"r":0.0,)"
        R"("config_flags":""}},"joints_mask":{},"joints_data":[{}]}})",
        kind, mask, values);
}

struct Motion {
    int command = 0;
    int type = 0;
    int override_percent = 0;
};

std::string motionText(const Motion& motion, const std::string& target) {
    return fmt::format(R"({{"op":"publish","topic":"/bridge_move","msg":{{"move_command":{},)"
                       R"("move_type":{},"ovr":{},"delay":0,"remote_tool":0,)"
                       R"("cartesian_linear_speed":0.0,"target":{},"via":{},"tool":{},)"
                       R"("frame":{}}}}})",
                       motion.command, motion.type, motion.override_percent, target,
                       point(0, 0, ""), kFrame, kFrame);
}

}  // namespace

std::string advertiseText(std::string_view topic, std::string_view type) {
    return fmt::format(R"({{"op":"advertise","topic":"{}","type":"{}"}})", topic, type);
}

std::string subscribeText(std::string_view topic, std::string_view type) {
    return fmt::format(R"({{"op":"subscribe","topic":"{}","type":"{}"}})", topic, type);
}

std::string softwareVersionCallText(std::string_view id) {
    return fmt::format(
        R"({{"op":"call_service","id":"{}","service":"/machine_bridge_sw_version_srv","args":{{}}}})",
        id);
}

std::string controlSwitchCallText(std::string_view id, int mode) {
    return fmt::format(R"({{"op":"call_service","id":"{}","service":"/algo_control_switch_srv",)"
                       R"("args":{{"mode":{}}}}})",
                       id, mode);
}

std::string initText(const JointLayout& layout) {
    return fmt::format(R"({{"op":"publish","topic":"/bridge_init","msg":{{"mode":0,)"
                       R"("joints_mask":{},"reduction_factor":0.0}}}})",
                       layout.mask());
}

std::string resetText(const JointLayout& layout, const ResetRequest& request) {
    return fmt::format(R"({{"op":"publish","topic":"/bridge_jnt_reset","msg":{{"joints_mask":{},)"
                       R"("disengage_steps":{},"disengage_offset":{:.4f}}}}})",
                       layout.mask(), request.steps, request.offset / kRadiansPerDegree);
}

std::string moveText(const JointLayout& layout, const JointMove& move) {
    std::string values;
    for (std::size_t joint = 0; joint < layout.count(); ++joint) {
        values += fmt::format("{}{:.5f}", joint > 0 ? "," : "",
                              move.target.position[joint] / unitOf(layout, joint));
    }
    return motionText({kMove, kJoint, move.override_percent}, point(kJoint, layout.mask(), values));
}

std::string cancelText() {
    return motionText({kCancel, 0, 0}, point(0, 0, ""));
}

template <typename... Args>
void SetPointText::append(fmt::format_string<Args...> format, const Args&... args) noexcept {
    const auto room = buffer_.size() - size_;
    const auto written = fmt::vformat_to_n(buffer_.data() + size_, room, fmt::string_view(format),
                                           fmt::make_format_args(args...));
    size_ += std::min(written.size, room);
}

std::string_view SetPointText::write(const Generation& generation, const JointLayout& layout,
                                     const JointSetPoint& set_point) noexcept {
    size_ = 0;
    append(R"({{"op":"publish","topic":"{}","msg":{{)", generation.setPointTopic());
    if (generation.kind == Generation::Kind::classic) {
        writeControlArray(layout, set_point);
    } else {
        writeJointValue(layout, set_point);
    }
    append("}}}}");
    return {buffer_.data(), size_};
}

void SetPointText::writeControlArray(const JointLayout& layout,
                                     const JointSetPoint& set_point) noexcept {
    append(R"("size":{},"joints":[)", layout.count());
    for (std::size_t joint = 0; joint < layout.count(); ++joint) {
        append(R"({}{{"position":{:.5f},"velocity":0.0,"current":0.0,"ff_velocity":0.0,)"
               R"("ff_current":0.0}})",
               joint > 0 ? "," : "", set_point.position[joint] / unitOf(layout, joint));
    }
    append("]");
}

void SetPointText::writeJointValue(const JointLayout& layout,
                                   const JointSetPoint& set_point) noexcept {
    append(R"("position":[)");
    for (std::size_t joint = 0; joint < kMaxJoints; ++joint) {
        const double value = joint < layout.count() ? set_point.position[joint] : 0.0;
        append("{}{:.5f}", joint > 0 ? "," : "", value / unitOf(layout, joint));
    }
    append(R"(],"ff_velocity":{},"ff_current":{})", kZeros, kZeros);
}

}  // namespace metier::edo_driver
