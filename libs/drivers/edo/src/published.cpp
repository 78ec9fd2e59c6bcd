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

/// Reads an object: `read` takes the value of one key and returns false if it is unusual.
template <typename Read>
bool readObject(JsonCursor& cursor, const Read& read) noexcept {
    cursor.enterObject();
    while (const auto key = cursor.nextKey()) {
        if (!read(*key)) {
            return false;
        }
    }
    return cursor.ok();
}

bool skip(JsonCursor& cursor) noexcept {
    cursor.skip();
    return true;
}

template <typename Integer>
bool readInteger(JsonCursor& cursor, std::int64_t low, std::int64_t high, Integer& to) noexcept {
    const auto value = cursor.integer();
    to = static_cast<Integer>(value);
    return cursor.ok() && value >= low && value <= high;
}

template <typename Message>
std::optional<Incoming> ifUsual(bool usual, const Message& message) noexcept {
    return usual ? std::optional<Incoming>(message) : std::nullopt;
}

std::optional<Published> split(std::string_view text) noexcept {
    JsonCursor cursor(text);
    Published parts;
    std::string_view op;
    const bool whole = readObject(cursor, [&](std::string_view key) {
        if (key == "op") {
            op = cursor.string();
        } else if (key == "topic") {
            parts.topic = cursor.string();
        } else {
            const auto value = cursor.skip();
            parts.message = key == "msg" ? value : parts.message;
        }
        return true;
    });
    return whole && cursor.atEnd() && op == "publish" ? std::optional(parts) : std::nullopt;
}

bool readJoint(JsonCursor& cursor, double unit, JointSample& sample) noexcept {
    return readObject(cursor, [&](std::string_view key) {
        if (key == "position") {
            sample.position = cursor.numberOrNull() * unit;
        } else if (key == "velocity") {
            sample.velocity = cursor.numberOrNull() * unit;
        } else if (key == "current") {
            sample.current = cursor.numberOrNull();
        } else if (key == "commandFlag") {
            return readInteger(cursor, 0, 0xffff, sample.flags);
        } else {
            cursor.skip();
        }
        return true;
    });
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
    const bool usual = readObject(cursor, [&](std::string_view key) {
        found = found || key == "joints";
        return key == "joints" ? readList(cursor, layout, states) : skip(cursor);
    });
    return ifUsual(usual && found, states);
}

std::optional<Incoming> readMachineState(JsonCursor cursor) noexcept {
    MachineState machine;
    const bool usual = readObject(cursor, [&](std::string_view key) {
        return key == "current_state" ? readInteger(cursor, 0, 0xff, machine.state)
               : key == "opcode"      ? readInteger(cursor, 0, 0xffff'ffff, machine.opcode)
                                      : skip(cursor);
    });
    return ifUsual(usual, machine);
}

std::optional<Incoming> readAlgorithmState(JsonCursor cursor) noexcept {
    AlgorithmState algorithm;
    const bool usual = readObject(cursor, [&](std::string_view key) {
        return key == "data" ? readInteger(cursor, -128, 127, algorithm.value) : skip(cursor);
    });
    return ifUsual(usual, algorithm);
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
