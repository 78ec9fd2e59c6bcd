#pragma once

#include <array>
#include <asio/buffer.hpp>
#include <asio/io_context.hpp>
#include <asio/ip/udp.hpp>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <thread>

#include "wire.hpp"

namespace metier::netft_driver::testing {

/// A scripted peer on loopback: it streams a record each millisecond once it is asked to.
class FakeSensor {
public:
    FakeSensor() {
        socket_.non_blocking(true);
        thread_ = std::jthread([this](const std::stop_token& stop) { serve(stop); });
    }

    std::uint16_t port() const { return port_; }

    void setStatus(std::uint32_t status) {
        const std::lock_guard lock(mutex_);
        status_ = status;
    }
    void setForce(std::int32_t counts) {
        const std::lock_guard lock(mutex_);
        force_ = counts;
    }
    /// Whether requests of 0x42 have an effect.
    void setDeaf(bool deaf) {
        const std::lock_guard lock(mutex_);
        deaf_ = deaf;
    }
    /// Sets the number of requests of 0x42 that have no effect.
    void ignoreTares(int count) {
        const std::lock_guard lock(mutex_);
        ignored_tares_ = count;
    }
    /// Falls silent with the next request of 0x42.
    void fallSilentAtTare() {
        const std::lock_guard lock(mutex_);
        silent_at_tare_ = true;
    }
    /// Sets the number of start requests that are ignored.
    void ignoreStarts(int count) {
        const std::lock_guard lock(mutex_);
        ignored_starts_ = count;
    }
    void silence(bool silent) {
        const std::lock_guard lock(mutex_);
        silent_ = silent;
    }
    /// Leaves out so many sequence numbers.
    void lose(std::uint32_t count) {
        const std::lock_guard lock(mutex_);
        sequence_ += count;
    }
    /// Sends bytes that are no record.
    void sendNonsense() {
        const std::lock_guard lock(mutex_);
        nonsense_ = true;
    }
    /// Whether `count` requests of that command have come within 10 s.
    bool got(int command, int count = 1) {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, std::chrono::seconds(10),
                                 [&] { return counts_[command] >= count; });
    }
    int count(int command) {
        const std::lock_guard lock(mutex_);
        return counts_[command];
    }

private:
    void serve(const std::stop_token& stop) {
        std::mutex waiting;
        std::condition_variable_any never;
        auto next = std::chrono::steady_clock::now();
        while (!stop.stop_requested()) {
            next += std::chrono::milliseconds(1);
            std::unique_lock wait_lock(waiting);
            never.wait_until(wait_lock, stop, next, [] { return false; });
            const std::lock_guard lock(mutex_);
            while (takeRequest()) {
            }
            sendRecord();
            changed_.notify_all();
        }
    }

    bool takeRequest() {
        std::array<unsigned char, 16> request{};
        asio::ip::udp::endpoint from;
        asio::error_code error;
        const auto size = socket_.receive_from(asio::buffer(request), from, 0, error);
        if (error || size != 8) {
            return false;
        }
        const int command = request[3];
        ++counts_[command];
        if (command == 2 && ignored_starts_-- <= 0) {
            client_ = from;
            sequence_ = 0;
        } else if (command == 0) {
            client_.reset();
        } else if (command == 0x42) {
            silent_ = silent_ || silent_at_tare_;
            const bool ignored = deaf_ || ignored_tares_-- > 0;
            force_ = ignored ? force_ : 0;
        }
        return true;
    }

    void sendRecord() {
        ++sequence_;
        ++sensor_sequence_;
        if (!client_ || silent_) {
            return;
        }
        auto bytes = Record{sequence_, sensor_sequence_, status_, {0, 0, force_, 0, 0, 0}}.bytes();
        if (nonsense_) {
            bytes.pop_back();
            nonsense_ = false;
        }
        asio::error_code ignored;
        socket_.send_to(asio::buffer(bytes), *client_, 0, ignored);
    }

    asio::io_context context_;
    asio::ip::udp::socket socket_{context_,
                                  asio::ip::udp::endpoint(asio::ip::make_address("127.0.0.1"), 0)};
    std::uint16_t port_ = socket_.local_endpoint().port();
    std::mutex mutex_;
    std::condition_variable changed_;
    std::optional<asio::ip::udp::endpoint> client_;
    std::map<int, int> counts_;
    std::uint32_t sequence_ = 0;
    std::uint32_t sensor_sequence_ = 0;
    std::uint32_t status_ = 0;
    std::int32_t force_ = 0;
    int ignored_starts_ = 0;
    int ignored_tares_ = 0;
    bool silent_at_tare_ = false;
    bool deaf_ = false;
    bool silent_ = false;
    bool nonsense_ = false;
    std::jthread thread_;
};

}  // namespace metier::netft_driver::testing
