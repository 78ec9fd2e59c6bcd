#include "value_part.hpp"

#include <utility>

#include "metier/opcua_skill/values.hpp"

namespace metier::opcua_skill {

namespace {

double* component(skill::Frame& frame, Part part) {
    switch (part) {
        case Part::x:
            return &frame.x;
        case Part::y:
            return &frame.y;
        case Part::z:
            return &frame.z;
        case Part::a:
            return &frame.a;
        case Part::b:
            return &frame.b;
        case Part::c:
            return &frame.c;
        default:
            return nullptr;
    }
}

double* component(skill::Vector3& vector, Part part) {
    switch (part) {
        case Part::x:
            return &vector.x;
        case Part::y:
            return &vector.y;
        case Part::z:
            return &vector.z;
        default:
            return nullptr;
    }
}

/// The component of a Frame or a Vector3; null for all else.
double* componentOf(skill::Value& value, Part part) {
    if (auto* frame = std::get_if<skill::Frame>(&value)) {
        return component(*frame, part);
    }
    if (auto* vector = std::get_if<skill::Vector3>(&value)) {
        return component(*vector, part);
    }
    return nullptr;
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
