#include "metier/opcua/search.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <thread>
#include <tuple>
#include <utility>

#include "metier/opcua/discovery.hpp"
#include "metier/opcua/mdns.hpp"
#include "metier/opcua/text.hpp"

namespace metier::opcua {
namespace {

constexpr std::size_t kMostFound = 1'000;
constexpr std::size_t kLongestUrl = 1'024;

/// The first address that a client of ours can use.
std::optional<std::string> usableUrl(const opcua::ServerDescription& server) {
    for (const auto& url : server.discovery_urls) {
        if (url.starts_with("opc.tcp://") && url.size() <= kLongestUrl &&
            opcua::sanitise(url) == url) {
            return url;
        }
    }
    return std::nullopt;
}

std::vector<FoundServer> fromAnswer(const std::string& reported_by,
                                    const std::vector<opcua::ServerDescription>& answer) {
    std::vector<FoundServer> servers;
    for (const auto& server : answer) {
        auto url = usableUrl(server);
        if (url && server.type != opcua::ApplicationType::discovery_server &&
            server.type != opcua::ApplicationType::client && servers.size() < kMostFound) {
            servers.push_back(
                {std::move(*url), opcua::sanitise(server.application_name.text), reported_by});
        }
    }
    return servers;
}

}  // namespace

void merge(std::vector<FoundServer>& servers, std::vector<FoundServer> more) {
    for (auto& server : more) {
        if (std::none_of(servers.begin(), servers.end(),
                         [&](const FoundServer& known) { return known.url == server.url; })) {
            servers.push_back(std::move(server));
        }
    }
    std::sort(servers.begin(), servers.end(), [](const auto& left, const auto& right) {
        return std::tie(left.name, left.url) < std::tie(right.name, right.url);
    });
}

Sighting askDiscoveryServers(const std::vector<std::string>& urls,
                             std::chrono::milliseconds timeout) {
    std::vector<opcua::Answer<std::vector<opcua::ServerDescription>>> answers(urls.size());
    {
        std::vector<std::jthread> threads;
        for (std::size_t i = 0; i < urls.size(); ++i) {
            threads.emplace_back([&, i] { answers[i] = opcua::findServers(urls[i], timeout); });
        }
    }
    Sighting sighting;
    for (std::size_t i = 0; i < urls.size(); ++i) {
        if (answers[i]) {
            merge(sighting.servers, fromAnswer(urls[i], *answers[i]));
        } else {
            sighting.problems.push_back({answers[i].error().code,
                                         fmt::format("discovery server {}: {}", urls[i],
                                                     opcua::sanitise(answers[i].error().message))});
        }
    }
    return sighting;
}

Sighting searchServers(const std::vector<std::string>& discovery_urls, Mdns mdns) {
    std::vector<FoundServer> announced;
    std::jthread browser;
    if (mdns == Mdns::asked) {
        browser = std::jthread([&announced] {
            if (auto found = browseMdns()) {
                announced = std::move(*found);
            } else {
                spdlog::info("mDNS: {}", found.error().message);
            }
        });
    }
    auto sighting = askDiscoveryServers(discovery_urls);
    if (browser.joinable()) {
        browser.join();
    }
    merge(sighting.servers, std::move(announced));
    return sighting;
}

}  // namespace metier::opcua
