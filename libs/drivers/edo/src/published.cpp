#include "published.hpp"

#include "json_cursor.hpp"
#include "units.hpp"

namespace metier::edo_driver {
namespace {

/// The parts of a `publish` text; `message` is JSON.
struct Published {
    std::string_view topic;
    std::string_view message;
};

std::optional<Published> split(std::string_view text) noexcept {
    JsonCursor cursor(text);
    Published parts;
    std::string_view op;
    cursor.enterObject();
    while (const auto key = cursor.nextKey()) {
        if (*key == "op") {
            op = cursor.string();
        } else if (*key == "topic") {
            parts.topic = cursor.string();
        } else if (*key == "msg") {
            parts.message = cursor.skip();
        } else {
            cursor.skip();
        }
    }
    const bool usual = cursor.ok() && cursor.atEnd() && op == "publish";
    return usual ? std::optional(parts) : std::nullopt;
}

/// An integer within the limits; nothing is what an unusual message has.
std::optional<std::int64_t> integer(JsonCursor& cursor, std::int64_t low,
                                    std::int64_t high) noexcept {
    const auto value = cursor.integer();
    return cursor.ok() && value >= low && value <= high ? std::optional(value) : std::nullopt;
}

bool readJoint(JsonCursor& cursor, double unit, JointSample& sample) noexcept {
    cursor.enterObject();
    while (const auto key = cursor.nextKey()) {
        if (*key == "position") {
            sample.position = cursor.numberOrNull() * unit;
        } else if (*key == "velocity") {
            sample.velocity = cursor.numberOrNull() * unit;
        } else if (*key == "current") {
            sample.current = cursor.numberOrNull();
        } else if (*key == "commandFlag") {
            const auto flags = integer(cursor, 0, 0xffff);
            if (!flags) {
                return false;
            }
            sample.flags = static_cast<std::uint32_t>(*flags);
        } else {
            cursor.skip();
        }
    }
    return cursor.ok();
}

bool readList(JsonCursor& cursor, const JointLayout& layout, JointStates& states) noexcept {
    states = {};
    cursor.enterList();
    while (cursor.nextElement()) {
        if (states.count == kMaxJoints ||
            !readJoint(cursor, unitOf(layout, states.count), states.joints[states.count])) {
            return false;
        }
        ++states.count;
    }
    return cursor.ok();
}

std::optional<Incoming> readJointStates(JsonCursor cursor, const JointLayout& layout) noexcept {
    JointStates states;
    bool found = false;
    cursor.enterObject();
    while (const auto key = cursor.nextKey()) {
        if (*key != "joints") {
            cursor.skip();
        } else if (!readList(cursor, layout, states)) {
            return std::nullopt;
        } else {
            found = true;
        }
    }
    return found && cursor.ok() ? std::optional<Incoming>(states) : std::nullopt;
}

std::optional<Incoming> readMachineState(JsonCursor cursor) noexcept {
    MachineState machine;
    cursor.enterObject();
    while (const auto key = cursor.nextKey()) {
        const bool state = *key == "current_state";
        if (!state && *key != "opcode") {
            cursor.skip();
            continue;
        }
        const auto value = integer(cursor, 0, state ? 0xff : 0xffff'ffff);
        if (!value) {
            return std::nullopt;
        }
        if (state) {
            machine.state = static_cast<std::uint8_t>(*value);
        } else {
            machine.opcode = static_cast<std::uint32_t>(*value);
        }
    }
    return cursor.ok() ? std::optional<Incoming>(machine) : std::nullopt;
}

std::optional<Incoming> readAlgorithmState(JsonCursor cursor) noexcept {
    AlgorithmState algorithm;
    cursor.enterObject();
    while (const auto key = cursor.nextKey()) {
        if (*key != "data") {
            cursor.skip();
            continue;
        }
        const auto value = integer(cursor, -128, 127);
        if (!value) {
            return std::nullopt;
        }
        algorithm.value = static_cast<int>(*value);
    }
    return cursor.ok() ? std::optional<Incoming>(algorithm) : std::nullopt;
}

}  // namespace

std::optional<Incoming> readPublished(std::string_view text, const JointLayout& layout) noexcept {
    const auto parts = split(text);
    if (!parts) {
        return std::nullopt;
    }
    const JsonCursor message(parts->message);
    if (parts->topic == "/usb_jnt_state") {
        return readJointStates(message, layout);
    }
    if (parts->topic == "/machine_state") {
        return readMachineState(message);
    }
    if (parts->topic == "/algorithm_state") {
        return readAlgorithmState(message);
    }
    return std::nullopt;
}

}  // namespace metier::edo_driver
