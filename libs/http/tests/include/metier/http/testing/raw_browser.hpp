#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <span>
#include <string>

#include "metier/link/tcp_link.hpp"

namespace metier::http::testing {

/// A peer that sends what it wants, byte by byte.
class RawBrowser {
public:
    /// Throws if no server listens.
    explicit RawBrowser(std::uint16_t port, const std::string& address = "127.0.0.1")
        : link_(link::TcpLink::connect(address, port, inTime()).value()) {}

    /// \return false: the peer took no more
    bool send(const std::string& bytes) {
        return link_.send(std::as_bytes(std::span(bytes)), inTime()).has_value();
    }
    /// All that comes until the peer ends the connection, or until `end` is in it.
    std::string receive(const std::string& end = "") {
        std::string all;
        while (end.empty() || all.find(end) == std::string::npos) {
            std::array<char, 4096> buffer{};
            const auto count = link_.receive(std::as_writable_bytes(std::span(buffer)), inTime());
            if (!count) {
                was_ended_ = count.error().code == Errc::connection_lost;
                break;
            }
            all.append(buffer.data(), *count);
        }
        return all;
    }
    /// Waits until the peer ends the connection, whatever it sends before; false after 30 s.
    bool awaitEnd() {
        receive();
        return was_ended_;
    }
    /// Whether nothing comes, and the connection stays, for so long.
    bool isLeftAlone(std::chrono::milliseconds time) {
        std::array<char, 1> buffer{};
        const auto count = link_.receive(std::as_writable_bytes(std::span(buffer)),
                                         std::chrono::steady_clock::now() + time);
        return !count && count.error().code == Errc::timeout;
    }
    int descriptor() { return link_.descriptor(); }

private:
    static SteadyTime inTime() {
        return std::chrono::steady_clock::now() + std::chrono::seconds(30);
    }
    link::TcpLink link_;
    bool was_ended_ = false;
};

}  // namespace metier::http::testing
