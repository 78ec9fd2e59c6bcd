#include "metier/virtual_edo/sha1.hpp"

#include <bit>
#include <cstddef>
#include <string>

namespace metier::virtual_edo {
namespace {

constexpr std::size_t kBlock = 64;

using State = std::array<std::uint32_t, 5>;
using Words = std::array<std::uint32_t, 80>;

std::string padded(std::string_view text) {
    std::string message(text);
    message += '\x80';
    while (message.size() % kBlock != kBlock - 8) {
        message += '\0';
    }
    const std::uint64_t bits = std::uint64_t{text.size()} * 8;
    for (int shift = 56; shift >= 0; shift -= 8) {
        message += static_cast<char>((bits >> shift) & 0xFFU);
    }
    return message;
}

Words expand(std::string_view block) {
    Words words{};
    for (std::size_t i = 0; i < kBlock; ++i) {
        words[i / 4] = (words[i / 4] << 8) | static_cast<std::uint8_t>(block[i]);
    }
    for (std::size_t i = 16; i < words.size(); ++i) {
        words[i] = std::rotl(words[i - 3] ^ words[i - 8] ^ words[i - 14] ^ words[i - 16], 1);
    }
    return words;
}

/// The function and the constant of one of the four rounds.
std::uint32_t mix(std::size_t step, const State& s) {
    if (step < 20) {
        return ((s[1] & s[2]) | (~s[1] & s[3])) + 0x5A827999U;
    }
    if (step < 40) {
        return (s[1] ^ s[2] ^ s[3]) + 0x6ED9EBA1U;
    }
    if (step < 60) {
        return ((s[1] & s[2]) | (s[1] & s[3]) | (s[2] & s[3])) + 0x8F1BBCDCU;
    }
    return (s[1] ^ s[2] ^ s[3]) + 0xCA62C1D6U;
}

State digestBlock(const State& before, const Words& words) {
    State s = before;
    for (std::size_t step = 0; step < words.size(); ++step) {
        const auto next = std::rotl(s[0], 5) + mix(step, s) + s[4] + words[step];
        s = {next, s[0], std::rotl(s[1], 30), s[2], s[3]};
    }
    for (std::size_t i = 0; i < s.size(); ++i) {
        s[i] += before[i];
    }
    return s;
}

}  // namespace

std::array<std::uint8_t, 20> sha1(std::string_view text) {
    State state{0x67452301U, 0xEFCDAB89U, 0x98BADCFEU, 0x10325476U, 0xC3D2E1F0U};
    const std::string message = padded(text);
    for (std::size_t at = 0; at < message.size(); at += kBlock) {
        state = digestBlock(state, expand(std::string_view(message).substr(at, kBlock)));
    }
    std::array<std::uint8_t, 20> digest{};
    for (std::size_t i = 0; i < digest.size(); ++i) {
        digest[i] = static_cast<std::uint8_t>(state[i / 4] >> (24 - 8 * (i % 4)));
    }
    return digest;
}

}  // namespace metier::virtual_edo
