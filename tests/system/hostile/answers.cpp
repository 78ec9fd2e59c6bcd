#include "answers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>

namespace metier::hostile {

namespace {

constexpr std::uint32_t kAddNodesResponse = 491;
constexpr std::array<std::uint32_t, 4> kManagement{kAddNodesResponse, 497, 503, 509};
constexpr std::array<std::uint32_t, 2> kDiscovery{425, 431};
constexpr std::uint32_t kBrowseResponse = 530;
constexpr std::uint32_t kCreateItemsResponse = 754;
constexpr std::uint32_t kCreateSubscriptionResponse = 790;
constexpr std::uint32_t kBad = 0x8000'0000;

bool isOneOf(std::span<const std::uint32_t> types, std::uint32_t type) {
    return std::find(types.begin(), types.end(), type) != types.end();
}

void learnItems(Reader& content, Known& known) {
    constexpr std::size_t revised = 12;
    for (auto items = content.number<std::int32_t>(); items > 0 && content.ok(); --items) {
        const auto status = content.number<std::uint32_t>();
        const auto id = content.number<std::uint32_t>();
        content.raw(revised);
        content.skipExtension();
        if (status == 0) {
            known.items.push_back(id);
        }
    }
}

}  // namespace

void learn(std::uint32_t type, Reader& content, Known& known) {
    if (type == kCreateSubscriptionResponse) {
        known.subscriptions.push_back(content.number<std::uint32_t>());
    } else if (type == kCreateItemsResponse) {
        learnItems(content, known);
    } else if (type == kBrowseResponse && content.number<std::int32_t>() > 0) {
        content.number<std::uint32_t>();
        if (const auto point = content.text(); !point.empty()) {
            known.continuation_point = point;
        }
    }
}

std::string permitted(std::uint32_t type, std::uint32_t result, std::string_view content) {
    if (result != 0 || !isOneOf(kManagement, type)) {
        return {};
    }
    Reader reader(content);
    for (auto results = reader.number<std::int32_t>(); results > 0 && reader.ok(); --results) {
        const auto status = reader.number<std::uint32_t>();
        if (reader.ok() && status < kBad) {
            return fmt::format("a client changed the address space (answer of type {})", type);
        }
        if (type == kAddNodesResponse) {
            reader.id();
        }
    }
    return {};
}

std::string givenAway(std::uint32_t type, std::uint32_t result) {
    return result == 0 && type != kServiceFault && !isOneOf(kDiscovery, type)
               ? fmt::format("a closed server served a stranger (answer of type {})", type)
               : "";
}

}  // namespace metier::hostile
