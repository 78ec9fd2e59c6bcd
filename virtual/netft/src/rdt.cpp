#include "rdt.hpp"

#include <algorithm>

namespace metier::virtual_netft {

namespace {

constexpr std::size_t kRequestSize = 8;
constexpr std::uint32_t kHeader = 0x1234;
constexpr std::array kCommands{Command::stop,           Command::start_real_time,
                               Command::start_buffered, Command::start_multi_unit,
                               Command::reset_latch,    Command::set_bias};

std::uint32_t number(std::span<const std::byte> bytes) noexcept {
    std::uint32_t value = 0;
    for (const std::byte byte : bytes) {
        value = value << 8U | std::to_integer<std::uint32_t>(byte);
    }
    return value;
}

void appendNumber(std::vector<std::byte>& bytes, std::uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) {
        bytes.push_back(static_cast<std::byte>(value >> static_cast<unsigned>(shift) & 0xFFU));
    }
}

}  // namespace

std::optional<Request> parseRequest(std::span<const std::byte> datagram) noexcept {
    if (datagram.size() != kRequestSize || number(datagram.first(2)) != kHeader) {
        return std::nullopt;
    }
    const auto command = static_cast<Command>(number(datagram.subspan(2, 2)));
    if (std::ranges::find(kCommands, command) == kCommands.end()) {
        return std::nullopt;
    }
    return Request{command, number(datagram.subspan(4, 4))};
}

void append(std::vector<std::byte>& datagram, const Record& record) {
    appendNumber(datagram, record.rdt_sequence);
    appendNumber(datagram, record.ft_sequence);
    appendNumber(datagram, record.status);
    for (const std::int32_t count : record.counts) {
        appendNumber(datagram, static_cast<std::uint32_t>(count));
    }
}

}  // namespace metier::virtual_netft
