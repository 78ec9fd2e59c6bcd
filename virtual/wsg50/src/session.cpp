#include "session.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include "metier/base/numbers.hpp"
#include "payload.hpp"

namespace metier::virtual_wsg50 {

namespace {

constexpr std::size_t kAnyLength = 0xFFFF;
constexpr std::size_t kTagLength = 64;
constexpr std::string_view kAcknowledgement = "ack";

/// Allowed length of a command's payload.
struct Shape {
    Command command;
    std::size_t shortest;
    std::size_t longest;
};

constexpr Shape exactly(Command command, std::size_t length) {
    return {command, length, length};
}

constexpr std::array kShapes{
    Shape{Command::loop, 0, kAnyLength},
    exactly(Command::disconnect, 0),
    exactly(Command::home, 1),
    exactly(Command::pre_position, 9),
    exactly(Command::stop, 0),
    exactly(Command::fast_stop, 0),
    exactly(Command::acknowledge, kAcknowledgement.size()),
    exactly(Command::grasp, 8),
    exactly(Command::release, 8),
    exactly(Command::set_acceleration, 4),
    exactly(Command::get_acceleration, 0),
    exactly(Command::set_force_limit, 4),
    exactly(Command::get_force_limit, 0),
    exactly(Command::set_soft_limits, 8),
    exactly(Command::get_soft_limits, 0),
    exactly(Command::clear_soft_limits, 0),
    exactly(Command::overdrive, 1),
    exactly(Command::tare, 0),
    exactly(Command::system_state, 3),
    exactly(Command::grasping_state, 3),
    exactly(Command::statistics, 1),
    exactly(Command::width, 3),
    exactly(Command::speed, 3),
    exactly(Command::force, 3),
    exactly(Command::temperature, 0),
    exactly(Command::system_info, 0),
    Shape{Command::set_device_tag, 0, kTagLength},
    exactly(Command::get_device_tag, 0),
    exactly(Command::limits, 0),
    Shape{Command::finger_info, 0, 1},
    Shape{Command::finger_flags, 0, 1},
    Shape{Command::finger_power, 0, 2},
    Shape{Command::finger_data, 0, 1},
};

Status checkShape(const Frame& frame) {
    const auto shape = std::find_if(kShapes.begin(), kShapes.end(), [&](const Shape& candidate) {
        return static_cast<std::uint8_t>(candidate.command) == frame.id;
    });
    if (shape == kShapes.end()) {
        return Status::unknown_command;
    }
    if (frame.payload.size() < shape->shortest) {
        return Status::not_enough_parameters;
    }
    return frame.payload.size() > shape->longest ? Status::no_parameters_expected : Status::success;
}

}  // namespace

Session::Session(Gripper& gripper, Identity& identity, Send send)
    : gripper_(gripper),
      identity_(identity),
      send_(std::move(send)),
      updates_{Update{Command::system_state}, Update{Command::grasping_state},
               Update{Command::width}, Update{Command::speed}, Update{Command::force}} {}

void Session::receive(std::span<const std::byte> bytes) {
    reader_.feed(bytes);
    while (const auto frame = reader_.next()) {
        handle(*frame);
    }
}

void Session::handle(const Frame& frame) {
    const auto command = static_cast<Command>(frame.id);
    const auto status = frame.intact ? checkShape(frame) : Status::checksum_error;
    if (status == Status::success) {
        answer(command, frame.payload);
    } else {
        reply(command, status, {});
    }
}

void Session::answer(Command command, std::span<const std::byte> payload) {
    switch (static_cast<std::uint8_t>(command) >> 4U) {
        case 0:
            disconnect_announced_ |= command == Command::disconnect;
            return reply(command, Status::success, payload);
        case 2:
            return command >= Command::stop && command <= Command::acknowledge
                       ? answerStop(command, payload)
                       : answerMotion(command, payload);
        case 3:
            return answerSetting(command, payload);
        case 6:
            return reply(command, Status::not_available, {});
        default:
            return answerQuery(command, payload);
    }
}

void Session::answerMotion(Command command, std::span<const std::byte> payload) {
    PayloadReader in(payload);
    if (command == Command::home) {
        const auto direction = in.u8();
        return reply(command,
                     direction <= 2 ? gripper_.home(static_cast<HomingDirection>(direction))
                                    : Status::invalid_parameter,
                     {});
    }
    const unsigned flags = command == Command::pre_position ? in.u8() : 0U;
    const double width = in.f32() * kMillimetre;
    const double speed = in.f32() * kMillimetre;
    if (command == Command::grasp) {
        reply(command, gripper_.grasp(width, speed), {});
    } else if (command == Command::release) {
        reply(command, gripper_.release(width, speed), {});
    } else {
        const auto when_blocked = (flags & 2U) != 0 ? WhenBlocked::stop : WhenBlocked::clamp;
        const double target = (flags & 1U) != 0 ? gripper_.width() + width : width;
        reply(command, gripper_.prePosition(target, speed, when_blocked), {});
    }
}

void Session::answerStop(Command command, std::span<const std::byte> payload) {
    auto status = Status::success;
    switch (command) {
        case Command::stop:
            gripper_.stop();
            break;
        case Command::fast_stop:
            gripper_.fastStop();
            break;
        default:
            if (std::ranges::equal(payload, std::as_bytes(std::span(kAcknowledgement)))) {
                gripper_.acknowledge();
            } else {
                status = Status::invalid_parameter;
            }
    }
    reply(command, status, {});
}

void Session::answerSetting(Command command, std::span<const std::byte> payload) {
    PayloadReader in(payload);
    PayloadWriter out;
    auto status = Status::success;
    switch (command) {
        case Command::set_acceleration:
            status = gripper_.setAcceleration(in.f32() * kMillimetre);
            break;
        case Command::get_acceleration:
            out.f32(gripper_.acceleration() / kMillimetre);
            break;
        case Command::set_force_limit:
            status = gripper_.setForceLimit(in.f32());
            break;
        case Command::get_force_limit:
            out.f32(gripper_.forceLimit());
            break;
        case Command::set_soft_limits: {
            const double minus = in.f32() * kMillimetre;
            status = gripper_.setSoftLimits({minus, in.f32() * kMillimetre});
            break;
        }
        case Command::get_soft_limits: {
            const auto limits = gripper_.softLimits();
            out.f32(limits.minus / kMillimetre).f32(limits.plus / kMillimetre);
            break;
        }
        case Command::clear_soft_limits:
            gripper_.clearSoftLimits();
            break;
        case Command::overdrive:
            gripper_.setOverdrive(in.u8() != 0);
            break;
        default:  // tare: the simulated sensor has no offset
            break;
    }
    reply(command, status, out.bytes());
}

void Session::answerQuery(Command command, std::span<const std::byte> payload) {
    PayloadWriter out;
    switch (command) {
        case Command::statistics:
            out.u32(gripper_.cycles()).u16(gripper_.cyclesSinceReset());
            out.u16(gripper_.abortedSinceReset());
            if (PayloadReader(payload).u8() != 0) {
                gripper_.resetStatistics();
            }
            break;
        case Command::temperature:
            out.u16(static_cast<std::uint16_t>(gripper_.temperature() * 10.0));
            break;
        case Command::system_info:
            out.u8(1).u8(1).u16(0x2640).u32(identity_.serial);
            break;
        case Command::set_device_tag:
            identity_.tag.assign(payload.size(), '\0');
            std::ranges::transform(payload, identity_.tag.begin(),
                                   [](std::byte byte) { return static_cast<char>(byte); });
            break;
        case Command::get_device_tag:
            out.text(identity_.tag);
            break;
        case Command::limits: {
            const auto& can = gripper_.capability();
            out.f32(can.stroke / kMillimetre).f32(can.min_speed / kMillimetre);
            out.f32(can.max_speed / kMillimetre).f32(can.min_acceleration / kMillimetre);
            out.f32(can.max_acceleration / kMillimetre).f32(can.min_force);
            out.f32(can.nominal_force).f32(can.overdrive_force);
            break;
        }
        default:
            return answerUpdate(command, payload);
    }
    reply(command, Status::success, out.bytes());
}

// ---- values and their updates ------------------------------------------------------------------

void Session::answerUpdate(Command command, std::span<const std::byte> payload) {
    PayloadReader in(payload);
    const auto flags = in.u8();
    const std::uint32_t period = in.u16();
    const bool wanted = (flags & 1U) != 0;
    if (wanted && period == 0) {
        return reply(command, Status::invalid_parameter, {});
    }
    for (auto& update : updates_) {
        if (update.command == command) {
            update.period = wanted ? period : 0;
            update.waited = 0;
            update.only_changes = (flags & 2U) != 0;
            update.last = value(command);
        }
    }
    reply(command, Status::success, value(command));
}

std::vector<std::byte> Session::value(Command command) const {
    PayloadWriter out;
    switch (command) {
        case Command::system_state:
            out.u32(gripper_.systemState());
            break;
        case Command::grasping_state:
            out.u8(static_cast<std::uint8_t>(gripper_.graspingState()));
            break;
        case Command::width:
            out.f32(gripper_.width() / kMillimetre);
            break;
        case Command::speed:
            out.f32(gripper_.velocity() / kMillimetre);
            break;
        default:
            out.f32(gripper_.force());
    }
    return out.bytes();
}

void Session::step(std::chrono::milliseconds elapsed) {
    for (auto& update : updates_) {
        if (update.period == 0) {
            continue;
        }
        update.waited += static_cast<std::uint32_t>(elapsed.count());
        if (update.waited < update.period) {
            continue;
        }
        update.waited %= update.period;
        auto now = value(update.command);
        if (!update.only_changes || now != update.last) {
            reply(update.command, Status::success, now);
            update.last = std::move(now);
        }
    }
}

void Session::reply(Command command, Status status, std::span<const std::byte> data) {
    PayloadWriter out;
    out.u16(static_cast<std::uint16_t>(status)).raw(data);
    send_(encode(static_cast<std::uint8_t>(command), out.bytes()));
}

}  // namespace metier::virtual_wsg50
