#pragma once

#include <chrono>
#include <span>
#include <string>

#include "metier/link/tcp_link.hpp"

namespace metier::dashboard {

/// A peer that sends what it wants, byte by byte.
class RawBrowser {
public:
    /// Throws if no server listens.
    explicit RawBrowser(std::uint16_t port)
        : link_(link::TcpLink::connect("127.0.0.1", port, inTime()).value()) {}

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
                break;
            }
            all.append(buffer.data(), *count);
        }
        return all;
    }
    int descriptor() { return link_.descriptor(); }

private:
    static SteadyTime inTime() {
        return std::chrono::steady_clock::now() + std::chrono::seconds(30);
    }
    link::TcpLink link_;
};

}  // namespace metier::dashboard
