#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <deque>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "board.hpp"

namespace metier::dashboard {

/// A tab of a board, as its stream would have it.
///
/// Threading: one thread.
class ShownTab {
public:
    struct Event {
        std::string name;
        nlohmann::json data;
    };

    explicit ShownTab(Board& board, std::string id = "a-tab")
        : board_(board), id_(std::move(id)), outbox_(board.openTab(id_, 100'000'000)) {}
    ~ShownTab() { board_.closeTab(id_); }
    ShownTab(const ShownTab&) = delete;
    ShownTab& operator=(const ShownTab&) = delete;

    const std::string& id() const { return id_; }
    /// What was sent up to now and was not seen yet.
    std::vector<Event> seen() {
        takeUntil({});
        std::vector<Event> events(events_.begin(), events_.end());
        events_.clear();
        return events;
    }
    /// Names of seen().
    std::vector<std::string> names() {
        std::vector<std::string> names;
        for (auto& event : seen()) {
            names.push_back(std::move(event.name));
        }
        return names;
    }
    /// The first event of that name that was not seen yet and is wanted. null, and a failure of
    /// the test, if none comes within 30 s.
    nlohmann::json await(const std::string& name,
                         const std::function<bool(const nlohmann::json&)>& wanted) {
        const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
        nlohmann::json last;
        for (;;) {
            while (!events_.empty()) {
                const auto event = std::move(events_.front());
                events_.pop_front();
                if (event.name == name && wanted(event.data)) {
                    return event.data;
                }
                last = event.name == name ? event.data : last;
            }
            if (std::chrono::steady_clock::now() >= deadline) {
                ADD_FAILURE() << "no '" << name << "' came as it was wanted; the last: " << last;
                return nullptr;
            }
            takeUntil(deadline);
        }
    }
    nlohmann::json awaitState(const std::string& skill, const std::string& state) {
        return await("skill", [&](const nlohmann::json& told) {
            return told.at("key") == skill && told.at("state") == state;
        });
    }

private:
    void takeUntil(SteadyTime deadline) {
        for (const auto& message : outbox_->take(deadline)) {
            const auto line = message->find('\n');
            constexpr std::size_t kEvent = sizeof("event:");
            events_.push_back({message->substr(kEvent, line - kEvent),
                               nlohmann::json::parse(message->substr(line + sizeof("data: ")))});
        }
    }

    Board& board_;
    const std::string id_;
    const std::shared_ptr<Outbox> outbox_;  // with the board
    std::deque<Event> events_;
};

}  // namespace metier::dashboard
