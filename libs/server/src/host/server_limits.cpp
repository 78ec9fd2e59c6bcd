#include "host/server_limits.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <string_view>
#include <variant>

namespace metier::server {
namespace {

using opcua::ServerLimits;
using Field = std::variant<std::uint16_t ServerLimits::*, std::uint32_t ServerLimits::*,
                           std::chrono::milliseconds ServerLimits::*>;

struct NamedField {
    std::string_view name;
    Field field;
};

constexpr std::array kFields{
    NamedField{"secure_channels", &ServerLimits::secure_channels},
    NamedField{"handshake_timeout", &ServerLimits::handshake_timeout},
    NamedField{"sessions", &ServerLimits::sessions},
    NamedField{"sessions_per_application", &ServerLimits::sessions_per_application},
    NamedField{"session_timeout", &ServerLimits::session_timeout},
    NamedField{"message_size", &ServerLimits::message_size},
    NamedField{"chunks_per_message", &ServerLimits::chunks_per_message},
    NamedField{"subscriptions", &ServerLimits::subscriptions},
    NamedField{"subscriptions_per_session", &ServerLimits::subscriptions_per_session},
    NamedField{"monitored_items", &ServerLimits::monitored_items},
    NamedField{"monitored_items_per_subscription", &ServerLimits::monitored_items_per_subscription},
    NamedField{"event_queue", &ServerLimits::event_queue},
    NamedField{"min_publishing_interval", &ServerLimits::min_publishing_interval},
    NamedField{"max_publishing_interval", &ServerLimits::max_publishing_interval},
    NamedField{"min_sampling_interval", &ServerLimits::min_sampling_interval},
    NamedField{"lifetime_count", &ServerLimits::lifetime_count},
    NamedField{"publish_requests_per_session", &ServerLimits::publish_requests_per_session},
    NamedField{"retransmission_queue", &ServerLimits::retransmission_queue},
    NamedField{"nodes_per_read", &ServerLimits::nodes_per_read},
    NamedField{"nodes_per_write", &ServerLimits::nodes_per_write},
    NamedField{"nodes_per_call", &ServerLimits::nodes_per_call},
    NamedField{"nodes_per_browse", &ServerLimits::nodes_per_browse},
    NamedField{"references_per_node", &ServerLimits::references_per_node},
};

void put(double value, std::chrono::milliseconds& field) {
    field = std::chrono::round<std::chrono::milliseconds>(std::chrono::duration<double>(value));
}

template <typename Number>
void put(double value, Number& field) {
    field = static_cast<Number>(value);
}

}  // namespace

ServerLimits limitsOf(const std::vector<cell::Limit>& limits) {
    ServerLimits result;
    for (const auto& limit : limits) {
        const auto named =
            std::find_if(kFields.begin(), kFields.end(),
                         [&](const NamedField& field) { return field.name == limit.name; });
        if (named != kFields.end()) {
            std::visit([&](auto field) { put(limit.value, result.*field); }, named->field);
        }
    }
    result.secure_channels = std::max(result.secure_channels, result.sessions);
    return result;
}

}  // namespace metier::server
