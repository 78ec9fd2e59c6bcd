#include <charconv>
#include <limits>
#include <string>

#include "call.hpp"

namespace metier::urscript {
namespace {

/// An index into `text`; the call fails if there is no such character.
std::size_t placeIn(Call& call, std::size_t argument, const std::string& text) {
    const int index = call.integer(argument);
    if (index < 0 || static_cast<std::size_t>(index) >= text.size()) {
        call.failed(Errc::out_of_range, "index " + std::to_string(index) + " of a string of " +
                                            std::to_string(text.size()) + " characters");
        return 0;
    }
    return static_cast<std::size_t>(index);
}

Value characterAt(Call& call) {
    const std::string text = call.string(0);
    const std::size_t place = placeIn(call, 1, text);
    return call.ok() ? Value(text.substr(place, 1)) : Value();
}

Value concatenated(Call& call) {
    const std::size_t most = call.context().limits().text_length;
    std::string text = call.value(0).text();
    if (text.size() <= most) {
        text += call.value(1).text();
    }
    return text;
}

Value found(Call& call) {
    const std::string text = call.string(0);
    const std::string target = call.string(1);
    const int start = call.integer(2, 0);
    if (start < 0) {
        return call.failed(Errc::out_of_range, "the start is negative");
    }
    const std::size_t place = text.find(target, static_cast<std::size_t>(start));
    return place == std::string::npos ? -1 : static_cast<std::int32_t>(place);
}

Value part(Call& call) {
    const std::string text = call.string(0);
    const std::size_t place = placeIn(call, 1, text);
    const int length = call.integer(2, std::numeric_limits<int>::max());
    if (!call.ok()) {
        return {};
    }
    return text.substr(place, length < 0 ? std::string::npos : static_cast<std::size_t>(length));
}

Value toNumber(Call& call) {
    const std::string text = call.string(0);
    const std::size_t first = std::min(text.find_first_not_of(" \t"), text.size());
    const std::size_t end = text.find_last_not_of(" \t\r\n") + 1;
    double number = 0.0;
    const auto [stop, error] = std::from_chars(text.data() + first, text.data() + end, number);
    if (!call.ok() || error != std::errc{} || stop != text.data() + end) {
        return call.failed(Errc::invalid_argument, "'" + text + "' is not a number");
    }
    const bool whole = text.find_first_of(".eEnN", first) == std::string::npos;
    const bool fits = std::abs(number) <= std::numeric_limits<std::int32_t>::max();
    return whole && fits ? Value(static_cast<std::int32_t>(number)) : Value(number);
}

}  // namespace

std::span<const Builtin> textBuiltins() {
    static constexpr Builtin kAll[] = {
        {"str_at", "src index", 2, characterAt},
        {"str_cat", "op1 op2", 2, concatenated},
        {"str_empty", "str", 1, [](Call& call) { return Value(call.string(0).empty()); }},
        {"str_find", "src target start_from", 2, found},
        {"str_len", "str", 1,
         [](Call& call) { return Value(static_cast<std::int32_t>(call.string(0).size())); }},
        {"str_sub", "src index len", 2, part},
        {"to_num", "str", 1, toNumber},
        {"to_str", "val", 1, [](Call& call) { return Value(call.value(0).text()); }},
    };
    return kAll;
}

}  // namespace metier::urscript
