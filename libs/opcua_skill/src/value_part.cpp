#include "value_part.hpp"

#include <array>
#include <utility>

#include "metier/opcua_skill/values.hpp"

namespace metier::opcua_skill {

namespace {

/// The component of a Frame or a Vector3; null for all else.
double* componentOf(skill::Value& value, Part part) {
    using skill::Frame;
    using skill::Vector3;
    constexpr std::array kOfFrame{&Frame::x, &Frame::y, &Frame::z, &Frame::a, &Frame::b, &Frame::c};
    constexpr std::array kOfVector{&Vector3::x, &Vector3::y, &Vector3::z};
    if (part < Part::x) {
        return nullptr;
    }
    const auto index = static_cast<std::size_t>(part) - static_cast<std::size_t>(Part::x);
    if (auto* frame = std::get_if<Frame>(&value)) {
        return &(frame->*kOfFrame.at(index));
    }
    auto* vector = std::get_if<Vector3>(&value);
    return vector != nullptr && index < kOfVector.size() ? &(vector->*kOfVector.at(index))
                                                         : nullptr;
}

}  // namespace

opcua::Value partOf(const skill::Value& value, Part part) {
    if (part == Part::whole) {
        return toOpcua(value);
    }
    if (const auto* frame = std::get_if<skill::Frame>(&value)) {
        if (part == Part::position) {
            return opcua::Value::of(
                opcua::ThreeDCartesianCoordinates{frame->x, frame->y, frame->z});
        }
        if (part == Part::orientation) {
            return opcua::Value::of(opcua::ThreeDOrientation{frame->a, frame->b, frame->c});
        }
    }
    skill::Value copy = value;
    const double* number = componentOf(copy, part);
    return number == nullptr ? opcua::Value() : opcua::Value::of(*number);
}

Result<skill::Value> withPart(const skill::Field& field, const skill::Value& old, Part part,
                              const opcua::Value& value) {
    if (part == Part::whole || value.isEmpty()) {
        return fromOpcua(value, field.type);
    }
    skill::Value result = old;
    if (skill::isNull(result)) {
        result = field.type == skill::ValueType::vector3 ? skill::Value(skill::Vector3{})
                                                         : skill::Value(skill::Frame{});
    }
    auto* frame = std::get_if<skill::Frame>(&result);
    if (frame != nullptr && part == Part::position) {
        return value.as<opcua::ThreeDCartesianCoordinates>().map([&](const auto& position) {
            return skill::Value(
                skill::Frame{position.x, position.y, position.z, frame->a, frame->b, frame->c});
        });
    }
    if (frame != nullptr && part == Part::orientation) {
        return value.as<opcua::ThreeDOrientation>().map([&](const auto& orientation) {
            return skill::Value(skill::Frame{frame->x, frame->y, frame->z, orientation.a,
                                             orientation.b, orientation.c});
        });
    }
    auto number = value.as<double>();
    double* target = componentOf(result, part);
    if (!number || target == nullptr) {
        return fail(Errc::type_mismatch, field.name + " has no part of type " + value.typeName());
    }
    *target = *number;
    return result;
}

}  // namespace metier::opcua_skill
