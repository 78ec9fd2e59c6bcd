#include "nodesets/xml_scalars.hpp"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <limits>

#include "metier/base/text.hpp"
#include "metier/opcua/text.hpp"

namespace metier::opcua {

namespace {

constexpr UA_DateTime kTicksPerSecond = UA_DATETIME_SEC;

/// Takes a number of that many digits from the front.
std::optional<int> takeDigits(std::string_view& text, std::size_t count) {
    if (text.size() < count) {
        return std::nullopt;
    }
    const auto number = numberIn<unsigned>(text.substr(0, count));
    text.remove_prefix(count);
    return number ? std::optional(static_cast<int>(*number)) : std::nullopt;
}

bool take(std::string_view& text, char wanted) {
    if (text.empty() || text.front() != wanted) {
        return false;
    }
    text.remove_prefix(1);
    return true;
}

/// Numbers of the digits with a separator before each but the first.
template <std::size_t kCount>
std::optional<std::array<int, kCount>> takeParts(std::string_view& text, char separator,
                                                 std::array<std::size_t, kCount> digits) {
    std::array<int, kCount> parts{};
    for (std::size_t i = 0; i < kCount; ++i) {
        if (i > 0 && !take(text, separator)) {
            return std::nullopt;
        }
        const auto part = takeDigits(text, digits[i]);
        if (!part) {
            return std::nullopt;
        }
        parts[i] = *part;
    }
    return parts;
}

/// ".123" in ticks of 100 ns; 0 if there is no fraction.
UA_DateTime takeFraction(std::string_view& text) {
    if (!take(text, '.')) {
        return 0;
    }
    UA_DateTime ticks = 0;
    UA_DateTime unit = kTicksPerSecond;
    while (!text.empty() && text.front() >= '0' && text.front() <= '9') {
        unit /= 10;
        ticks += unit * (text.front() - '0');
        text.remove_prefix(1);
    }
    return ticks;
}

/// "Z" or "+01:00", the whole text; none: UTC.
std::optional<std::chrono::minutes> zoneIn(std::string_view text) {
    if (text.empty() || text == "Z") {
        return std::chrono::minutes{0};
    }
    const int sign = text.front() == '-' ? -1 : 1;
    if (text.front() != '-' && text.front() != '+') {
        return std::nullopt;
    }
    text.remove_prefix(1);
    const auto parts = takeParts<2>(text, ':', {2, 2});
    if (!parts || !text.empty()) {
        return std::nullopt;
    }
    return sign * (std::chrono::hours((*parts)[0]) + std::chrono::minutes((*parts)[1]));
}

template <typename T>
std::optional<std::string> readAs(std::string_view text, void* target) {
    const auto number = numberIn<T>(text.starts_with('+') ? text.substr(1) : text);
    if (!number) {
        return fmt::format("'{}' is no number from {} to {}", sanitise(text),
                           std::numeric_limits<T>::min(), std::numeric_limits<T>::max());
    }
    *static_cast<T*>(target) = *number;
    return std::nullopt;
}

}  // namespace

std::optional<UA_DateTime> dateTimeIn(std::string_view text) {
    text = trimmed(text);
    const auto date = takeParts<3>(text, '-', {4, 2, 2});
    if (!date || !take(text, 'T')) {
        return std::nullopt;
    }
    const auto time = takeParts<3>(text, ':', {2, 2, 2});
    const auto fraction = takeFraction(text);
    const auto zone = zoneIn(text);
    const std::chrono::year_month_day day{std::chrono::year((*date)[0]),
                                          std::chrono::month(static_cast<unsigned>((*date)[1])),
                                          std::chrono::day(static_cast<unsigned>((*date)[2]))};
    if (!time || !zone || !day.ok()) {
        return std::nullopt;
    }
    const std::chrono::seconds since_1970 =
        std::chrono::sys_days(day).time_since_epoch() + std::chrono::hours((*time)[0]) +
        std::chrono::minutes((*time)[1]) + std::chrono::seconds((*time)[2]) - *zone;
    // The earliest time of OPC UA is 1601-01-01, which is 0.
    return std::max<UA_DateTime>(
        0, UA_DATETIME_UNIX_EPOCH + since_1970.count() * kTicksPerSecond + fraction);
}

std::optional<double> doubleIn(std::string_view text) {
    text = trimmed(text);
    if (text == "INF" || text == "-INF") {
        const auto infinity = std::numeric_limits<double>::infinity();
        return text == "INF" ? infinity : -infinity;
    }
    if (text == "NaN") {
        return std::numeric_limits<double>::quiet_NaN();
    }
    return numberIn<double>(text.starts_with('+') ? text.substr(1) : text);
}

std::optional<bool> booleanIn(std::string_view text) {
    text = trimmed(text);
    if (text == "true" || text == "1") {
        return true;
    }
    return text == "false" || text == "0" ? std::optional(false) : std::nullopt;
}

std::optional<UA_Int32> enumerationIn(std::string_view text) {
    text = trimmed(text);
    const auto line = text.rfind('_');
    return numberIn<UA_Int32>(line == std::string_view::npos ? text : text.substr(line + 1));
}

std::optional<std::string> readNumber(std::string_view text, const UA_DataType& type,
                                      void* target) {
    text = trimmed(text);
    switch (type.typeKind) {
        case UA_DATATYPEKIND_SBYTE:
            return readAs<UA_SByte>(text, target);
        case UA_DATATYPEKIND_BYTE:
            return readAs<UA_Byte>(text, target);
        case UA_DATATYPEKIND_INT16:
            return readAs<UA_Int16>(text, target);
        case UA_DATATYPEKIND_UINT16:
            return readAs<UA_UInt16>(text, target);
        case UA_DATATYPEKIND_INT32:
            return readAs<UA_Int32>(text, target);
        case UA_DATATYPEKIND_UINT32:
            return readAs<UA_UInt32>(text, target);
        case UA_DATATYPEKIND_INT64:
            return readAs<UA_Int64>(text, target);
        case UA_DATATYPEKIND_UINT64:
            return readAs<UA_UInt64>(text, target);
        default:
            break;
    }
    const auto number = doubleIn(text);
    if (!number) {
        return fmt::format("'{}' is no number", sanitise(text));
    }
    if (type.typeKind == UA_DATATYPEKIND_FLOAT) {
        *static_cast<UA_Float*>(target) = static_cast<UA_Float>(*number);
    } else {
        *static_cast<UA_Double*>(target) = *number;
    }
    return std::nullopt;
}

}  // namespace metier::opcua
