#include "call.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace metier::urscript {
namespace {

/// The word number `index` of words that blanks separate.
std::string_view wordOf(std::string_view words, std::size_t index) {
    for (; index > 0; --index) {
        words.remove_prefix(std::min(words.find(' '), words.size() - 1) + 1);
    }
    return words.substr(0, words.find(' '));
}

}  // namespace

double Call::number(std::size_t index) {
    if (!arguments_[index].isNumber()) {
        wrongType(index, "a number");
    }
    return arguments_[index].number();
}

double Call::number(std::size_t index, double otherwise) {
    return given(index) ? number(index) : otherwise;
}

int Call::integer(std::size_t index) {
    const double value = std::trunc(number(index));
    if (value >= std::numeric_limits<int>::min() && value <= std::numeric_limits<int>::max()) {
        return static_cast<int>(value);
    }
    wrongType(index, "an integer of 32 bits");
    return 0;
}

int Call::integer(std::size_t index, int otherwise) {
    return given(index) ? integer(index) : otherwise;
}

bool Call::boolean(std::size_t index) {
    const Value& value = arguments_[index];
    if (const bool* truth = value.get<bool>()) {
        return *truth;
    }
    if (!value.isNumber()) {
        wrongType(index, "a bool");
    }
    return value.number() != 0.0;
}

bool Call::boolean(std::size_t index, bool otherwise) {
    return given(index) ? boolean(index) : otherwise;
}

template <typename T>
T Call::as(std::size_t index, std::string_view wanted) {
    if (const T* value = arguments_[index].get<T>()) {
        return *value;
    }
    wrongType(index, wanted);
    return {};
}

std::string Call::string(std::size_t index) {
    return as<std::string>(index, "a string");
}

std::string Call::string(std::size_t index, std::string_view otherwise) {
    return given(index) ? string(index) : std::string(otherwise);
}

List Call::list(std::size_t index) {
    return as<List>(index, "a list");
}

Pose Call::pose(std::size_t index) {
    return as<Pose>(index, "a pose");
}

template <std::size_t n>
std::array<double, n> Call::numbers(std::size_t index) {
    std::array<double, n> result{};
    const List* list = arguments_[index].get<List>();
    const bool fits = list != nullptr && list->size() == n &&
                      std::all_of(list->elements().begin(), list->elements().end(),
                                  [](const Value& element) { return element.isNumber(); });
    if (!fits) {
        wrongType(index, fmt::format("a list of {} numbers", n));
        return result;
    }
    std::transform(list->elements().begin(), list->elements().end(), result.begin(),
                   [](const Value& element) { return element.number(); });
    return result;
}

Vector3 Call::vector3(std::size_t index) {
    return numbers<3>(index);
}

Vector6 Call::vector6(std::size_t index) {
    const Pose* pose = arguments_[index].get<Pose>();
    return pose != nullptr ? pose->value : numbers<6>(index);
}

Target Call::target(std::size_t index) {
    if (const Pose* pose = arguments_[index].get<Pose>()) {
        return *pose;
    }
    return numbers<6>(index);
}

Value Call::failed(Error error) {
    if (!error_) {
        error_ = std::move(error);
    }
    return {};
}

Value Call::failed(Errc code, std::string_view why) {
    return failed(Error{code, fmt::format("{}: {}", builtin_.name, why)});
}

Value Call::wrongType(std::size_t index, std::string_view wanted) {
    const Value& value = arguments_[index];
    std::string found(value.typeName());
    if (const List* list = value.get<List>()) {
        found = fmt::format("list of {}", list->size());
    }
    return failed(Errc::type_mismatch,
                  fmt::format("argument {} has to be {}, not {}",
                              wordOf(builtin_.parameters, index), wanted, found));
}

Value Call::waits(Wait wait) {
    if (ok()) {
        wait_ = std::move(wait);
    }
    return {};
}

Value Call::sleeps(double duration) {
    return waits([cycles = cyclesOf(duration, robot().stepTime())]() mutable {
        --cycles;
        return Result<std::optional<Value>>(cycles > 0 ? std::optional<Value>() : Value());
    });
}

Value Call::moves(const Motion& motion) {
    if (!ok()) {
        return {};
    }
    if (auto begun = context_.beginMotion(motion); !begun) {
        return failed(std::move(begun.error()));
    }
    return waits([&context = context_]() -> Result<std::optional<Value>> {
        METIER_ASSIGN(const auto done, context.motionDone());
        return done ? std::optional<Value>(Value()) : std::nullopt;
    });
}

Value Call::applies(const Command& command) {
    return ok() ? checked(robot().apply(command)) : Value();
}

std::int64_t cyclesOf(double duration, double step_time) {
    constexpr double kMost = 1e15;  // integers up to here are exact in a double
    const double cycles = std::ceil(duration / step_time - 1e-6);
    return cycles >= 1.0 ? static_cast<std::int64_t>(std::min(cycles, kMost)) : 1;
}

}  // namespace metier::urscript
