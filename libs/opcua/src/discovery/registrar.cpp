#include "metier/opcua/registrar.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <utility>

#include "metier/opcua/text.hpp"

namespace metier::opcua {
namespace {

Registrar::Register registerWith(const std::optional<opcua::Credentials>& security) {
    return [security](const std::string& url, const opcua::ServerRegistration& server,
                      std::chrono::milliseconds timeout) {
        return opcua::registerServer(url, server, timeout, security);
    };
}

}  // namespace

Registrar::Registrar(RegistrarOptions options, Register use)
    : options_(std::move(options)),
      register_(use ? std::move(use) : registerWith(options_.security)),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

Registrar::~Registrar() = default;

void Registrar::run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        registerNow();
        std::unique_lock lock(mutex_);
        wake_.wait_for(lock, stop, registered_ ? options_.period : options_.pause,
                       [] { return false; });
    }
    leave();
}

void Registrar::registerNow() {
    const auto told = register_(options_.discovery_url, options_.server, options_.timeout);
    if (told && !registered_) {
        spdlog::info("registered at {} as {}", options_.discovery_url,
                     fmt::join(options_.server.discovery_urls, ", "));
    } else if (!told && (registered_ || !complained_)) {
        spdlog::warn("not registered at {}: {}; it is asked again", options_.discovery_url,
                     opcua::sanitise(told.error().message));
    }
    complained_ = !told;
    registered_ = told.has_value();
}

/// A discovery server that did not answer before is not waited for: it will forget by itself.
void Registrar::leave() {
    if (!registered_) {
        return;
    }
    auto server = options_.server;
    server.presence = opcua::ServerRegistration::Presence::offline;
    if (const auto told = register_(options_.discovery_url, server, options_.farewell); !told) {
        spdlog::info("{} could not be informed of the end: {}", options_.discovery_url,
                     opcua::sanitise(told.error().message));
    }
}

}  // namespace metier::opcua
