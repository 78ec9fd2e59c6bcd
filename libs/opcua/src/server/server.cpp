#include "metier/opcua/server.hpp"

#include "server/server_config.hpp"
#include "server/server_core.hpp"

namespace metier::opcua {

TimerHandle& TimerHandle::operator=(TimerHandle&& other) noexcept {
    cancel();
    cancel_ = std::exchange(other.cancel_, nullptr);
    return *this;
}

void TimerHandle::cancel() noexcept {
    if (const auto cancel = std::exchange(cancel_, nullptr)) {
        cancel();
    }
}

Result<std::unique_ptr<Server>> Server::create(ServerOptions options) {
    METIER_ASSIGN(auto core, ServerCore::create(std::move(options)));
    return std::unique_ptr<Server>(new Server(std::move(core)));
}

Server::Server(std::unique_ptr<ServerCore> core) : core_(std::move(core)) {}

Server::~Server() = default;

Result<> Server::start() {
    return core_->start();
}

void Server::stop() {
    core_->stop();
}

std::string Server::endpointUrl() const {
    const auto port = core_->port();
    return port == 0 ? std::string() : endpointUrlOf(core_->options().bind_addresses.at(0), port);
}

std::uint16_t Server::port() const {
    return core_->port();
}

void Server::post(std::function<void()> work) {
    core_->post(std::move(work));
}

TimerHandle Server::after(std::chrono::nanoseconds delay, std::function<void()> work) {
    return core_->after(delay, std::move(work));
}

void Server::onSessionClosed(std::function<void(const Session&)> handler) {
    core_->sessions().onClosed(std::move(handler));
}

void Server::audit(const OwnAct& act) {
    core_->audit().acted(act);
}

AddressSpace& Server::nodes() {
    return core_->nodes();
}

void Server::closeSessions(const std::function<bool(const Session&)>& which) {
    core_->sessions().closeIf(core_->native(), which);
}

Result<> Server::renewIdentity(const security::Identity& identity) {
    return core_->renewIdentity(identity);
}

SteadyTime Server::lastTick() const noexcept {
    return core_->lastTick();
}

ServerStatistics Server::statistics() const {
    return core_->statistics();
}

const TimeHistogram& Server::publishLatency() const noexcept {
    return core_->publishLatency();
}

bool Server::onServerThread() const noexcept {
    return core_->onServerThread();
}

}  // namespace metier::opcua
