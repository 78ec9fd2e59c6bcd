#include "scripted_cabinet.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "metier/motion/pose.hpp"

namespace metier::iiwa_driver {

using motion::JointVector;

namespace {

// Longest time by which the arm moves on between two commands [s]: where the computer was late,
// the arm is no further than a cycle or two.
constexpr double kLongestStep = 0.02;

std::uint64_t bitsOf(const std::byte* from, std::size_t size) {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < size; ++i) {
        bits = bits * 256 + static_cast<std::uint64_t>(from[i]);
    }
    return bits;
}

double numberAt(const std::byte* from, bool double_precision) {
    if (double_precision) {
        return std::bit_cast<double>(bitsOf(from, 8));
    }
    return std::bit_cast<float>(static_cast<std::uint32_t>(bitsOf(from, 4)));
}

void append(std::vector<std::byte>& bytes, double value, bool double_precision) {
    const std::uint64_t bits = double_precision
                                   ? std::bit_cast<std::uint64_t>(value)
                                   : std::bit_cast<std::uint32_t>(static_cast<float>(value));
    for (int shift = double_precision ? 56 : 24; shift >= 0; shift -= 8) {
        bytes.push_back(static_cast<std::byte>(bits >> shift));
    }
}

}  // namespace

ScriptedCabinet::ScriptedCabinet(std::uint16_t port, const Options& options)
    : options_(options),
      link_(link::TcpLink::connect("127.0.0.1", port, Clock::now() + std::chrono::seconds(5))
                .value()),
      behaviour_(options.behaviour),
      position_(JointVector::from(kHome).value()),
      target_(position_),
      velocity_(7) {
    thresholds_.fill(std::numeric_limits<double>::quiet_NaN());
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

ScriptedCabinet::ScriptedCabinet(std::uint16_t port) : ScriptedCabinet(port, Options{}) {}

ScriptedCabinet::~ScriptedCabinet() {
    thread_.request_stop();
    link_.shutdown();
}

void ScriptedCabinet::die() {
    link_.shutdown();
}

void ScriptedCabinet::change(const std::function<void(Behaviour&)>& how) {
    const std::lock_guard lock(mutex_);
    how(behaviour_);
}

std::vector<ScriptedCabinet::Numbers> ScriptedCabinet::commands() const {
    const std::lock_guard lock(mutex_);
    return commands_;
}

std::vector<int> ScriptedCabinet::codes() const {
    std::vector<int> codes;
    for (const auto& command : commands()) {
        codes.push_back(static_cast<int>(command[0]));
    }
    return codes;
}

JointVector ScriptedCabinet::position() const {
    const std::lock_guard lock(mutex_);
    return position_;
}

bool ScriptedCabinet::moving() const {
    const std::lock_guard lock(mutex_);
    return active_;
}

std::string ScriptedCabinet::ended() const {
    const std::lock_guard lock(mutex_);
    return ended_;
}

void ScriptedCabinet::end(std::string why) {
    const std::lock_guard lock(mutex_);
    ended_ = std::move(why);
    active_ = false;
    link_.shutdown();
}

void ScriptedCabinet::run(const std::stop_token& stop) {
    while (!stop.stop_requested() && serveOne()) {
    }
}

bool ScriptedCabinet::serveOne() {
    const std::size_t width = options_.double_precision ? 8 : 4;
    std::vector<std::byte> bytes(1000);
    const auto count = link_.receive(bytes, Clock::now() + std::chrono::seconds(20));
    if (!count || *count != 8 * width) {
        end(count ? "read " + std::to_string(*count) + " bytes" : count.error().message);
        return false;
    }
    Numbers command{};
    for (std::size_t i = 0; i < command.size(); ++i) {
        command[i] = numberAt(bytes.data() + i * width, options_.double_precision);
    }
    std::vector<std::byte> answer;
    {
        const std::lock_guard lock(mutex_);
        if (command[0] != 0.0) {
            commands_.push_back(command);
        }
        advance();
        if (static_cast<int>(command[0]) == behaviour_.dies_at) {
            ended_ = "died";
            active_ = false;
            link_.shutdown();
            return false;
        }
        execute(command);
        answer = state(executed_);
        if (behaviour_.tamper) {
            behaviour_.tamper(answer);
        }
    }
    std::this_thread::sleep_for(options_.delay);
    if (!link_.send(answer, Clock::now() + std::chrono::seconds(5))) {
        end("cannot send");
        return false;
    }
    return true;
}

void ScriptedCabinet::execute(const Numbers& command) {
    const int code = static_cast<int>(command[0]);
    executed_ = code != 0 && !behaviour_.refused.contains(code);
    if (!executed_) {
        return;
    }
    if (code == 101 || code == 211 || code == 400 || (code >= 301 && code <= 305)) {
        active_ = false;
        velocity_ = JointVector(7);
    }
    switch (code) {
        case 102:
        case 103:
            executed_ = executeMove(command);
            return;
        case 211:
            std::copy_n(command.begin() + 1, 3, thresholds_.begin());
            return;
        case 302:
            interface_ = static_cast<int>(command[1]);
            return;
        case 303:
            motion_type_ = static_cast<int>(command[1]);
            return;
        default:
            return;
    }
}

bool ScriptedCabinet::executeMove(const Numbers& command) {
    if (!behaviour_.ready) {
        return false;
    }
    if (behaviour_.error_of_next_move != 0) {
        last_error_ = std::exchange(behaviour_.error_of_next_move, 0);
    }
    if (behaviour_.ignores_moves) {
        return true;
    }
    JointVector target = position_;
    if (command[0] == 102.0) {
        for (std::size_t axis = 0; axis < 7; ++axis) {
            const auto& limits = model_.limits(axis);
            const double value = command[axis + 1];
            if (value >= limits.lower && value <= limits.upper) {
                target[axis] = value;
            }
        }
    } else {
        const motion::Pose flange{
            Eigen::Vector3d(command[1], command[2], command[3]) / 1000.0 - Eigen::Vector3d::Zero(),
            Eigen::AngleAxisd(command[4], Eigen::Vector3d::UnitZ()) *
                Eigen::AngleAxisd(command[5], Eigen::Vector3d::UnitY()) *
                Eigen::AngleAxisd(command[6], Eigen::Vector3d::UnitX())};
        const motion::Pose tool{{0, 0, behaviour_.tool_length}, {1, 0, 0, 0}};
        const auto found =
            model_.kinematics().inverse(flange * tool.inverse(), {position_, {}, {}});
        if (!found) {
            last_error_ = -14;
            return true;
        }
        target = *found;
    }
    startTo(target);
    return true;
}

void ScriptedCabinet::startTo(const JointVector& target) {
    target_ = target;
    if (!active_) {
        way_ = 0.0;
        condition_met_ = false;
    }
    active_ = true;
}

void ScriptedCabinet::advance() {
    const auto now = Clock::now();
    const double step =
        std::min(kLongestStep, std::chrono::duration<double>(now - advanced_).count());
    advanced_ = now;
    velocity_ = JointVector(7);
    if (!active_ || behaviour_.does_not_start || !behaviour_.ready) {
        return;
    }
    const double rest = motion::maxDifference(position_, target_);
    const double share = rest > 0.0 ? std::min(1.0, behaviour_.speed * step / rest) : 1.0;
    for (std::size_t axis = 0; axis < 7; ++axis) {
        const double way = share * (target_[axis] - position_[axis]);
        position_[axis] += way;
        velocity_[axis] = step > 0.0 ? way / step : 0.0;
    }
    way_ += share * rest;
    const bool watched = std::isfinite(thresholds_[2]) && interface_ == 31;
    if (watched && way_ > behaviour_.contact_after && behaviour_.contact_force > thresholds_[2]) {
        condition_met_ = true;
        active_ = false;
    } else if (share == 1.0 && interface_ == 31) {
        active_ = false;
    }
}

std::array<double, 6> ScriptedCabinet::pose() const {
    const motion::Pose tool{{0, 0, behaviour_.tool_length}, {1, 0, 0, 0}};
    const auto at = model_.kinematics().forward(position_) * tool;
    const Eigen::Matrix3d r = at.rotation.toRotationMatrix();
    return {1000 * at.translation.x(),
            1000 * at.translation.y(),
            1000 * at.translation.z(),
            std::atan2(r(1, 0), r(0, 0)),
            std::asin(std::clamp(-r(2, 0), -1.0, 1.0)),
            std::atan2(r(2, 1), r(2, 2))};
}

std::vector<std::byte> ScriptedCabinet::state(bool executed) const {
    std::vector<double> numbers{executed ? 1.0 : 0.0};
    numbers.insert(numbers.end(), position_.begin(), position_.end());
    numbers.insert(numbers.end(), velocity_.begin(), velocity_.end());
    numbers.insert(numbers.end(), 7, 0.25);
    const auto at = pose();
    numbers.insert(numbers.end(), at.begin(), at.end());
    const double contact = way_ > behaviour_.contact_after ? behaviour_.contact_force : 0.5;
    numbers.insert(numbers.end(), {1.0, -2.0, contact, 0.1, 0.2, 0.3});
    const bool ready = behaviour_.ready && (!active_ || behaviour_.ready_while_moving);
    numbers.insert(numbers.end(), {static_cast<double>(last_error_), condition_met_ ? 1.0 : 0.0,
                                   ready ? 1.0 : 0.0, active_ ? 1.0 : 0.0});
    std::vector<std::byte> bytes;
    for (const double number : numbers) {
        append(bytes, number, options_.double_precision);
    }
    return bytes;
}

}  // namespace metier::iiwa_driver
