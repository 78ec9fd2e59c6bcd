#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <utility>

#include "metier/base/clock.hpp"
#include "metier/opcua/server.hpp"
#include "metier/skill/executor.hpp"

namespace metier::system_tests {

/// The thread of a server as the owner of Programs, in a time that stands until it is moved.
class HandTime final : public skill::Executor {
public:
    const ManualClock& clock() const noexcept { return clock_; }
    /// Once, before anything else; the server must outlive all use.
    void runOn(opcua::Server& server) { server_ = &server; }

    void post(std::function<void()> work) override { server_->post(std::move(work)); }

    skill::Timer after(std::chrono::nanoseconds delay, std::function<void()> work) override {
        const auto key = std::pair(clock_.now() + delay, ++count_);
        timers_->emplace(key, std::move(work));
        return skill::Timer([timers = std::weak_ptr(timers_), key] {
            if (const auto alive = timers.lock()) {
                alive->erase(key);
            }
        });
    }

    /// On the server's thread; what falls due on the way runs at its time.
    void advance(std::chrono::nanoseconds step) {
        const auto end = clock_.now() + step;
        while (!timers_->empty() && timers_->begin()->first.first <= end) {
            auto due = timers_->extract(timers_->begin());
            clock_.advance(std::max(due.key().first - clock_.now(), std::chrono::nanoseconds(0)));
            due.mapped()();
        }
        clock_.advance(end - clock_.now());
    }

private:
    using Timers = std::map<std::pair<SteadyTime, std::uint64_t>, std::function<void()>>;

    ManualClock clock_;
    opcua::Server* server_ = nullptr;
    // Shared with the Timers, which may outlive this.
    std::shared_ptr<Timers> timers_ = std::make_shared<Timers>();
    std::uint64_t count_ = 0;
};

}  // namespace metier::system_tests
