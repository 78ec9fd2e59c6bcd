#include "chain.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "openssl.hpp"

namespace metier::security {
namespace {

constexpr std::string_view kChainKey = ",\"chain\":\"";
constexpr std::string_view kEnd = "\"}";
// Peers choose their names: with this bound a line stays far shorter than the part of a log's end
// that is read.
constexpr std::size_t kLongestValue = 1'000;

std::string timeText(UtcTime time) {
    using std::chrono::floor;
    const auto whole = floor<std::chrono::seconds>(time);
    const auto rest = floor<std::chrono::milliseconds>(time - whole).count();
    return fmt::format("{:%FT%T}.{:03}Z", fmt::gmtime(std::chrono::system_clock::to_time_t(whole)),
                       rest);
}

/// Chain value of a line without its chain, which begins behind a comma.
std::string chainOf(std::string_view body, std::string_view chain_before) {
    return digestOf(fmt::format("{}\n{}", chain_before, body), EVP_sha256());
}

/// Nothing, if there is no such key or it holds no text.
std::optional<std::string> textIn(const nlohmann::ordered_json& json, std::string_view key) {
    const auto found = json.find(std::string(key));
    return found != json.end() && found->is_string() ? std::optional(found->get<std::string>())
                                                     : std::nullopt;
}

/// Position behind the text of a line, at which its chain value begins: `,"chain":"`, 64 digits,
/// `"}` and no more. Nothing if the line ends in another way.
std::optional<std::size_t> endOfBody(std::string_view text) {
    const auto tail = kChainKey.size() + kNoChain.size() + kEnd.size();
    if (text.size() < tail || !text.ends_with(kEnd) ||
        text.substr(text.size() - tail, kChainKey.size()) != kChainKey) {
        return {};
    }
    const auto digits = text.substr(text.size() - kEnd.size() - kNoChain.size(), kNoChain.size());
    const bool hexadecimal = digits.find_first_not_of("0123456789abcdef") == std::string_view::npos;
    return hexadecimal ? std::optional(text.size() - tail) : std::nullopt;
}

}  // namespace

ChainedLine chainLine(const Entry& entry, std::uint64_t number, std::string_view chain_before) {
    nlohmann::ordered_json json;
    json["n"] = number;
    json["time"] = timeText(entry.time);
    json["event"] = entry.event;
    for (const auto& [name, value] : entry.fields) {
        json[name] = value.size() > kLongestValue ? value.substr(0, kLongestValue) + "..." : value;
    }
    auto body = json.dump(-1, ' ', true, nlohmann::ordered_json::error_handler_t::replace);
    body.pop_back();  // the brace
    auto chain = chainOf(body, chain_before);
    return {fmt::format("{}{}{}{}", body, kChainKey, chain, kEnd), std::move(chain)};
}

std::optional<ReadLine> readLastLine(std::string_view text) {
    const auto end = endOfBody(text);
    if (!end) {
        return {};
    }
    // Without the chain value: among members of one name the last would be taken.
    const auto json =
        nlohmann::ordered_json::parse(fmt::format("{}}}", text.substr(0, *end)), nullptr, false);
    if (!json.is_object() || !json.contains("n") || !json["n"].is_number_unsigned() ||
        json.contains("chain")) {
        return {};
    }
    const auto time = textIn(json, "time");
    if (!time) {
        return {};
    }
    ReadLine line{json["n"].get<std::uint64_t>(),
                  *time,
                  std::string(text.substr(*end + kChainKey.size(), kNoChain.size())),
                  {}};
    if (textIn(json, "event") == kContinued) {
        line.after = textIn(json, kAfter).value_or("");
    }
    return line;
}

std::optional<ReadLine> readLine(std::string_view text, std::string_view chain_before) {
    auto line = readLastLine(text);
    const bool right =
        line && line->chain == chainOf(text.substr(0, *endOfBody(text)), chain_before);
    return right ? line : std::nullopt;
}

}  // namespace metier::security
