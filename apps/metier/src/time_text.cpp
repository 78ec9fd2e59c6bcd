#include "time_text.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <optional>

namespace metier::app {
namespace {

using Seconds = std::chrono::duration<double>;

UtcTime::duration toDuration(double seconds) {
    return std::chrono::duration_cast<UtcTime::duration>(Seconds(seconds));
}

/// A number of so many digits, followed by `end`; takes both off the text.
std::optional<int> takeNumber(std::string_view& text, std::size_t digits, char end) {
    int number = 0;
    const auto* last = text.data() + digits;
    if (text.size() < digits || std::from_chars(text.data(), last, number).ptr != last ||
        number < 0 || (text.size() > digits && text[digits] != end)) {
        return std::nullopt;
    }
    text.remove_prefix(std::min(text.size(), digits + 1));
    return number;
}

constexpr double kLongestAgo = 36'500 * 86'400.0;  // [s]
// Years whose times a UtcTime holds.
constexpr int kFirstYear = 1970;
constexpr int kLastYear = 2261;

/// "30m" and the like.
std::optional<double> ago(std::string_view text) {
    constexpr std::array kUnits{std::pair{'s', 1.0}, std::pair{'m', 60.0}, std::pair{'h', 3600.0},
                                std::pair{'d', 86'400.0}};
    double number = 0;
    const auto* end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, number);
    if (read.ec != std::errc() || read.ptr + 1 != end || !(number >= 0)) {
        return std::nullopt;
    }
    for (const auto& [unit, seconds] : kUnits) {
        if (*read.ptr == unit && number * seconds <= kLongestAgo) {
            return number * seconds;
        }
    }
    return std::nullopt;
}

/// "2026-11-22"; takes it off the text.
std::optional<std::chrono::year_month_day> takeDay(std::string_view& text) {
    const auto year = takeNumber(text, 4, '-');
    const auto month = year ? takeNumber(text, 2, '-') : std::nullopt;
    const auto day = month ? takeNumber(text, 2, 'T') : std::nullopt;
    if (!day) {
        return std::nullopt;
    }
    const std::chrono::year_month_day date{std::chrono::year(*year),
                                           std::chrono::month(static_cast<unsigned>(*month)),
                                           std::chrono::day(static_cast<unsigned>(*day))};
    return date.ok() ? std::optional(date) : std::nullopt;
}

/// [s] of "09:30" or "09:30:05.5".
std::optional<double> secondsOfDay(std::string_view text) {
    const auto hour = takeNumber(text, 2, ':');
    const auto minute = hour ? takeNumber(text, 2, ':') : std::nullopt;
    if (!minute || *hour > 23 || *minute > 59) {
        return std::nullopt;
    }
    double seconds = 0;
    const auto* end = text.data() + text.size();
    if (!text.empty() && (std::from_chars(text.data(), end, seconds).ptr != end || seconds < 0 ||
                          seconds >= 60 || std::isnan(seconds))) {
        return std::nullopt;
    }
    return 3600.0 * *hour + 60.0 * *minute + seconds;
}

}  // namespace

Result<UtcTime> parseTime(std::string_view text, UtcTime now) {
    if (const auto seconds = ago(text)) {
        return now - toDuration(*seconds);
    }
    constexpr std::size_t kDay = 10;  // "2026-11-22"
    auto rest = text.substr(0, text.size() - (text.ends_with('Z') ? 1 : 0));
    const bool has_time = rest.size() > kDay;
    const auto day = takeDay(rest);
    const auto seconds = has_time ? secondsOfDay(rest) : std::optional(0.0);
    if (!day || !seconds) {
        return fail(Errc::invalid_argument,
                    fmt::format("'{}' is no time as 2026-11-22T09:30 (UTC), 30m, 8h or 7d", text));
    }
    if (day->year() < std::chrono::year(kFirstYear) || day->year() > std::chrono::year(kLastYear)) {
        return fail(Errc::invalid_argument,
                    fmt::format("'{}' is not in the years {} to {}", text, kFirstYear, kLastYear));
    }
    return UtcTime(std::chrono::sys_days(*day)) + toDuration(*seconds);
}

}  // namespace metier::app
