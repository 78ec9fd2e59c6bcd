#include "writer.hpp"

#include <array>
#include <chrono>
#include <limits>

namespace metier::hostile {

namespace {

constexpr std::size_t kLongText = 4'000;
constexpr std::uint8_t kNumericId = 2;
constexpr std::uint8_t kTextId = 3;
constexpr std::uint8_t kBinaryBody = 1;

template <std::integral T>
void put(Bytes& bytes, T value) {
    for (std::size_t i = 0; i < sizeof(T); ++i) {
        bytes.push_back(static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i)));
    }
}

/// 100 ns since 1601.
std::uint64_t now() {
    constexpr std::uint64_t ticks_to_1970 = 116'444'736'000'000'000;
    constexpr std::uint64_t nanoseconds_per_tick = 100;
    const auto since_1970 = std::chrono::system_clock::now().time_since_epoch();
    return ticks_to_1970 +
           static_cast<std::uint64_t>(
               std::chrono::duration_cast<std::chrono::nanoseconds>(since_1970).count()) /
               nanoseconds_per_tick;
}

}  // namespace

Bytes numericId(std::uint16_t namespace_index, std::uint32_t id) {
    Bytes bytes(1, static_cast<char>(kNumericId));
    put(bytes, namespace_index);
    put(bytes, id);
    return bytes;
}

Bytes textId(std::uint16_t namespace_index, std::string_view id) {
    Bytes bytes(1, static_cast<char>(kTextId));
    put(bytes, namespace_index);
    put(bytes, static_cast<std::uint32_t>(id.size()));
    bytes.append(id);
    return bytes;
}

void Writer::exactText(std::string_view text) {
    exactly(static_cast<std::int32_t>(text.size()));
    raw(text);
}

void Writer::real(double value) {
    exactly(std::bit_cast<std::uint64_t>(isWrong() ? oddReal() : value));
}

void Writer::count(std::size_t elements) {
    if (!isWrong()) {
        return exactly(static_cast<std::int32_t>(elements));
    }
    const std::array<std::int64_t, 10> lies{-1,
                                            0,
                                            1,
                                            static_cast<std::int64_t>(elements) + 1,
                                            static_cast<std::int64_t>(elements) - 1,
                                            -2,
                                            1'000,
                                            1'000'000,
                                            std::numeric_limits<std::int32_t>::max(),
                                            std::numeric_limits<std::int32_t>::min()};
    exactly(static_cast<std::int32_t>(random_.pick(lies)));
}

void Writer::text(std::string_view text) {
    if (!isWrong()) {
        return exactText(text);
    }
    if (random_.oneIn(4)) {
        return noText();
    }
    const auto odd = oddText();
    count(odd.size());
    raw(odd);
}

void Writer::id(std::string_view node_id) {
    raw(isWrong() ? oddId() : node_id);
}

void Writer::expandedId(std::string_view node_id) {
    if (!isWrong()) {
        return raw(node_id);
    }
    constexpr unsigned uri = 0x80;
    constexpr unsigned server = 0x40;
    auto odd = oddId();
    const auto flags = static_cast<unsigned>(random_.below(4)) << 6U;
    odd[0] = static_cast<char>(static_cast<unsigned char>(odd[0]) | flags);
    raw(odd);
    if ((flags & uri) != 0) {
        text("urn:of:nobody");
    }
    if ((flags & server) != 0) {
        number(std::uint32_t{1});
    }
}

void Writer::qualifiedName(std::uint16_t namespace_index, std::string_view name) {
    number(namespace_index);
    text(name);
}

void Writer::localizedText(std::string_view value) {
    constexpr std::uint8_t has_text = 2;
    constexpr std::uint8_t has_locale = 1;
    if (!isWrong()) {
        exactly(has_text);
        return text(value);
    }
    exactly(static_cast<std::uint8_t>(random_.next()));
    if (random_.oneIn(2)) {
        exactText(oddText());
    }
    exactly(has_locale);
    text(value);
}

void Writer::time() {
    exactly(isWrong() ? oddInteger() : now());
}

void Writer::extension(std::uint32_t encoding_id, std::string_view body) {
    if (isWrong()) {
        constexpr std::array<std::uint32_t, 12> others{321, 324, 327, 727, 724, 597,
                                                       594, 603, 649, 354, 298, 99'999};
        encoding_id = random_.pick(others);
    }
    id(standardId(encoding_id));
    if (isWrong()) {
        exactly(static_cast<std::uint8_t>(random_.below(4)));
        return random_.oneIn(2) ? raw(body) : void();
    }
    exactly(kBinaryBody);
    count(body.size());
    raw(body);
}

std::uint64_t Writer::oddInteger() {
    constexpr std::array<std::uint64_t, 12> odd_ones{0,
                                                     1,
                                                     2,
                                                     0x7F,
                                                     0xFF,
                                                     0xFFFF,
                                                     0x7FFF'FFFF,
                                                     0x8000'0000,
                                                     0xFFFF'FFFF,
                                                     0x7FFF'FFFF'FFFF'FFFF,
                                                     0x8000'0000'0000'0000,
                                                     0xFFFF'FFFF'FFFF'FFFF};
    return random_.oneIn(3) ? random_.next() : random_.pick(odd_ones);
}

double Writer::oddReal() {
    using Limits = std::numeric_limits<double>;
    constexpr std::array<double, 9> odd_ones{Limits::quiet_NaN(),
                                             Limits::infinity(),
                                             -Limits::infinity(),
                                             Limits::max(),
                                             Limits::lowest(),
                                             Limits::denorm_min(),
                                             -0.0,
                                             -1.0,
                                             1e18};
    return random_.pick(odd_ones);
}

Bytes Writer::oddText() {
    using namespace std::string_literals;
    static const std::array<Bytes, 12> odd_ones{""s,
                                                "\xff\xfe\xfd"s,
                                                "\xc0\x80"s,
                                                "\xed\xa0\x80"s,
                                                "\xf4\x90\x80\x80"s,
                                                "nul\0inside"s,
                                                "\x1b[2J\x1b[31mred"s,
                                                "\x1b]0;title\x07"s,
                                                "line\r\nline two"s,
                                                "%s%n%d{}"s,
                                                "\xe2\x80\xae"
                                                "desrever"s,
                                                "../../../../etc/passwd"s};
    return random_.oneIn(6) ? Bytes(random_.below(kLongText), 'A') : random_.pick(odd_ones);
}

Bytes Writer::oddId() {
    constexpr std::uint8_t guid_id = 4;
    constexpr std::uint8_t opaque_id = 5;
    Bytes bytes;
    switch (random_.below(7)) {
        case 0:
            return {0, 0};
        case 1:
            return standardId(static_cast<std::uint32_t>(random_.below(13'000)));
        case 2:
            return numericId(static_cast<std::uint16_t>(random_.next()),
                             static_cast<std::uint32_t>(random_.next()));
        case 3:
            return textId(static_cast<std::uint16_t>(random_.below(8)), oddText());
        case 4:
            bytes.push_back(static_cast<char>(guid_id));
            return bytes.append(18, static_cast<char>(random_.next()));
        case 5:
            bytes = textId(0, oddText());
            bytes[0] = static_cast<char>(opaque_id);
            return bytes;
        default:
            return Bytes(1 + random_.below(4), static_cast<char>(random_.next()));
    }
}

}  // namespace metier::hostile
