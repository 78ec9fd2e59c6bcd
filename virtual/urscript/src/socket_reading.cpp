#include "socket_reading.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

#include "metier/base/text.hpp"

namespace metier::urscript {
namespace {

constexpr std::size_t kMostText = 1024;

}  // namespace

std::optional<Extracted> extractIntegers(std::string_view bytes, std::size_t count,
                                         std::size_t width) {
    if (bytes.size() < count * width) {
        return std::nullopt;
    }
    constexpr unsigned kBitsPerByte = 8;
    std::vector<Value> values{static_cast<std::int32_t>(count)};
    for (std::size_t i = 0; i < count; ++i) {
        std::uint32_t number = 0;
        for (const char byte : bytes.substr(i * width, width)) {
            number = number << kBitsPerByte | static_cast<std::uint8_t>(byte);
        }
        values.emplace_back(static_cast<std::int32_t>(number));
    }
    return Extracted{std::move(values), count * width};
}

std::optional<Extracted> extractFloats(std::string_view bytes, std::size_t count) {
    const std::size_t open = bytes.find('(');
    const std::size_t close = open == bytes.npos ? open : bytes.find(')', open);
    if (close == bytes.npos) {
        return std::nullopt;
    }
    std::string_view inside = bytes.substr(open + 1, close - open - 1);
    std::vector<Value> values{static_cast<double>(count)};
    bool more = true;
    while (more && values.size() <= count + 1) {
        const std::size_t comma = std::min(inside.find(','), inside.size());
        const auto number = numberIn<double>(trimmed(inside.substr(0, comma)));
        more = number && comma < inside.size();
        values.emplace_back(number.value_or(std::numeric_limits<double>::quiet_NaN()));
        inside.remove_prefix(std::min(comma + 1, inside.size()));
    }
    const bool complete =
        values.size() == count + 1 && !more && values.back().number() == values.back().number();
    return Extracted{complete ? Value(std::move(values))
                              : failedRead(count, std::numeric_limits<double>::quiet_NaN()),
                     close + 1};
}

std::optional<Extracted> extractLine(std::string_view bytes) {
    const std::size_t end = bytes.find('\n');
    if (end == bytes.npos) {
        return std::nullopt;
    }
    std::string_view line = bytes.substr(0, end);
    if (!line.empty() && line.back() == '\r') {
        line.remove_suffix(1);
    }
    return Extracted{std::string(line), end + 1};
}

std::optional<Extracted> extractText(std::string_view bytes, std::string_view prefix,
                                     std::string_view suffix) {
    const std::size_t before = bytes.find(prefix);
    if (bytes.empty() || before == bytes.npos) {
        return std::nullopt;
    }
    const std::size_t begin = before + prefix.size();
    if (suffix.empty()) {
        const std::string_view text = bytes.substr(begin, kMostText);
        return Extracted{std::string(text), begin + text.size()};
    }
    const std::size_t end = bytes.find(suffix, begin);
    if (end == bytes.npos) {
        return std::nullopt;
    }
    return Extracted{std::string(bytes.substr(begin, std::min(end - begin, kMostText))),
                     end + suffix.size()};
}

std::optional<Extracted> extractVariable(std::string_view bytes, std::string_view name) {
    auto line = extractLine(bytes);
    if (!line) {
        return std::nullopt;
    }
    const std::string_view text = *line->value.get<std::string>();
    const auto number =
        text.starts_with(name) ? numberIn<double>(trimmed(text.substr(name.size()))) : std::nullopt;
    const bool fits = number && *number >= std::numeric_limits<std::int32_t>::min() &&
                      *number <= std::numeric_limits<std::int32_t>::max();
    line->value = fits ? static_cast<std::int32_t>(*number) : 0;
    return line;
}

Value failedRead(std::size_t count, const Value& element) {
    std::vector<Value> values(count + 1, element);
    values[0] = element.get<double>() != nullptr ? Value(0.0) : Value(0);
    return values;
}

std::string unescaped(std::string_view text) {
    constexpr std::string_view kWritten = "nrt";
    constexpr std::string_view kMeant = "\n\r\t";
    std::string result;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool escape = text[i] == '\\' && i + 1 < text.size();
        const std::size_t known = escape ? kWritten.find(text[i + 1]) : kWritten.npos;
        result += known == kWritten.npos ? text[i] : kMeant[known];
        i += known == kWritten.npos ? 0 : 1;
    }
    return result;
}

}  // namespace metier::urscript
