#include "discovery/avahi.hpp"

#include <avahi-common/error.h>

#include <new>
#include <utility>

namespace metier::opcua {

AvahiSession::AvahiSession(std::function<void()> on_running)
    : poll_(avahi_simple_poll_new()), on_running_(std::move(on_running)) {
    if (!poll_) {
        throw std::bad_alloc();
    }
    int error = 0;
    auto* client = avahi_client_new(avahi_simple_poll_get(poll_.get()), AvahiClientFlags{}, changed,
                                    this, &error);
    client_ = client;
    if (client == nullptr) {
        problem_ = avahi_strerror(error);
    }
}

AvahiSession::~AvahiSession() {
    if (client_ != nullptr) {
        avahi_client_free(client_);
    }
}

void AvahiSession::iterate(int longest_ms) {
    if (problem_.empty() && avahi_simple_poll_iterate(poll_.get(), longest_ms) != 0) {
        problem_ = "the connection to D-Bus failed";
    }
}

void AvahiSession::changed(AvahiClient* client, AvahiClientState state, void* context) noexcept {
    static_cast<AvahiSession*>(context)->took(client, state);
}

/// May be called while the client is being made.
void AvahiSession::took(AvahiClient* client, AvahiClientState state) {
    client_ = client;
    if (state == AVAHI_CLIENT_FAILURE) {
        problem_ = avahi_strerror(avahi_client_errno(client));
    } else if (state == AVAHI_CLIENT_S_RUNNING && on_running_) {
        on_running_();
    }
}

}  // namespace metier::opcua
