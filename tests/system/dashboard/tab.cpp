#include "tab.hpp"

#include <fmt/format.h>
#include <httplib.h>

#include <stdexcept>
#include <utility>

#include "../metier_program.hpp"

namespace metier::system_tests {

using nlohmann::json;

namespace {

constexpr int kSeconds = 60;

httplib::Client clientOf(const std::string& url) {
    httplib::Client client(url);
    client.set_read_timeout(kSeconds);
    return client;
}

httplib::Headers headersOf(const std::string& cookie) {
    httplib::Headers headers{{"X-Metier", "1"}};
    if (!cookie.empty()) {
        headers.emplace("Cookie", cookie);
    }
    return headers;
}

PageAnswer answerOf(const httplib::Result& result) {
    if (!result) {
        return {};
    }
    const auto cookie = result->get_header_value("Set-Cookie");
    return {result->status, json::parse(result->body, nullptr, false),
            cookie.substr(0, cookie.find(';'))};
}

}  // namespace

std::string PageAnswer::error() const {
    return body.is_object() && body.contains("error")
               ? body.at("error").at("message").get<std::string>()
               : "";
}

PageAnswer askPage(const std::string& url, const std::string& path, const std::string& cookie) {
    return answerOf(clientOf(url).Get(path, headersOf(cookie)));
}

PageAnswer tellPage(const std::string& url, const std::string& path, const json& body,
                    const std::string& cookie) {
    return answerOf(clientOf(url).Post(path, headersOf(cookie), body.dump(), "application/json"));
}

Tab::Tab(std::string url, std::string cookie)
    : url_(std::move(url)),
      cookie_(std::move(cookie)),
      stream_(std::make_unique<httplib::Client>(url_)),
      reader_([this] { read(); }) {
    id_ = await("hello", [](const json&) { return true; }).at("tab").get<std::string>();
}

Tab::~Tab() {
    stream_->stop();
}

void Tab::read() {
    stream_->set_read_timeout(kSeconds);
    stream_->Get("/api/stream", headersOf(cookie_), [this](const char* bytes, std::size_t size) {
        take({bytes, size});
        return true;
    });
    const std::lock_guard lock(mutex_);
    ended_ = true;
    came_.notify_all();
}

void Tab::take(std::string_view text) {
    const std::lock_guard lock(mutex_);
    bytes_ += text.size();
    partial_ += text;
    for (auto end = partial_.find("\n\n"); end != std::string::npos; end = partial_.find("\n\n")) {
        const auto message = partial_.substr(0, end);
        partial_.erase(0, end + 2);
        const auto line = message.find('\n');
        events_.push_back({message.substr(sizeof("event:"), line - sizeof("event:")),
                           json::parse(message.substr(line + sizeof("data: ")))});
    }
    came_.notify_all();
}

PageAnswer Tab::tell(const std::string& path, json body) {
    body["tab"] = id_;
    return tellPage(url_, path, body, cookie_);
}

json Tab::await(const std::string& name, const std::function<bool(const json&)>& wanted) {
    const auto deadline = inAMinute();
    std::unique_lock lock(mutex_);
    for (;;) {
        while (seen_ < events_.size()) {
            const auto& event = events_[seen_++];
            if (event.name == name && wanted(event.data)) {
                return event.data;
            }
        }
        if (ended_ || came_.wait_until(lock, deadline) == std::cv_status::timeout) {
            throw std::runtime_error(
                fmt::format("no '{}' came as it was wanted; the last of {}: {}", name,
                            events_.size(), events_.empty() ? "" : events_.back().data.dump()));
        }
    }
}

json Tab::awaitState(const std::string& key, const std::string& state) {
    return await("skill", [&](const json& skill) {
        return skill.at("key") == key && skill.at("state") == state;
    });
}

bool Tab::awaitEnd() {
    std::unique_lock lock(mutex_);
    return came_.wait_until(lock, inAMinute(), [this] { return ended_; });
}

std::size_t Tab::bytes() const {
    const std::lock_guard lock(mutex_);
    return bytes_;
}

std::size_t Tab::count(const std::string& name) const {
    const std::lock_guard lock(mutex_);
    std::size_t count = 0;
    for (const auto& event : events_) {
        count += event.name == name ? 1 : 0;
    }
    return count;
}

}  // namespace metier::system_tests
