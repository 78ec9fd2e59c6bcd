#include <avahi-client/lookup.h>
#include <avahi-common/address.h>
#include <avahi-common/malloc.h>
#include <avahi-common/strlst.h>
#include <fmt/format.h>

#include <array>
#include <utility>

#include "discovery/avahi.hpp"
#include "metier/opcua/mdns.hpp"
#include "metier/opcua/text.hpp"

namespace metier::opcua {
namespace {

constexpr int kBrowseTurnMs = 50;
constexpr std::size_t kMostServers = 1'000;

/// The value of a TXT record, if it is one that an address can end in.
std::string pathFrom(AvahiStringList* txt) {
    auto* entry = avahi_string_list_find(txt, "path");
    char* value = nullptr;
    if (entry == nullptr || avahi_string_list_get_pair(entry, nullptr, &value, nullptr) != 0) {
        return {};
    }
    std::string path = value == nullptr ? "" : value;
    avahi_free(value);
    const bool plain = path.starts_with('/') && path.size() > 1 && opcua::sanitise(path) == path;
    return plain ? path : std::string();
}

/// Collects the services that the daemon reports, until it has no more for now.
///
/// Threading: one thread.
class Browse {
public:
    Browse() {
        auto* client = session_.client();
        if (client != nullptr && session_.problem().empty()) {
            browser_ =
                avahi_service_browser_new(client, AVAHI_IF_UNSPEC, AVAHI_PROTO_INET, kServiceType,
                                          nullptr, AvahiLookupFlags{}, browsed, this);
        }
    }
    Browse(const Browse&) = delete;
    Browse& operator=(const Browse&) = delete;

    Result<std::vector<FoundServer>> take(std::chrono::steady_clock::time_point deadline) {
        while (browser_ != nullptr && session_.problem().empty() && (!reported_all_ || open_ > 0) &&
               std::chrono::steady_clock::now() < deadline) {
            session_.iterate(kBrowseTurnMs);
        }
        if (browser_ == nullptr || !session_.problem().empty()) {
            return fail(Errc::not_found, "no Avahi daemon: " + session_.problem());
        }
        return std::move(servers_);
    }

private:
    static void browsed(AvahiServiceBrowser* /*browser*/, AvahiIfIndex interface,
                        AvahiProtocol protocol, AvahiBrowserEvent event, const char* name,
                        const char* type, const char* domain, AvahiLookupResultFlags /*flags*/,
                        void* context) noexcept {
        auto& self = *static_cast<Browse*>(context);
        if (event == AVAHI_BROWSER_NEW && self.servers_.size() + self.open_ < kMostServers) {
            const auto* resolver = avahi_service_resolver_new(
                self.session_.client(), interface, protocol, name, type, domain, AVAHI_PROTO_INET,
                AvahiLookupFlags{}, resolved, context);
            self.open_ += resolver != nullptr ? 1 : 0;
        } else if (event == AVAHI_BROWSER_ALL_FOR_NOW || event == AVAHI_BROWSER_FAILURE) {
            self.reported_all_ = true;
        }
    }

    static void resolved(AvahiServiceResolver* resolver, AvahiIfIndex /*interface*/,
                         AvahiProtocol /*protocol*/, AvahiResolverEvent event, const char* name,
                         const char* /*type*/, const char* /*domain*/, const char* /*host*/,
                         const AvahiAddress* address, std::uint16_t port, AvahiStringList* txt,
                         AvahiLookupResultFlags /*flags*/, void* context) noexcept {
        auto& self = *static_cast<Browse*>(context);
        --self.open_;
        if (event == AVAHI_RESOLVER_FOUND) {
            std::array<char, AVAHI_ADDRESS_STR_MAX> text{};
            avahi_address_snprint(text.data(), text.size(), address);
            merge(self.servers_,
                  {{fmt::format("{}{}:{}{}", kAddressScheme, text.data(), port, pathFrom(txt)),
                    opcua::sanitise(name), "mDNS"}});
        }
        avahi_service_resolver_free(resolver);
    }

    std::vector<FoundServer> servers_;
    std::size_t open_ = 0;  // resolvers at work
    bool reported_all_ = false;
    AvahiServiceBrowser* browser_ = nullptr;  // the session's
    AvahiSession session_;
};

}  // namespace

Result<std::vector<FoundServer>> browseMdns(std::chrono::milliseconds longest) {
    Browse browse;
    return browse.take(std::chrono::steady_clock::now() + longest);
}

}  // namespace metier::opcua
