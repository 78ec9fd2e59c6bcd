#include <cmath>
#include <limits>
#include <numbers>

#include "call.hpp"

namespace metier::urscript {
namespace {

constexpr double kDegreesPerHalfTurn = 180.0;

/// A whole number as an int, if it fits.
Value whole(Call& call, double value) {
    using Limits = std::numeric_limits<std::int32_t>;
    if (!(value >= Limits::min() && value <= Limits::max())) {  // also what is not a number
        return call.failed(Errc::out_of_range, "the result is not an integer of 32 bits");
    }
    return static_cast<std::int32_t>(value);
}

Value absolute(Call& call) {
    if (const auto* integer = call.value(0).get<std::int32_t>()) {
        return whole(call, std::abs(static_cast<double>(*integer)));
    }
    return std::abs(call.number(0));
}

Value arcus(Call& call, double (*function)(double)) {
    const double value = call.number(0);
    if (std::abs(value) > 1.0) {
        return call.failed(Errc::out_of_range, "the argument has to be from -1 to 1");
    }
    return function(value);
}

Value squareRoot(Call& call) {
    const double value = call.number(0);
    if (value < 0.0) {
        return call.failed(Errc::out_of_range, "the argument is negative");
    }
    return std::sqrt(value);
}

Value power(Call& call) {
    const double base = call.number(0);
    const double exponent = call.number(1);
    if ((base < 0.0 && exponent != std::floor(exponent)) || (base == 0.0 && exponent < 0.0)) {
        return call.failed(Errc::out_of_range, "there is no such power");
    }
    return std::pow(base, exponent);
}

Value logarithm(Call& call) {
    const double base = call.number(0);
    const double value = call.number(1);
    if (base <= 0.0 || base == 1.0 || value <= 0.0) {
        return call.failed(Errc::out_of_range, "there is no such logarithm");
    }
    return std::log(value) / std::log(base);
}

double squares(Call& call, const List& list) {
    double sum = 0.0;
    for (const Value& element : list.elements()) {
        if (!element.isNumber()) {
            call.failed(Errc::type_mismatch, "the elements have to be numbers");
        }
        sum += element.number() * element.number();
    }
    return sum;
}

Value norm(Call& call) {
    if (call.value(0).isNumber()) {
        return absolute(call);
    }
    if (const Pose* pose = call.value(0).get<Pose>()) {
        return std::sqrt(squares(call, *Value(pose->value).get<List>()));
    }
    return std::sqrt(squares(call, call.list(0)));
}

Value normalize(Call& call) {
    const List list = call.list(0);
    const double length = std::sqrt(squares(call, list));
    if (length == 0.0) {
        return call.failed(Errc::out_of_range, "all elements are zero");
    }
    std::vector<Value> result;
    for (const Value& element : list.elements()) {
        result.emplace_back(element.number() / length);
    }
    return result;
}

}  // namespace

std::span<const Builtin> mathBuiltins() {
    using std::numbers::pi;
    static constexpr Builtin kAll[] = {
        {"abs", "f", 1, absolute},
        {"acos", "f", 1, [](Call& call) { return arcus(call, std::acos); }},
        {"asin", "f", 1, [](Call& call) { return arcus(call, std::asin); }},
        {"atan", "f", 1, [](Call& call) { return Value(std::atan(call.number(0))); }},
        {"atan2", "x y", 2,
         [](Call& call) { return Value(std::atan2(call.number(0), call.number(1))); }},
        {"ceil", "f", 1, [](Call& call) { return whole(call, std::ceil(call.number(0))); }},
        {"cos", "f", 1, [](Call& call) { return Value(std::cos(call.number(0))); }},
        {"d2r", "d", 1,
         [](Call& call) { return Value(call.number(0) / kDegreesPerHalfTurn * pi); }},
        {"floor", "f", 1, [](Call& call) { return whole(call, std::floor(call.number(0))); }},
        {"log", "b f", 2, logarithm},
        {"norm", "a", 1, norm},
        {"normalize", "v", 1, normalize},
        {"pow", "base exponent", 2, power},
        {"r2d", "r", 1,
         [](Call& call) { return Value(call.number(0) / pi * kDegreesPerHalfTurn); }},
        {"random", "", 0, [](Call& call) { return Value(call.context().random()); }},
        {"round", "f", 1, [](Call& call) { return whole(call, std::round(call.number(0))); }},
        {"sin", "f", 1, [](Call& call) { return Value(std::sin(call.number(0))); }},
        {"sqrt", "f", 1, squareRoot},
        {"tan", "f", 1, [](Call& call) { return Value(std::tan(call.number(0))); }},
    };
    return kAll;
}

}  // namespace metier::urscript
