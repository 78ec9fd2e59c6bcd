#include <fmt/format.h>

#include "cell_reading.hpp"
#include "metier/base/text.hpp"

namespace metier::cell {
namespace {

constexpr double kMostDays = 36'500.0;
constexpr double kMostMegabytes = 1e9;

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

}  // namespace

Records readRecords(const TomlTable& cell, const std::filesystem::path& folder) {
    Records records;
    if (!cell.has("records")) {
        return records;
    }
    const auto table = cell.table("records");
    records.url = absoluteUrl(table.textOr("url", ""), folder);
    records.keep_days = numberWithin(table, "keep_days", records.keep_days, {0, kMostDays});
    records.keep_megabytes =
        numberWithin(table, "keep_megabytes", records.keep_megabytes, {0, kMostMegabytes});
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
    const auto number = numberIn<std::uint16_t>(port);
    if (address.host.empty() || !number) {
        return fail(Errc::invalid_argument,
                    fmt::format("\"{}\" is not ADDRESS:PORT or PORT, of 0 to 65535", text));
    }
    address.port = *number;
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
