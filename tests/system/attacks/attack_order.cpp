#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "attack.hpp"

namespace metier::system_tests {
namespace {

constexpr std::array<std::string_view, kAttacks.size()> kNames{
    "deaf",   "subscriber", "item_bomb", "chunks",   "sessions",
    "events", "requests",   "costly",    "half_open"};
constexpr std::size_t kFixed = 6;  // arguments before the skills

std::string hexOf(std::string_view bytes) {
    std::string text;
    for (const char byte : bytes) {
        text += fmt::format("{:02x}", static_cast<unsigned char>(byte));
    }
    return text.empty() ? "-" : text;
}

std::string bytesOf(const std::string& hex) {
    std::string bytes;
    for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
        bytes += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
    }
    return bytes;
}

}  // namespace

std::string_view toString(Attack attack) {
    return kNames.at(static_cast<std::size_t>(attack));
}

std::vector<std::string> argumentsOf(const AttackOrder& order) {
    std::vector<std::string> arguments{
        std::string(toString(order.attack)), order.host,
        std::to_string(order.port),          std::to_string(order.time.count()),
        std::to_string(order.name_space),    hexOf(order.stranger)};
    arguments.insert(arguments.end(), order.skills.begin(), order.skills.end());
    return arguments;
}

AttackOrder attackOrderFrom(const std::vector<std::string>& arguments) {
    const auto name = std::find(kNames.begin(), kNames.end(), arguments.at(0));
    if (arguments.size() < kFixed || name == kNames.end()) {
        throw std::invalid_argument("ATTACK HOST PORT SECONDS NAMESPACE STRANGER SKILL...");
    }
    AttackOrder order;
    order.attack = kAttacks.at(static_cast<std::size_t>(name - kNames.begin()));
    order.host = arguments[1];
    order.port = static_cast<std::uint16_t>(std::stoul(arguments[2]));
    order.time = std::chrono::seconds(std::stol(arguments[3]));
    order.name_space = static_cast<std::uint16_t>(std::stoul(arguments[4]));
    order.stranger = bytesOf(arguments[5]);
    order.skills.assign(arguments.begin() + kFixed, arguments.end());
    return order;
}

}  // namespace metier::system_tests
