#include "metier/netft_driver/http_get.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <optional>
#include <span>
#include <string_view>

#include "metier/link/tcp_link.hpp"

namespace metier::netft_driver {
namespace {

constexpr std::string_view kEndOfHeader = "\r\n\r\n";

bool sameIgnoringCase(std::string_view left, std::string_view right) {
    return std::equal(left.begin(), left.end(), right.begin(), right.end(), [](char a, char b) {
        return std::tolower(static_cast<unsigned char>(a)) ==
               std::tolower(static_cast<unsigned char>(b));
    });
}

std::optional<std::size_t> numberAt(std::string_view text) {
    const auto begin = std::min(text.find_first_not_of(' '), text.size());
    std::size_t number = 0;
    const auto digits = text.substr(begin);
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    return error == std::errc() && end != digits.data() ? std::optional(number) : std::nullopt;
}

std::optional<std::size_t> contentLength(std::string_view header) {
    constexpr std::string_view kName = "Content-Length:";
    while (!header.empty()) {
        const auto end = std::min(header.find("\r\n"), header.size());
        const auto line = header.substr(0, end);
        if (line.size() > kName.size() && sameIgnoringCase(line.substr(0, kName.size()), kName)) {
            return numberAt(line.substr(kName.size()));
        }
        header.remove_prefix(std::min(end + 2, header.size()));
    }
    return std::nullopt;
}

/// Whether the body is as long as the header says; a server may keep the connection open.
bool isWhole(const std::string& answer) {
    const auto header_end = answer.find(kEndOfHeader);
    if (header_end == std::string::npos) {
        return false;
    }
    const auto length = contentLength(std::string_view(answer).substr(0, header_end));
    return length && answer.size() - header_end - kEndOfHeader.size() >= *length;
}

/// All that comes until the server closes, as HTTP/1.0 does, or until the answer is whole.
Result<std::string> receiveAll(link::TcpLink& link, SteadyTime deadline) {
    std::string answer;
    std::array<char, 2048> buffer{};
    while (!isWhole(answer)) {
        const auto count = link.receive(std::as_writable_bytes(std::span(buffer)), deadline);
        if (!count && count.error().code == Errc::connection_lost) {
            return answer;
        }
        if (!count) {
            return fail(count.error());
        }
        if (answer.size() + *count > kLargestPage) {
            return fail(Errc::invalid_argument, fmt::format("over {} bytes", kLargestPage));
        }
        answer.append(buffer.data(), *count);
    }
    return answer;
}

}  // namespace

Result<std::string> parseHttpAnswer(const std::string& answer) {
    const std::string_view text(answer);
    const auto header_end = text.find(kEndOfHeader);
    if (!text.starts_with("HTTP/1.") || header_end == std::string_view::npos) {
        return fail(Errc::invalid_argument, "no HTTP answer");
    }
    const auto header = text.substr(0, header_end);
    const auto status = numberAt(header.substr(std::min(header.find(' '), header.size())));
    if (status != 200U) {
        return fail(Errc::not_found, fmt::format("HTTP status {}", status.value_or(0)));
    }
    const auto body = text.substr(header_end + kEndOfHeader.size());
    const auto length = contentLength(header).value_or(body.size());
    if (body.size() < length) {
        return fail(Errc::invalid_argument,
                    fmt::format("{} of {} bytes came", body.size(), length));
    }
    return std::string(body.substr(0, length));
}

Result<std::string> httpGet(const std::string& host, std::uint16_t port, const std::string& path,
                            SteadyTime deadline) {
    const auto place = fmt::format("http://{}:{}{}", host, port, path);
    auto page = link::TcpLink::connect(host, port, deadline).and_then([&](link::TcpLink link) {
        const auto request = fmt::format("GET {} HTTP/1.0\r\nHost: {}\r\n\r\n", path, host);
        return link.send(std::as_bytes(std::span(request)), deadline)
            .and_then([&] { return receiveAll(link, deadline); })
            .and_then(parseHttpAnswer);
    });
    return page ? page
                : fail(page.error().code, fmt::format("{}: {}", place, page.error().message));
}

}  // namespace metier::netft_driver
