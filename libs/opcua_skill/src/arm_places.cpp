#include "metier/opcua_skill/arm_places.hpp"

#include <fmt/format.h>

namespace metier::opcua_skill {

std::vector<opcua::KeyValue> pairsOf(const skill::ArmPositions& arms, std::string_view key) {
    std::vector<opcua::KeyValue> pairs;
    for (const auto& [server, place] : arms) {
        auto name = server.empty() ? std::string(key) : fmt::format("{}@{}", key, server);
        pairs.push_back({{0, std::move(name)}, opcua::Value::of(place)});
    }
    return pairs;
}

std::optional<std::string> armIn(std::string_view name, std::string_view key) {
    if (!name.starts_with(key)) {
        return std::nullopt;
    }
    name.remove_prefix(key.size());
    if (name.empty()) {
        return std::string();
    }
    return name.front() == '@' ? std::optional(std::string(name.substr(1))) : std::nullopt;
}

}  // namespace metier::opcua_skill
