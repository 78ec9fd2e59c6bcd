#pragma once

#include <string>
#include <vector>

#include "metier/virtual_controller/tcp_server.hpp"
#include "rtde_variables.hpp"

namespace metier::virtual_ur {

/// Keeps what is sent to it.
class FakePeer final : public virtual_controller::TcpPeer {
public:
    using TcpPeer::send;
    void send(std::span<const std::byte> bytes) override {
        sent.emplace_back(bytes.begin(), bytes.end());
    }
    void close() override {}
    void reset() override {}
    std::size_t queued() const override { return unread; }
    const std::string& address() const override { return address_; }

    std::vector<Bytes> sent;
    std::size_t unread = 0;

private:
    std::string address_ = "127.0.0.1:50000";
};

/// Bytes of a text with the given numbers before it.
inline Bytes bytes(std::initializer_list<int> numbers, std::string_view text = "") {
    Bytes result;
    for (const int number : numbers) {
        result.push_back(static_cast<std::byte>(number));
    }
    const auto rest = std::as_bytes(std::span(text));
    result.insert(result.end(), rest.begin(), rest.end());
    return result;
}

inline Bytes joined(std::initializer_list<Bytes> parts) {
    Bytes result;
    for (const auto& part : parts) {
        result.insert(result.end(), part.begin(), part.end());
    }
    return result;
}

}  // namespace metier::virtual_ur
