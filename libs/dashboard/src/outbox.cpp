#include "outbox.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

namespace metier::dashboard {

std::string dump(const nlohmann::json& value) {
    return value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

Message makeMessage(std::string_view event, const nlohmann::json& data) {
    return std::make_shared<const std::string>(
        fmt::format("event: {}\ndata: {}\n\n", event, dump(data)));
}

void Outbox::push(Message message) {
    {
        const std::lock_guard lock(mutex_);
        if (closed_) {
            return;
        }
        bytes_ += message->size();
        waiting_.push_back(std::move(message));
        if (bytes_ > most_bytes_) {
            waiting_.clear();
            closed_ = true;
        }
    }
    changed_.notify_one();
}

std::vector<Message> Outbox::take(SteadyTime deadline) {
    std::unique_lock lock(mutex_);
    changed_.wait_until(lock, deadline, [this] { return closed_ || !waiting_.empty(); });
    bytes_ = 0;
    return std::exchange(waiting_, {});
}

void Outbox::close() {
    {
        const std::lock_guard lock(mutex_);
        closed_ = true;
    }
    changed_.notify_all();
}

bool Outbox::isClosed() const {
    const std::lock_guard lock(mutex_);
    return closed_;
}

}  // namespace metier::dashboard
