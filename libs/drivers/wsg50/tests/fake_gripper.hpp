#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "metier/link/tcp_link.hpp"
#include "wire.hpp"

namespace metier::wsg50_driver::testing {

/// A scripted peer on loopback: it answers as the test says and sends updates of its state.
class FakeGripper {
public:
    struct State {
        std::uint32_t bits = kReferenced;
        int grasping = kIdle;
        float width_mm = 50;
        float force = 0;
    };

    FakeGripper() : thread_([this](const std::stop_token& stop) { serve(stop); }) {}
    ~FakeGripper() {
        thread_.request_stop();
        thread_.join();
    }

    std::uint16_t port() const { return listener_.port(); }

    void set(const State& state) {
        const std::lock_guard lock(mutex_);
        state_ = state;
    }
    /// Sends frames as they are.
    void send(const Bytes& bytes) {
        const std::lock_guard lock(mutex_);
        outgoing_ = outgoing_ + bytes;
    }
    /// Sets the answer to `id` instead of a plain success; empty: no answer.
    void answer(int id, Bytes bytes) {
        const std::lock_guard lock(mutex_);
        answers_[id] = std::move(bytes);
    }
    /// Closes the connection.
    void drop() {
        const std::lock_guard lock(mutex_);
        drop_ = true;
    }
    /// Goes on without any update, or with them again.
    void silence(bool silent) {
        const std::lock_guard lock(mutex_);
        silent_ = silent;
    }
    /// Whether `count` commands of that id have come within 10 s.
    bool got(int id, int count = 1) {
        return waitFor([&] { return counts_[id] >= count; });
    }
    bool connections(int count) {
        return waitFor([&] { return connections_ >= count; });
    }
    /// The last command of that id.
    Bytes command(int id) {
        const std::lock_guard lock(mutex_);
        return commands_[id];
    }
    std::vector<int> ids() {
        const std::lock_guard lock(mutex_);
        return ids_;
    }

private:
    template <typename Done>
    bool waitFor(Done done) {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, std::chrono::seconds(10), done);
    }

    static SteadyTime in(int ms) {
        return std::chrono::steady_clock::now() + std::chrono::milliseconds(ms);
    }

    void serve(const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            auto link = listener_.accept(in(20));
            if (!link) {
                continue;
            }
            {
                const std::lock_guard lock(mutex_);
                ++connections_;
                drop_ = false;
                outgoing_.clear();
                updates_.clear();
            }
            changed_.notify_all();
            Bytes pending;
            while (!stop.stop_requested() && serveOnce(*link, pending)) {
            }
        }
    }

    bool serveOnce(link::TcpLink& link, Bytes& pending) {
        std::array<std::byte, 256> buffer{};
        const auto count = link.receive(buffer, in(5));
        if (!count && count.error().code != Errc::timeout) {
            return false;
        }
        pending.insert(pending.end(), buffer.begin(),
                       buffer.begin() + static_cast<std::ptrdiff_t>(count.value_or(0)));
        Bytes out;
        {
            const std::lock_guard lock(mutex_);
            while (takeCommand(pending)) {
            }
            addUpdates();
            out.swap(outgoing_);
            if (drop_) {
                return false;
            }
        }
        changed_.notify_all();
        if (!out.empty()) {
            // A driver that has gone: what it sent before is still received.
            static_cast<void>(link.send(out, in(1000)));
        }
        return true;
    }

    /// Commands are as the test of the codec says, so only their length matters here.
    bool takeCommand(Bytes& pending) {
        if (pending.size() < 8) {
            return false;
        }
        const auto size = 8 + std::to_integer<std::size_t>(pending[4]);
        if (pending.size() < size) {
            return false;
        }
        const int id = std::to_integer<int>(pending[3]);
        const auto end = pending.begin() + static_cast<std::ptrdiff_t>(size);
        commands_[id] = {pending.begin(), end};
        pending.erase(pending.begin(), end);
        ids_.push_back(id);
        ++counts_[id];
        const auto scripted = answers_.find(id);
        outgoing_ = outgoing_ + (scripted == answers_.end() ? usual(id) : scripted->second);
        return true;
    }

    Bytes usual(int id) {
        switch (id) {
            case 0x53:
                return limits();
            case 0x33:
                return reply(0x33, kSuccess, f32(40));
            case 0x40:
            case 0x41:
            case 0x43:
            case 0x45:
                updates_.push_back(id);
                return {};  // the update that follows
            case 0x20:
            case 0x21:
            case 0x25:
            case 0x26:
                return reply(id, kPending);
            default:
                return reply(id, kSuccess);
        }
    }

    void addUpdates() {
        for (const int id : silent_ ? std::vector<int>() : updates_) {
            outgoing_ = outgoing_ + (id == 0x40   ? systemState(state_.bits)
                                     : id == 0x41 ? graspingState(state_.grasping)
                                     : id == 0x43 ? width(state_.width_mm)
                                                  : force(state_.force));
        }
    }

    link::TcpListener listener_ = link::TcpListener::listen("127.0.0.1", 0).value();
    std::mutex mutex_;
    std::condition_variable changed_;
    State state_;
    Bytes outgoing_;
    std::map<int, Bytes> answers_;
    std::map<int, Bytes> commands_;
    std::map<int, int> counts_;
    std::vector<int> ids_;
    std::vector<int> updates_;
    int connections_ = 0;
    bool drop_ = false;
    bool silent_ = false;
    std::jthread thread_;
};

}  // namespace metier::wsg50_driver::testing
