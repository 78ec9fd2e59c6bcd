#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "metier/base/clock.hpp"

namespace httplib {
class Client;
}

namespace metier::system_tests {

/// Answer of a dashboard.
struct PageAnswer {
    int status = 0;  ///< status of HTTP; 0: there was no answer
    nlohmann::json body{};
    std::string cookie{};  ///< cookie that it set

    std::string error() const;  ///< its words; empty: none
};

/// Asks a dashboard something, as the page does.
/// \param url    "http://127.0.0.1:8080"
/// \param cookie of a log-in; empty: none
PageAnswer askPage(const std::string& url, const std::string& path, const std::string& cookie = "");
PageAnswer tellPage(const std::string& url, const std::string& path, const nlohmann::json& body,
                    const std::string& cookie = "");

/// A tab of a browser that shows a dashboard: its stream, and what it asks for.
///
/// Threading: one thread, and one of its own for the stream.
class Tab {
public:
    struct Event {
        std::string name;
        nlohmann::json data;
    };

    /// Returns once the snapshot is there. Throws if it does not come within a minute.
    explicit Tab(std::string url, std::string cookie = "");
    /// Closes it: the stream ends.
    ~Tab();
    Tab(const Tab&) = delete;
    Tab& operator=(const Tab&) = delete;

    const std::string& id() const noexcept { return id_; }
    /// POST with the tab's id in the body.
    PageAnswer tell(const std::string& path, nlohmann::json body = nlohmann::json::object());
    PageAnswer ask(const std::string& path) { return askPage(url_, path, cookie_); }

    /// The first event of that name, from the last one that was awaited on, that is wanted.
    /// Throws if none comes within a minute.
    nlohmann::json await(const std::string& name,
                         const std::function<bool(const nlohmann::json&)>& wanted);
    /// Waits until the skill is in that state, as far as this tab was notified.
    /// \return its last event
    nlohmann::json awaitState(const std::string& key, const std::string& state);
    /// Waits until the page has ended the stream; false after a minute.
    bool awaitEnd();
    /// Number of bytes that the stream has brought.
    std::size_t bytes() const;
    std::size_t count(const std::string& name) const;

private:
    void read();
    void take(std::string_view text);

    const std::string url_;
    const std::string cookie_;
    std::string id_;
    std::unique_ptr<httplib::Client> stream_;
    mutable std::mutex mutex_;
    std::condition_variable came_;
    std::string partial_;
    std::vector<Event> events_;
    std::size_t seen_ = 0;  // events that await() has passed
    std::size_t bytes_ = 0;
    bool ended_ = false;
    std::jthread reader_;  // last: it uses everything above
};

}  // namespace metier::system_tests
