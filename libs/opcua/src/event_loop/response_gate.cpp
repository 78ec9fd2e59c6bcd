#include "response_gate.hpp"

#include <algorithm>
#include <string_view>

namespace metier::opcua {

namespace {

constexpr std::size_t kHeader = 8;      // type, final or not, size
constexpr std::size_t kSymmetric = 24;  // header with channel, token, sequence number, request
constexpr std::size_t kPolicyLength = 12;
constexpr std::string_view kPolicyNone = "http://opcfoundation.org/UA/SecurityPolicy#None";

}  // namespace

bool ResponseGate::feed(std::span<const std::uint8_t> bytes) {
    while (!bytes.empty() && !refused_) {
        const bool is_dull = size_ != 0 && taken_ >= std::min(kSeen, size_);
        if (is_dull) {
            const auto step = std::min(bytes.size(), size_ - taken_);
            taken_ += step;
            bytes = bytes.subspan(step);
        } else {
            refused_ = !take(bytes.front());
            bytes = bytes.subspan(1);
        }
        if (size_ != 0 && taken_ == size_) {
            goes_on_ = seen_[3] == 'C';
            taken_ = 0;
            size_ = 0;
        }
    }
    return !refused_;
}

bool ResponseGate::take(std::uint8_t byte) {
    constexpr std::size_t size_offset = 4;
    seen_.at(taken_++) = byte;
    if (taken_ == kHeader) {
        size_ = number(size_offset);
        if (size_ < kHeader) {
            return false;
        }
    }
    if (size_ == 0 || taken_ < std::min(kSeen, size_)) {
        return true;
    }
    noteSecurity();
    return judge();
}

std::uint32_t ResponseGate::number(std::size_t at) const {
    constexpr std::size_t bits = 8;
    std::uint32_t value = 0;
    for (std::size_t i = sizeof value; i-- > 0;) {
        value = value << bits | seen_.at(at + i);
    }
    return value;
}

void ResponseGate::noteSecurity() {
    if (!std::equal(seen_.begin(), seen_.begin() + 3, "OPN")) {
        return;
    }
    constexpr auto policy = kPolicyLength + sizeof(std::uint32_t);
    open_ = size_ < policy + kPolicyNone.size() ||
            (number(kPolicyLength) == kPolicyNone.size() &&
             std::equal(kPolicyNone.begin(), kPolicyNone.end(), seen_.begin() + policy));
}

bool ResponseGate::judge() const {
    const bool is_message = std::equal(seen_.begin(), seen_.begin() + 3, "MSG");
    return !is_message || !open_ || goes_on_ || seen_[3] == 'A' || beginsWithAnId();
}

bool ResponseGate::beginsWithAnId() const {
    constexpr std::array<std::size_t, 3> lengths{2, 4, 7};  // length for each encoding
    if (size_ <= kSymmetric) {
        return false;
    }
    const auto encoding = seen_.at(kSymmetric);
    return encoding < lengths.size() && size_ >= kSymmetric + lengths.at(encoding);
}

}  // namespace metier::opcua
