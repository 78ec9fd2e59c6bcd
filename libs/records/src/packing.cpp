#include "packing.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

namespace metier::records {
namespace {

// Integers have seven bits in each byte, the lowest first.
constexpr unsigned kBits = 7;
constexpr unsigned kMostBits = 64;
constexpr std::uint8_t kMore = 0x80;

/// Small for small differences to either side.
std::uint64_t folded(std::uint64_t difference) {
    return (difference << 1U) ^ (0 - (difference >> 63U));
}
std::uint64_t unfolded(std::uint64_t folded) {
    return (folded >> 1U) ^ (0 - (folded & 1U));
}

/// In place of the number of a recent text.
constexpr std::uint8_t kNew = RecentTexts::kMost;
constexpr std::uint8_t kEmpty = kNew + 1;

constexpr std::uint64_t kFactor = 0x9E37'79B9'7F4A'7C15U;
constexpr std::size_t kPlaces = 6;

}  // namespace

/// Of a few places of it, since whoever has the same is compared as a whole.
std::uint32_t RecentTexts::hashOf(std::string_view text) {
    std::uint64_t hash = text.size();
    std::uint64_t word = 0;
    if (text.size() < sizeof word) {
        for (const char c : text) {
            word = word << 8U | static_cast<std::uint8_t>(c);
        }
        return static_cast<std::uint32_t>((hash ^ word) * kFactor >> 32U);
    }
    const auto last = text.size() - sizeof word;
    for (std::size_t i = 0; i <= kPlaces; ++i) {
        std::memcpy(&word, text.data() + last * i / kPlaces, sizeof word);
        hash = (hash ^ word) * kFactor;
        hash ^= hash >> 32U;
    }
    return static_cast<std::uint32_t>(hash);
}

std::uint8_t RecentTexts::find(std::string_view text, std::uint32_t hash) const {
    std::uint8_t number = 0;
    while (number < kMost && (hashes_[number] != hash || texts_[number] != text)) {
        ++number;
    }
    return number;
}

const std::string& RecentTexts::use(std::uint8_t number) {
    latest_ = number;
    return texts_[number];
}

void RecentTexts::add(std::string_view text, std::uint32_t hash) {
    texts_[next_] = text;
    hashes_[next_] = hash;
    latest_ = next_;
    next_ = static_cast<std::uint8_t>((next_ + 1) % kMost);
}

void RecentTexts::clear() {
    for (auto& text : texts_) {
        text.clear();
    }
    hashes_.fill(hashOf({}));
    latest_ = 0;
    next_ = 0;
}

void Packer::key(Recorder::Key key) {
    put(folded(key - std::exchange(before_.key, key)));
}

/// Its number, or what it adds to the latest.
void Packer::put(std::string_view text, RecentTexts& recent) {
    if (text.empty()) {
        byte(kEmpty);
        return;
    }
    if (text == recent.latest()) {
        byte(recent.latestNumber());
        return;
    }
    const auto hash = RecentTexts::hashOf(text);
    const auto number = recent.find(text, hash);
    byte(number);
    if (number != kNew) {
        recent.use(number);
        return;
    }
    const auto& latest = recent.latest();
    const auto differs = std::mismatch(text.begin(), text.end(), latest.begin(), latest.end());
    const auto shared = static_cast<std::size_t>(differs.first - text.begin());
    const auto rest = text.substr(shared);
    put(shared);
    put(rest.size());
    at_ = std::copy(rest.begin(), rest.end(), at_);
    recent.add(text, hash);
}

void Packer::put(UtcTime time) {
    const auto count = static_cast<std::uint64_t>(time.time_since_epoch().count());
    put(folded(count - std::exchange(before_.time, count)));
}

void Packer::put(std::uint64_t value) {
    for (; value >= kMore; value >>= kBits) {
        byte(static_cast<std::uint8_t>(value) | kMore);
    }
    byte(static_cast<std::uint8_t>(value));
}

std::uint8_t Unpacker::byte() {
    const auto one = next(1);
    return one.empty() ? 0 : one.front();
}

Recorder::Key Unpacker::key() {
    return before_.key += unfolded(integer());
}

void Unpacker::take(std::string& text, RecentTexts& recent) {
    text.clear();
    const auto number = byte();
    if (number == kEmpty) {
        return;
    }
    if (number < kNew && whole_) {
        text = recent.use(number);
        return;
    }
    const auto shared = integer();
    const auto bytes = next(integer());
    whole_ = whole_ && number == kNew && shared <= recent.latest().size();
    if (whole_) {
        text.assign(recent.latest(), 0, shared).append(bytes.begin(), bytes.end());
        recent.add(text, RecentTexts::hashOf(text));
    }
}

void Unpacker::take(UtcTime& time) {
    before_.time += unfolded(integer());
    time = UtcTime(UtcTime::duration(static_cast<UtcTime::rep>(before_.time)));
}

std::uint64_t Unpacker::integer() {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < kMostBits; shift += kBits) {
        const std::uint64_t bits = byte();
        value |= (bits & ~std::uint64_t{kMore}) << shift;
        if (bits < kMore) {
            return value;
        }
    }
    whole_ = false;
    return 0;
}

std::span<const std::uint8_t> Unpacker::next(std::uint64_t size) {
    whole_ = whole_ && size <= bytes_.size();
    if (!whole_) {
        return {};
    }
    const auto taken = bytes_.first(size);
    bytes_ = bytes_.subspan(size);
    return taken;
}

}  // namespace metier::records
