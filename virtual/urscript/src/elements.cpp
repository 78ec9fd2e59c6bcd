#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "operators.hpp"

namespace metier::urscript {
namespace {

constexpr int kDeepestList = 8;

Result<std::size_t> indexOf(const Value& index, std::size_t size) {
    const auto* integer = index.get<std::int32_t>();
    const double number = index.number();
    if (!index.isNumber() || (integer == nullptr && number != std::floor(number))) {
        return fail(Errc::type_mismatch,
                    fmt::format("an index has to be an int, not {}", index.typeName()));
    }
    if (number < 0 || number >= static_cast<double>(size)) {
        return fail(Errc::out_of_range,
                    fmt::format("index {} is out of range: {} elements", index.text(), size));
    }
    return static_cast<std::size_t>(number);
}

Result<Value> oneElementOf(const Value& value, const Value& index) {
    const List* list = value.get<List>();
    const Pose* pose = value.get<Pose>();
    if (list == nullptr && pose == nullptr) {
        return fail(Errc::type_mismatch, fmt::format("{} has no elements", value.typeName()));
    }
    METIER_ASSIGN(const auto i,
                  indexOf(index, list != nullptr ? list->size() : pose->value.size()));
    return list != nullptr ? list->elements()[i] : Value(pose->value[i]);
}

}  // namespace

Result<Value> elementOf(const Value& value, std::span<const Value> indices) {
    Value element = value;
    for (const Value& index : indices) {
        METIER_ASSIGN(element, oneElementOf(element, index));
    }
    return element;
}

Result<void> setElement(Value& target, std::span<const Value> indices, Value value) {
    auto* list = target.get<List>();
    auto* pose = target.get<Pose>();
    if (list == nullptr && pose == nullptr) {
        return fail(Errc::type_mismatch, fmt::format("{} has no elements", target.typeName()));
    }
    METIER_ASSIGN(const auto i,
                  indexOf(indices[0], list != nullptr ? list->size() : pose->value.size()));
    if (pose != nullptr) {
        if (indices.size() > 1 || !value.isNumber()) {
            return fail(Errc::type_mismatch, "an element of a pose has to be a number");
        }
        pose->value[i] = value.number();
        return {};
    }
    if (indices.size() > 1) {
        Value inner = list->elements()[i];
        METIER_TRY(setElement(inner, indices.subspan(1), std::move(value)));
        value = std::move(inner);
    }
    if (const List* inner = value.get<List>(); inner != nullptr && inner->depth() >= kDeepestList) {
        return fail(Errc::out_of_range, fmt::format("more than {} lists in lists", kDeepestList));
    }
    list->set(i, std::move(value));
    return {};
}

Result<Value> listOf(std::vector<Value> elements) {
    List list(std::move(elements));
    if (list.depth() > kDeepestList) {
        return fail(Errc::out_of_range, fmt::format("more than {} lists in lists", kDeepestList));
    }
    return Value(std::move(list));
}

Result<Value> poseOf(std::span<const Value> elements) {
    Pose pose;
    for (std::size_t i = 0; i < pose.value.size(); ++i) {
        if (!elements[i].isNumber()) {
            return fail(Errc::type_mismatch, fmt::format("an element of a pose has to be a number, "
                                                         "not {}",
                                                         elements[i].typeName()));
        }
        pose.value[i] = elements[i].number();
    }
    return Value(pose);
}

std::size_t costOf(const Value& value) {
    constexpr std::size_t kValuesPerInstruction = 4;
    constexpr std::size_t kCharactersPerInstruction = 16;
    if (const List* list = value.get<List>()) {
        return list->weight() / kValuesPerInstruction +
               list->characters() / kCharactersPerInstruction;
    }
    const auto* text = value.get<std::string>();
    return text != nullptr ? text->size() / kCharactersPerInstruction : 0;
}

}  // namespace metier::urscript
