#include "cell_reading.hpp"

#include <fmt/format.h>

#include <utility>

namespace metier::cell {
namespace {

// Between registrations [s]. A discovery server may forget who is silent for ten minutes.
constexpr double kShortestPeriod = 0.2;
constexpr double kLongestPeriod = 300.0;

std::filesystem::path checkedFile(const TomlTable& table, std::string_view key,
                                  const std::filesystem::path& file) {
    auto path = std::filesystem::absolute(file).lexically_normal();
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) {
        table.reject(key, fmt::format("no such file: {}", path.string()));
    }
    return path;
}

}  // namespace

bool isAddress(const std::string& server) {
    return server.starts_with("opc.tcp://");
}

std::filesystem::path pathIn(const TomlTable& table, std::string_view key,
                             const std::filesystem::path& folder) {
    const auto text = table.text(key);
    return text.empty() ? std::filesystem::path() : checkedFile(table, key, folder / text);
}

std::vector<std::filesystem::path> readFiles(const TomlTable& table, const char* key,
                                             const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files;
    for (const auto& file : table.texts(key)) {
        files.push_back(checkedFile(table, key, folder / file));
    }
    if (files.empty()) {
        table.reject(key, "needs at least one file");
    }
    return files;
}

double numberWithin(const TomlTable& table, std::string_view key, double preset,
                    const Bounds& bounds) {
    const double value = table.numberOr(key, preset);
    if (!(value >= bounds.least && value <= bounds.most)) {
        table.reject(key, fmt::format("{} is not within {} to {}{}{}", value, bounds.least,
                                      bounds.most, bounds.unit.empty() ? "" : " ", bounds.unit));
    }
    return value;
}

UsedServer usedServer(const std::string& server) {
    return {server, isAddress(server) ? server : ""};
}

std::vector<std::string> textOrTexts(const TomlTable& table, std::string_view key) {
    const auto value = table.value(key);
    if (const auto text = value ? value->text() : std::nullopt) {
        return {*text};
    }
    return table.texts(key);
}

Discovery readDiscovery(const TomlTable& table, Discovery preset) {
    auto discovery = std::move(preset);
    if (table.has("discovery")) {
        discovery.servers = textOrTexts(table, "discovery");
    }
    for (const auto& server : discovery.servers) {
        if (!isAddress(server)) {
            table.reject("discovery", fmt::format("\"{}\" is no opc.tcp:// address", server));
        }
    }
    discovery.period = numberWithin(table, "discovery_period", discovery.period,
                                    {kShortestPeriod, kLongestPeriod, "s"});
    discovery.mdns = table.flagOr("mdns", discovery.mdns);
    discovery.announce_as = table.textOr("announce_as", discovery.announce_as);
    if (discovery.announce_as.find_first_of(":/ ") != std::string::npos) {
        table.reject("announce_as", fmt::format("\"{}\" is not a name or IPv4 address of a host",
                                                discovery.announce_as));
    }
    return discovery;
}

}  // namespace metier::cell
