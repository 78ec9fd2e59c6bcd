#include "udp_port.hpp"

#include <fmt/format.h>

#include <asio/buffer.hpp>
#include <chrono>
#include <utility>

namespace metier::virtual_netft {

namespace {

constexpr std::size_t kMostWaiting = 10'000;

Error bindError(const UdpPort::Endpoint& local, const asio::error_code& error) {
    const auto name = fmt::format("{}:{}/udp", local.address().to_string(), local.port());
    if (error == asio::error::address_in_use) {
        return {Errc::already_exists, name + ": another program has this port"};
    }
    if (error == asio::error::access_denied) {
        return {Errc::access_denied, name + ": ports below 1024 need root"};
    }
    return {Errc::invalid_argument, name + ": " + error.message()};
}

}  // namespace

Result<std::unique_ptr<UdpPort>> UdpPort::bind(asio::io_context& context, const Endpoint& local,
                                               virtual_controller::LinkFaults& faults,
                                               OnDatagram on_datagram) {
    asio::ip::udp::socket socket(context);
    asio::error_code error;
    socket.open(local.protocol(), error);
    if (!error) {
        socket.bind(local, error);
    }
    if (!error) {
        socket.non_blocking(true, error);
    }
    if (error) {
        return fail(bindError(local, error));
    }
    return std::unique_ptr<UdpPort>(new UdpPort(std::move(socket), faults, std::move(on_datagram)));
}

UdpPort::UdpPort(asio::ip::udp::socket socket, virtual_controller::LinkFaults& faults,
                 OnDatagram on_datagram)
    : socket_(std::move(socket)),
      timer_(socket_.get_executor()),
      faults_(faults),
      on_datagram_(std::move(on_datagram)) {
    receive();
}

std::uint16_t UdpPort::port() const {
    asio::error_code ignored;
    return socket_.local_endpoint(ignored).port();
}

void UdpPort::receive() {
    socket_.async_receive_from(
        asio::buffer(incoming_.data(), incoming_.size()), from_,
        lifetime_.guard([this](const asio::error_code& error, std::size_t count) {
            // An error here reports an earlier datagram that found no receiver.
            if (!error && !faults_.cut.load()) {
                on_datagram_(from_, std::span(incoming_).first(count));
            }
            receive();
        }));
}

void UdpPort::send(const Endpoint& to, std::vector<std::byte> datagram) {
    if (faults_.cut.load() || datagram.empty() || waiting_.size() >= kMostWaiting) {
        return;
    }
    faults_.spoil(datagram);
    const auto delay = faults_.delay_ms.load();
    if (delay == 0 && waiting_.empty()) {
        sendNow(to, datagram);
        return;
    }
    const auto due = std::chrono::steady_clock::now() + std::chrono::milliseconds(delay);
    waiting_.push_back({due, to, std::move(datagram)});
    if (waiting_.size() == 1) {
        waitForDue();
    }
}

void UdpPort::waitForDue() {
    timer_.expires_at(waiting_.front().due);
    timer_.async_wait(lifetime_.guard([this](const asio::error_code&) {
        const auto now = std::chrono::steady_clock::now();
        while (!waiting_.empty() && waiting_.front().due <= now) {
            if (!faults_.cut.load()) {
                sendNow(waiting_.front().to, waiting_.front().bytes);
            }
            waiting_.pop_front();
        }
        if (!waiting_.empty()) {
            waitForDue();
        }
    }));
}

void UdpPort::sendNow(const Endpoint& to, std::span<const std::byte> bytes) {
    asio::error_code lost;  // as a datagram may be
    socket_.send_to(asio::buffer(bytes.data(), bytes.size()), to, 0, lost);
}

}  // namespace metier::virtual_netft
