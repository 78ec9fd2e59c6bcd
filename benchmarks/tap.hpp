#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "set_point_reader.hpp"

namespace metier::benchmarks {

/// Stands in a TCP connection between a driver and its controller and notes when each set-point
/// passes. What it reads it hands on at once.
///
/// Threading: one thread of its own; functions from any.
class Tap {
public:
    enum class Dials : std::uint8_t { driver, controller };
    struct Options {
        std::string address{};        ///< of both sides, on this machine
        std::uint16_t port = 0;       ///< of the side that listens
        Dials dials = Dials::driver;  ///< which side connects
        std::function<std::unique_ptr<SetPointReader>()> reader{};
    };
    struct SetPoint {
        std::chrono::steady_clock::time_point time;  ///< when its bytes arrived
        double position = 0;                         ///< of joint 1 [rad]
    };

    /// Throws if it cannot listen.
    explicit Tap(Options options);
    ~Tap();
    Tap(const Tap&) = delete;
    Tap& operator=(const Tap&) = delete;

    /// Port for the side that connects.
    std::uint16_t port() const noexcept { return port_; }
    /// Time when the last set-point passed; nothing before the first.
    std::optional<std::chrono::steady_clock::time_point> last() const;
    /// Those since the call before.
    std::vector<SetPoint> take();

private:
    void run(const std::stop_token& stop);
    void relay(int accepted, int dialled, const std::stop_token& stop);
    /// Hands on what is there. False once a side has ended.
    bool pass(int from, int to, SetPointReader* reader);
    void note(double position, std::chrono::steady_clock::time_point time);

    Options options_;
    int listener_ = -1;
    std::uint16_t port_ = 0;
    mutable std::mutex mutex_;
    std::vector<SetPoint> seen_;
    std::optional<std::chrono::steady_clock::time_point> last_;
    std::jthread thread_;
};

/// A port of that address that is free now.
std::uint16_t freePort(const std::string& address);

}  // namespace metier::benchmarks
