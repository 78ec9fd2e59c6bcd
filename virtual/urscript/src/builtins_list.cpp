#include <algorithm>
#include <cstdint>

#include "call.hpp"

namespace metier::urscript {
namespace {

constexpr std::size_t kBits = 32;

Value length(Call& call) {
    const auto* text = call.value(0).get<std::string>();
    const std::size_t size = text != nullptr ? text->size() : call.list(0).size();
    return static_cast<std::int32_t>(size);
}

Value size(Call& call) {
    const List* list = call.value(0).get<List>();
    const List* row =
        list != nullptr && list->size() > 0 ? list->elements()[0].get<List>() : nullptr;
    if (row == nullptr) {
        return length(call);
    }
    return std::vector<Value>{static_cast<std::int32_t>(list->size()),
                              static_cast<std::int32_t>(row->size())};
}

Value makeList(Call& call) {
    const int count = call.integer(0);
    const std::size_t most = call.context().limits().list_length;
    if (count < 0 || static_cast<std::size_t>(count) > most) {
        return call.failed(Errc::out_of_range,
                           "the length has to be from 0 to " + std::to_string(most));
    }
    if (call.value(1).get<List>() != nullptr) {
        return call.failed(Errc::type_mismatch, "a list of lists is not possible");
    }
    const auto* text = call.value(1).get<std::string>();
    const std::size_t most_text = call.context().limits().text_length;
    if (text != nullptr && text->size() * static_cast<std::size_t>(count) > most_text) {
        return call.failed(Errc::out_of_range,
                           "a list with more than " + std::to_string(most_text) + " characters");
    }
    return std::vector<Value>(static_cast<std::size_t>(count), call.value(1));
}

Value toBits(Call& call) {
    const auto bits = static_cast<std::uint32_t>(call.integer(0));
    std::vector<Value> list;
    for (std::size_t i = 0; i < kBits; ++i) {
        list.emplace_back((bits >> i & 1U) != 0);
    }
    return list;
}

Value fromBits(Call& call) {
    const List list = call.list(0);
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < std::min(list.size(), kBits); ++i) {
        const bool* bit = list.elements()[i].get<bool>();
        if (bit == nullptr) {
            return call.failed(Errc::type_mismatch, "the elements have to be bools");
        }
        bits |= static_cast<std::uint32_t>(*bit) << i;
    }
    return static_cast<std::int32_t>(bits);
}

}  // namespace

std::span<const Builtin> listBuiltins() {
    static constexpr Builtin kAll[] = {
        {"binary_list_to_integer", "l", 1, fromBits},
        {"get_list_length", "v", 1, length},
        {"integer_to_binary_list", "x", 1, toBits},
        {"length", "v", 1, length},
        {"make_list", "length initial_value capacity", 2, makeList},
        {"size", "v", 1, size},
    };
    return kAll;
}

}  // namespace metier::urscript
