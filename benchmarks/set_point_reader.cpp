#include "set_point_reader.hpp"

#include <bit>
#include <cstdint>
#include <cstdlib>
#include <numbers>
#include <string>
#include <vector>

namespace metier::benchmarks {
namespace {

/// Bytes of a message that is not complete yet.
class Pending {
public:
    void append(std::span<const std::byte> bytes) {
        bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    }
    void drop(std::size_t count) {
        bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(count));
    }
    std::size_t size() const { return bytes_.size(); }
    std::uint8_t byte(std::size_t at) const { return std::to_integer<std::uint8_t>(bytes_[at]); }

    /// A number of so many bytes, the most significant first.
    std::uint64_t number(std::size_t at, std::size_t size) const {
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < size; ++i) {
            value = (value << 8U) | byte(at + i);
        }
        return value;
    }

private:
    std::vector<std::byte> bytes_;
};

/// docs/protocols/ur.md: size (2 bytes), type; data: recipe, then the registers.
class RtdeReader final : public SetPointReader {
public:
    void read(std::span<const std::byte> bytes, const Found& found) override {
        pending_.append(bytes);
        while (pending_.size() >= kHeader && pending_.size() >= pending_.number(0, 2)) {
            const auto size = pending_.number(0, 2);
            if (pending_.byte(2) == 'U' && size == kSetPoint && pending_.number(kToken, 4) != 0) {
                found(std::bit_cast<double>(pending_.number(kJoint, 8)));
            }
            pending_.drop(size);
        }
    }

private:
    static constexpr std::size_t kHeader = 3;
    static constexpr std::size_t kToken = 4;
    static constexpr std::size_t kJoint = 12;
    static constexpr std::size_t kSetPoint = kJoint + std::size_t{6} * 8;
    Pending pending_;
};

/// docs/protocols/iiwa.md: code and seven arguments.
class LibiiwaReader final : public SetPointReader {
public:
    void read(std::span<const std::byte> bytes, const Found& found) override {
        pending_.append(bytes);
        for (; pending_.size() >= kCommand; pending_.drop(kCommand)) {
            if (real(0) == kMoveJoints) {
                found(double{real(4)});
            }
        }
    }

private:
    static constexpr std::size_t kCommand = 32;
    static constexpr float kMoveJoints = 102;

    float real(std::size_t at) const {
        return std::bit_cast<float>(static_cast<std::uint32_t>(pending_.number(at, 4)));
    }

    Pending pending_;
};

/// RFC 6455, 5.2: flags and opcode, mask bit and length, 0, 2 or 8 bytes of length, mask, payload.
class RosbridgeReader final : public SetPointReader {
public:
    void read(std::span<const std::byte> bytes, const Found& found) override {
        pending_.append(bytes);
        if (!upgraded_ && !takeRequest()) {
            return;
        }
        while (takeFrame()) {
            takeText(found);
        }
    }

private:
    bool takeRequest() {
        for (std::size_t i = 0; i + 4 <= pending_.size(); ++i) {
            if (pending_.number(i, 4) == 0x0D0A0D0AU) {  // the empty line after the header
                pending_.drop(i + 4);
                upgraded_ = true;
                return true;
            }
        }
        return false;
    }

    bool takeFrame() {
        constexpr std::size_t mask_size = 4;
        if (pending_.size() < 2) {
            return false;
        }
        std::size_t length = pending_.byte(1) & 0x7FU;
        const std::size_t more = length == 126 ? 2 : (length == 127 ? 8 : 0);
        const std::size_t header = 2 + more + mask_size;
        if (pending_.size() < header) {
            return false;
        }
        length = more > 0 ? pending_.number(2, more) : length;
        if (pending_.size() < header + length) {
            return false;
        }
        text_.clear();
        for (std::size_t i = 0; i < length; ++i) {
            const auto mask = pending_.byte(header - mask_size + i % mask_size);
            text_ += static_cast<char>(pending_.byte(header + i) ^ mask);
        }
        pending_.drop(header + length);
        return true;
    }

    /// Both messages that carry set-points name the position of joint 1 first.
    void takeText(const Found& found) const {
        constexpr std::string_view key = "\"position\":";
        const auto at = text_.find(key);
        if (at == std::string::npos || text_.find("\"publish\"") == std::string::npos) {
            return;
        }
        const auto number = text_.find_first_not_of('[', at + key.size());
        const double degrees = std::strtod(text_.c_str() + number, nullptr);
        found(degrees * std::numbers::pi / 180);
    }

    Pending pending_;
    bool upgraded_ = false;
    std::string text_;
};

}  // namespace

std::unique_ptr<SetPointReader> rtdeReader() {
    return std::make_unique<RtdeReader>();
}
std::unique_ptr<SetPointReader> libiiwaReader() {
    return std::make_unique<LibiiwaReader>();
}
std::unique_ptr<SetPointReader> rosbridgeReader() {
    return std::make_unique<RosbridgeReader>();
}

}  // namespace metier::benchmarks
