#include "event_loop.hpp"

#include <utility>

#include "loop.hpp"

namespace metier::opcua {

AsioEventLoop::AsioEventLoop(EventLoopOptions options) : loop_(std::make_unique<Loop>(options)) {}

AsioEventLoop::~AsioEventLoop() = default;

UA_EventLoop* AsioEventLoop::handle() noexcept {
    return loop_->handle();
}

void AsioEventLoop::post(std::function<void()> work) {
    loop_->post(std::move(work));
}

Result<> AsioEventLoop::runOnce(std::chrono::milliseconds timeout) {
    const auto status = loop_->run(timeout);
    if (status == UA_STATUSCODE_GOOD) {
        return {};
    }
    return fail(Errc::internal, std::string("the event loop: ") + UA_StatusCode_name(status));
}

ConnectionId AsioEventLoop::currentConnection() const noexcept {
    return loop_->tcp().currentAccepted();
}

void AsioEventLoop::vouchFor(ConnectionId connection) {
    const auto held = loop_->lock();
    loop_->tcp().vouchFor(connection);
}

void AsioEventLoop::admit(ConnectionId connection) {
    const auto held = loop_->lock();
    loop_->tcp().admit(connection);
}

void AsioEventLoop::dismiss(ConnectionId connection) {
    const auto held = loop_->lock();
    loop_->tcp().dismiss(connection);
}

std::chrono::nanoseconds AsioEventLoop::workOnTurn() const {
    return loop_->tcp().workOnTurn();
}

void AsioEventLoop::flushPublishing(std::span<const ConnectionId> connections) {
    const auto held = loop_->lock();
    loop_->flushPublishing(connections);
}

void AsioEventLoop::dropOpened() {
    const auto held = loop_->lock();
    loop_->tcp().dropOpened();
}

const TimeHistogram& AsioEventLoop::publishLatency() const noexcept {
    return loop_->publishLatency();
}

EventLoopStatistics AsioEventLoop::statistics() const {
    const auto held = loop_->lock();
    return loop_->statistics();
}

std::vector<ListenAddress> AsioEventLoop::listening() const {
    const auto held = loop_->lock();
    return loop_->tcp().listening();
}

std::string AsioEventLoop::lastNetworkError() const {
    const auto held = loop_->lock();
    return loop_->tcp().lastError();
}

SteadyTime AsioEventLoop::lastIteration() const noexcept {
    return loop_->lastIteration();
}

}  // namespace metier::opcua
