#include "metier/device/notifier.hpp"

#include <utility>

namespace metier::device {

Notifier::Notifier(std::function<void()> handler) : handler_(std::move(handler)) {
    sem_init(&wake_, 0, 0);
    thread_ = std::jthread([this] { run(); });
}

Notifier::~Notifier() {
    ending_.store(true);
    sem_post(&wake_);
    thread_.join();
    sem_destroy(&wake_);
}

void Notifier::signal() noexcept {
    if (!pending_.exchange(true)) {
        sem_post(&wake_);
    }
}

void Notifier::run() {
    bool last = false;
    while (!last) {
        while (sem_wait(&wake_) != 0) {  // a signal of the system interrupted it
        }
        last = ending_.load();
        if (pending_.exchange(false)) {
            handler_();
        }
    }
}

}  // namespace metier::device
