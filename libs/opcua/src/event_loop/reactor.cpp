#include "reactor.hpp"

#include <asio/post.hpp>

namespace metier::opcua {

void Reactor::waitUntil(SteadyTime until, std::unique_lock<std::recursive_mutex>& lock) {
    waiting_ = true;
    while (waiting_ && std::chrono::steady_clock::now() < until) {
        arm(until);
        lock.unlock();
        try {
            io_.run_one();
        } catch (...) {
            lock.lock();
            waiting_ = false;
            throw;
        }
        lock.lock();
    }
    waiting_ = false;
}

void Reactor::wake() {
    if (waiting_) {
        asio::post(io_, guarded([] {}));
    }
}

void Reactor::arm(SteadyTime until) {
    if (armed_for_ <= until) {
        return;  // fires early, and is armed again then
    }
    armed_for_ = until;
    wake_.expires_at(until);
    wake_.async_wait([this](const asio::error_code& error) {
        if (!error) {
            armed_for_ = SteadyTime::max();
        }
    });
}

}  // namespace metier::opcua
