#include "decoder.hpp"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "published.hpp"
#include "units.hpp"

namespace metier::edo_driver {
namespace {

using Json = nlohmann::json;

constexpr std::int64_t kSoftwareId = 255;  // id of the entry of the robot's software

/// Reads the fields of one object; the first that is wrong is kept.
class Fields {
public:
    Fields(const Json& object, std::string_view name) : object_(object), name_(name) {
        if (!object.is_object()) {
            wrong("", "is not an object");
        }
    }

    const Json* find(std::string_view key) const {
        if (!object_.is_object()) {
            return nullptr;
        }
        const auto found = object_.find(key);
        return found == object_.end() ? nullptr : &*found;
    }

    std::int64_t integer(std::string_view key, std::int64_t low, std::int64_t high) {
        const auto* value = find(key);
        if (value == nullptr) {
            return 0;
        }
        if (!value->is_number_integer()) {
            wrong(key, "is not an integer");
            return 0;
        }
        const bool large = value->is_number_unsigned() &&
                           value->get<std::uint64_t>() > static_cast<std::uint64_t>(high);
        const auto number = large ? high : value->get<std::int64_t>();
        if (large || number < low || number > high) {
            wrong(key, fmt::format("is not within {} and {}", low, high));
            return 0;
        }
        return number;
    }

    double number(std::string_view key) {
        const auto* value = find(key);
        if (value == nullptr) {
            return 0.0;
        }
        if (value->is_null()) {
            return std::numeric_limits<double>::quiet_NaN();
        }
        if (!value->is_number()) {
            wrong(key, "is not a number");
            return 0.0;
        }
        return value->get<double>();
    }

    std::string text(std::string_view key) {
        const auto* value = find(key);
        if (value == nullptr) {
            return {};
        }
        if (!value->is_string()) {
            wrong(key, "is not a text");
            return {};
        }
        return value->get<std::string>();
    }

    void wrong(std::string_view key, std::string_view why) {
        if (problem_.empty()) {
            problem_ = fmt::format("{}{}{} {}", name_, key.empty() ? "" : ".", key, why);
        }
    }

    /// The read value, unless there was an error.
    template <typename T>
    Result<Incoming> finish(T message) const {
        if (!problem_.empty()) {
            return fail(Errc::invalid_argument, problem_);
        }
        return Incoming(std::move(message));
    }
    const std::string& problem() const { return problem_; }

private:
    const Json& object_;
    std::string_view name_;
    std::string problem_;
};

Result<Incoming> decodeJointStates(const Json& message, const JointLayout& layout) {
    Fields fields(message, "JointStateArray");
    JointStates states;
    const auto* joints = fields.find("joints");
    if (joints == nullptr || !joints->is_array()) {
        fields.wrong("joints", "is not a list");
        return fields.finish(states);
    }
    if (joints->size() > kMaxJoints) {
        fields.wrong("joints",
                     fmt::format("has {} entries, more than {}", joints->size(), kMaxJoints));
        return fields.finish(states);
    }
    for (const auto& entry : *joints) {
        Fields joint(entry, "JointState");
        const double unit = unitOf(layout, states.count);
        auto& sample = states.joints[states.count++];
        sample.position = joint.number("position") * unit;
        sample.velocity = joint.number("velocity") * unit;
        sample.current = joint.number("current");
        sample.flags = static_cast<std::uint32_t>(joint.integer("commandFlag", 0, 0xffff));
        if (!joint.problem().empty()) {
            return joint.finish(states);
        }
    }
    return fields.finish(states);
}

Result<Incoming> decodeMachineState(const Json& message) {
    Fields fields(message, "MachineState");
    MachineState state;
    state.state = static_cast<std::uint8_t>(fields.integer("current_state", 0, 0xff));
    state.opcode = static_cast<std::uint32_t>(fields.integer("opcode", 0, 0xffff'ffff));
    return fields.finish(state);
}

Result<Incoming> decodeAlgorithmState(const Json& message) {
    Fields fields(message, "Int8");
    return fields.finish(AlgorithmState{static_cast<int>(fields.integer("data", -128, 127))});
}

Result<Incoming> decodeMovementFeedback(const Json& message) {
    Fields fields(message, "MovementFeedback");
    MovementFeedback feedback;
    feedback.type = static_cast<int>(fields.integer("type", -128, 127));
    feedback.data = static_cast<int>(fields.integer("data", -128, 127));
    return fields.finish(feedback);
}

Result<Incoming> decodePublish(Fields& fields, const JointLayout& layout) {
    const auto topic = fields.text("topic");
    const auto* message = fields.find("msg");
    if (message == nullptr) {
        fields.wrong("msg", "is missing");
        return fields.finish(Ignored{});
    }
    if (topic == "/usb_jnt_state") {
        return decodeJointStates(*message, layout);
    }
    if (topic == "/machine_state") {
        return decodeMachineState(*message);
    }
    if (topic == "/algorithm_state") {
        return decodeAlgorithmState(*message);
    }
    if (topic == "/machine_movement_ack") {
        return decodeMovementFeedback(*message);
    }
    return fields.finish(Ignored{});
}

/// The robot's software in a NodeSwVersionArray, if it is there.
std::optional<std::string> softwareIn(const Json& values) {
    const auto version = values.find("version");
    if (version == values.end() || !version->is_object()) {
        return std::nullopt;
    }
    const auto nodes = version->find("nodes");
    if (nodes == version->end() || !nodes->is_array()) {
        return std::nullopt;
    }
    for (const auto& node : *nodes) {
        Fields fields(node, "NodeSwVersion");
        const auto id = fields.integer("id", 0, 0xffff);
        auto text = fields.text("version");
        if (fields.problem().empty() && id == kSoftwareId) {
            return text;
        }
    }
    return std::nullopt;
}

Result<Incoming> decodeResponse(Fields& fields) {
    ServiceResponse response;
    response.id = fields.text("id");
    const auto* ok = fields.find("result");
    response.ok = ok == nullptr || (ok->is_boolean() && ok->get<bool>());
    const auto* values = fields.find("values");
    if (values != nullptr && values->is_string()) {
        response.text = values->get<std::string>();
    }
    if (values != nullptr && values->is_object()) {
        if (values->contains("result")) {
            Fields inner(*values, "ControlSwitch");
            response.result_code = static_cast<int>(inner.integer("result", 0, 0xff));
            if (!inner.problem().empty()) {
                return inner.finish(response);
            }
        }
        response.software = softwareIn(*values);
    }
    return fields.finish(std::move(response));
}

}  // namespace

Result<Incoming> decode(std::string_view text, const JointLayout& layout) {
    if (auto usual = readPublished(text, layout)) {
        return *std::move(usual);
    }
    return decodeInFull(text, layout);
}

Result<Incoming> decodeInFull(std::string_view text, const JointLayout& layout) {
    const auto json = Json::parse(text, nullptr, false);
    if (json.is_discarded()) {
        return fail(Errc::invalid_argument,
                    fmt::format("{} characters that are not JSON", text.size()));
    }
    Fields fields(json, "message");
    const auto op = fields.text("op");
    if (op == "publish") {
        return decodePublish(fields, layout);
    }
    if (op == "service_response") {
        return decodeResponse(fields);
    }
    if (op == "status") {
        return fields.finish(Status{fields.text("level"), fields.text("msg")});
    }
    if (op == "fragment") {
        return fail(Errc::not_supported,
                    "the server sends fragments, although no subscription asks for them");
    }
    return fields.finish(Ignored{});
}

}  // namespace metier::edo_driver
