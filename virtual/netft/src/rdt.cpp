#include "rdt.hpp"

#include <algorithm>

#include "metier/virtual_controller/wire_bytes.hpp"

namespace metier::virtual_netft {

namespace {

constexpr std::size_t kRequestSize = 8;
constexpr std::uint16_t kHeader = 0x1234;
constexpr std::array kCommands{Command::stop,           Command::start_real_time,
                               Command::start_buffered, Command::start_multi_unit,
                               Command::reset_latch,    Command::set_bias};

}  // namespace

std::optional<Request> parseRequest(std::span<const std::byte> datagram) noexcept {
    virtual_controller::ByteReader reader(datagram);
    const auto header = reader.get<std::uint16_t>();
    const auto command = static_cast<Command>(reader.get<std::uint16_t>());
    const auto sample_count = reader.get<std::uint32_t>();
    if (datagram.size() != kRequestSize || header != kHeader ||
        std::ranges::find(kCommands, command) == kCommands.end()) {
        return std::nullopt;
    }
    return Request{command, sample_count};
}

void append(std::vector<std::byte>& datagram, const Record& record) {
    virtual_controller::ByteWriter bytes;
    bytes.put(record.rdt_sequence).put(record.ft_sequence).put(record.status).putAll(record.counts);
    datagram.insert(datagram.end(), bytes.content().begin(), bytes.content().end());
}

}  // namespace metier::virtual_netft
