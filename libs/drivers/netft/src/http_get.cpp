#include "http_get.hpp"

#include <fmt/format.h>

#include <span>

#include "metier/link/tcp_link.hpp"

namespace metier::netft_driver {

Result<std::string> httpGet(const std::string& host, std::uint16_t port, const std::string& path,
                            SteadyTime deadline) {
    const auto place = fmt::format("http://{}:{}{}", host, port, path);
    auto page = link::TcpLink::connect(host, port, deadline).and_then([&](link::TcpLink link) {
        const auto request = fmt::format("GET {} HTTP/1.0\r\nHost: {}\r\n\r\n", path, host);
        return link.send(std::as_bytes(std::span(request)), deadline).and_then([&] {
            return readHttpAnswer([&](auto bytes) { return link.receive(bytes, deadline); });
        });
    });
    return page ? page
                : fail(page.error().code, fmt::format("{}: {}", place, page.error().message));
}

}  // namespace metier::netft_driver
