#include <fmt/format.h>

#include <charconv>
#include <utility>

#include "cell_reading.hpp"

namespace metier::cell {
namespace {

constexpr double kMostDays = 36'500.0;
constexpr double kMostMegabytes = 1e9;
constexpr std::uint32_t kMostPort = 65'535;

bool isUrl(const std::string& text) {
    return text == "off" || text.starts_with("postgresql://") || text.starts_with("postgres://");
}

std::string absoluteUrl(const std::string& text, const std::filesystem::path& folder) {
    constexpr std::string_view kSqlite = "sqlite:";
    if (text.empty() || isUrl(text)) {
        return text;
    }
    const auto file = text.starts_with(kSqlite) ? text.substr(kSqlite.size()) : text;
    return std::filesystem::absolute(folder / file).lexically_normal().string();
}

double within(const TomlTable& table, std::string_view key, double preset, double most) {
    const double value = table.numberOr(key, preset);
    if (!(value >= 0 && value <= most)) {
        table.reject(key, fmt::format("{} is not within 0 to {}", value, most));
    }
    return value;
}

}  // namespace

Records readRecords(const TomlTable& cell, const std::filesystem::path& folder) {
    Records records;
    if (!cell.has("records")) {
        return records;
    }
    const auto table = cell.table("records");
    records.url = absoluteUrl(table.textOr("url", ""), folder);
    records.keep_days = within(table, "keep_days", records.keep_days, kMostDays);
    records.keep_megabytes =
        within(table, "keep_megabytes", records.keep_megabytes, kMostMegabytes);
    return records;
}

Result<HttpAddress> parseHttpAddress(std::string_view text) {
    HttpAddress address;
    const auto colon = text.rfind(':');
    const auto port = colon == std::string_view::npos ? text : text.substr(colon + 1);
    if (colon != std::string_view::npos) {
        auto host = text.substr(0, colon);
        if (host.starts_with('[') && host.ends_with(']')) {
            host = host.substr(1, host.size() - 2);
        }
        address.host = host;
    }
    std::uint32_t number = 0;
    const auto* const end = port.data() + port.size();
    const auto read = std::from_chars(port.data(), end, number);
    if (address.host.empty() || port.empty() || read.ec != std::errc() || read.ptr != end ||
        number > kMostPort) {
        return fail(Errc::invalid_argument,
                    fmt::format("\"{}\" is not ADDRESS:PORT or PORT, of 0 to {}", text, kMostPort));
    }
    address.port = static_cast<std::uint16_t>(number);
    return address;
}

std::optional<HttpAddress> readMetrics(const TomlTable& table) {
    if (!table.has("metrics")) {
        return std::nullopt;
    }
    const auto address = parseHttpAddress(table.text("metrics"));
    if (!address) {
        table.reject("metrics", address.error().message);
        return std::nullopt;
    }
    return *address;
}

}  // namespace metier::cell
