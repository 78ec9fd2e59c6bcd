#include <arpa/inet.h>
#include <avahi-client/publish.h>
#include <avahi-common/alternative.h>
#include <avahi-common/error.h>
#include <avahi-common/malloc.h>
#include <fmt/format.h>
#include <net/if.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <utility>

#include "discovery/avahi.hpp"
#include "metier/opcua/mdns.hpp"

namespace metier::opcua {
namespace {

constexpr int kTurnMs = 100;
constexpr std::chrono::seconds kPause{5};
constexpr std::size_t kLongestName = 63;
constexpr std::uint32_t kLoopbackNet = 127;

/// One life of a service at one life of the daemon.
///
/// Threading: the announcer's thread.
class Announcement {
public:
    explicit Announcement(const MdnsService& service)
        : service_(service),
          name_(service.name.substr(0, kLongestName)),
          session_([this] { publish(); }) {}
    ~Announcement() {
        if (group_ != nullptr) {
            avahi_entry_group_free(group_);
        }
    }
    Announcement(const Announcement&) = delete;
    Announcement& operator=(const Announcement&) = delete;

    const std::string& problem() const { return session_.problem(); }
    void iterate() { session_.iterate(kTurnMs); }

private:
    void publish() {
        auto* client = session_.client();
        if (group_ == nullptr) {
            group_ = avahi_entry_group_new(client, changed, this);
        }
        const int code = group_ == nullptr ? avahi_client_errno(client) : fill();
        if (code == AVAHI_ERR_COLLISION) {
            rename();
        } else if (code != AVAHI_OK) {
            spdlog::warn("mDNS: {} is not announced: {}", name_, avahi_strerror(code));
        }
    }

    int fill() {
        avahi_entry_group_reset(group_);
        AvahiAddress address{};
        const bool literal = avahi_address_parse(service_.host.c_str(), AVAHI_PROTO_INET, &address);
        const auto interface = literal && isLoopback(address)
                                   ? static_cast<AvahiIfIndex>(::if_nametoindex("lo"))
                                   : AVAHI_IF_UNSPEC;
        auto host = service_.host;
        if (literal) {
            host = fmt::format("metier-{}-{}.local", service_.host, service_.port);
            std::replace(host.begin(), host.end() - 6, '.', '-');  // but for ".local"
            const int code =
                avahi_entry_group_add_address(group_, interface, AVAHI_PROTO_INET,
                                              AVAHI_PUBLISH_NO_REVERSE, host.c_str(), &address);
            if (code != AVAHI_OK) {
                return code;
            }
        }
        const int code = avahi_entry_group_add_service(
            group_, interface, AVAHI_PROTO_INET, AvahiPublishFlags{}, name_.c_str(), kServiceType,
            nullptr, host.c_str(), service_.port, ("path=" + service_.path).c_str(),
            ("caps=" + service_.caps).c_str(), nullptr);
        return code == AVAHI_OK ? avahi_entry_group_commit(group_) : code;
    }

    static bool isLoopback(const AvahiAddress& address) {
        return ntohl(address.data.ipv4.address) >> 24U == kLoopbackNet;
    }

    void rename() {
        char* other = avahi_alternative_service_name(name_.c_str());
        name_ = other;
        avahi_free(other);
        publish();
    }

    static void changed(AvahiEntryGroup* group, AvahiEntryGroupState state,
                        void* context) noexcept {
        auto& self = *static_cast<Announcement*>(context);
        self.group_ = group;
        if (state == AVAHI_ENTRY_GROUP_ESTABLISHED) {
            spdlog::info("mDNS: announced as {}", self.name_);
        } else if (state == AVAHI_ENTRY_GROUP_COLLISION) {
            self.rename();
        } else if (state == AVAHI_ENTRY_GROUP_FAILURE) {
            spdlog::warn("mDNS: {} is not announced", self.name_);
        }
    }

    const MdnsService& service_;
    std::string name_;
    AvahiEntryGroup* group_ = nullptr;
    AvahiSession session_;
};

void run(const MdnsService& service, const std::stop_token& stop) {
    std::mutex mutex;
    std::condition_variable_any wake;
    bool complained = false;
    while (!stop.stop_requested()) {
        {
            Announcement announcement(service);
            while (!stop.stop_requested() && announcement.problem().empty()) {
                complained = false;
                announcement.iterate();
            }
            if (!announcement.problem().empty() && !std::exchange(complained, true)) {
                spdlog::info("mDNS: no Avahi daemon ({}); {} is not announced by it",
                             announcement.problem(), service.name);
            }
        }
        std::unique_lock lock(mutex);
        wake.wait_for(lock, stop, kPause, [] { return false; });
    }
}

}  // namespace

MdnsAnnouncer::MdnsAnnouncer(MdnsService service)
    : service_(std::move(service)),
      thread_([this](const std::stop_token& stop) { run(service_, stop); }) {}

MdnsAnnouncer::~MdnsAnnouncer() = default;

}  // namespace metier::opcua
