#include "metier/cell/limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "cell_reading.hpp"

namespace metier::cell {
namespace {

constexpr std::string_view kByte = "byte";
constexpr std::string_view kSecond = "s";
constexpr double kMany = 10'000;
constexpr double kMillion = 1'000'000;

// The least interval is what the stack can do, the least message what OPC 10000-6 asks of a buffer.
constexpr std::array kLimits{
    LimitKind{"secure_channels", "connections", 1, kMany, true},
    LimitKind{"handshake_timeout", kSecond, 1, 60, false},
    LimitKind{"sessions", "sessions", 1, kMany, true},
    LimitKind{"sessions_per_application", "sessions", 1, kMany, true},
    LimitKind{"session_timeout", kSecond, 2, 3600, false},
    LimitKind{"message_size", kByte, 8192, 16 * 1024 * 1024, true},
    LimitKind{"chunks_per_message", "chunks", 1, kMany, true},
    LimitKind{"subscriptions", "subscriptions", 1, kMany, true},
    LimitKind{"subscriptions_per_session", "subscriptions", 1, kMany, true},
    LimitKind{"monitored_items", "items", 1, kMillion, true},
    LimitKind{"monitored_items_per_subscription", "items", 1, kMillion, true},
    LimitKind{"event_queue", "events", 1, kMillion, true},
    LimitKind{"min_publishing_interval", kSecond, 0.005, 10, false},
    LimitKind{"max_publishing_interval", kSecond, 0.005, 60, false},
    LimitKind{"min_sampling_interval", kSecond, 0.005, 10, false},
    LimitKind{"lifetime_count", "publishing intervals", 3, kMany, true},
    LimitKind{"publish_requests_per_session", "requests", 1, 1000, true},
    LimitKind{"retransmission_queue", "messages", 1, 1000, true},
    LimitKind{"nodes_per_read", "nodes", 1, kMany, true},
    LimitKind{"nodes_per_write", "nodes", 1, kMany, true},
    LimitKind{"nodes_per_call", "methods", 1, kMany, true},
    LimitKind{"nodes_per_browse", "nodes", 1, kMany, true},
    LimitKind{"references_per_node", "references", 1, kMany, true},
};

std::optional<double> valueOf(const std::vector<Limit>& limits, std::string_view name) {
    const auto found = std::find_if(limits.begin(), limits.end(),
                                    [&](const Limit& limit) { return limit.name == name; });
    return found == limits.end() ? std::nullopt : std::optional(found->value);
}

void readLimit(const TomlTable& table, const LimitKind& kind, std::vector<Limit>& limits) {
    if (!table.has(kind.name)) {
        return;
    }
    const auto value = table.value(kind.name);
    const auto number = kind.whole && value->integer()
                            ? std::optional(static_cast<double>(*value->integer()))
                            : (kind.whole ? std::nullopt : value->number());
    if (!number) {
        table.reject(kind.name, fmt::format("is not a {} ({})",
                                            kind.whole ? "whole number" : "number", kind.unit));
    } else if (!(*number >= kind.least && *number <= kind.most)) {
        table.reject(kind.name, fmt::format("{} is not within {} to {} {}", *number, kind.least,
                                            kind.most, kind.unit));
    } else {
        limits.push_back({std::string(kind.name), *number});
    }
}

/// Checks two limits: if both are set, the first may not exceed the second.
void checkOrder(const TomlTable& table, const std::vector<Limit>& limits, std::string_view low,
                std::string_view high) {
    const auto lower = valueOf(limits, low);
    const auto upper = valueOf(limits, high);
    if (lower && upper && *lower > *upper) {
        table.reject(low, fmt::format("{} is over {}, which is {}", *lower, high, *upper));
    }
}

}  // namespace

std::span<const LimitKind> limitKinds() noexcept {
    return kLimits;
}

std::vector<Limit> readLimits(const TomlTable& table) {
    std::vector<Limit> limits;
    for (const auto& kind : kLimits) {
        readLimit(table, kind, limits);
    }
    checkOrder(table, limits, "sessions", "secure_channels");
    checkOrder(table, limits, "min_publishing_interval", "max_publishing_interval");
    return limits;
}

}  // namespace metier::cell
