#include "parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <initializer_list>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

namespace metier::records {
namespace {

using nlohmann::json;

constexpr std::size_t kTransitionFields = 8;
constexpr std::size_t kIntermediateFields = 3;
/// Of a sample: the three counts and the time [byte].
constexpr std::size_t kHead = 3 + 8;

/// With quotes. Most texts are names, which are written as they are.
void putText(std::string_view text, std::string& out) {
    const bool plain = std::all_of(text.begin(), text.end(), [](char c) {
        return c >= ' ' && c <= '~' && c != '"' && c != '\\';
    });
    if (plain) {
        out.append(1, '"').append(text).append(1, '"');
    } else {
        out += json(text).dump(-1, ' ', false, json::error_handler_t::replace);
    }
}

/// An array of the kind, the time and the texts.
void putEvent(char kind, UtcTime time, std::initializer_list<std::string_view> texts,
              std::string& out) {
    fmt::format_to(std::back_inserter(out), "[\"{}\",{}", kind, toMicroseconds(time));
    for (const auto text : texts) {
        out += ',';
        putText(text, out);
    }
    out += ']';
}

void put(const Transition& t, std::string& out) {
    putEvent('t', t.time, {t.from, t.to, t.sub_state, t.step, t.reason, t.reason_text}, out);
}

void put(const Intermediate& i, std::string& out) {
    putEvent('i', i.time, {i.value}, out);
}

/// Whether it has that many fields: the kind, a time, and texts.
bool isEvent(const json& fields, std::string_view kind, std::size_t count) {
    if (!fields.is_array() || fields.size() != count || fields[0] != kind ||
        !fields[1].is_number_integer()) {
        return false;
    }
    return std::all_of(fields.begin() + 2, fields.end(),
                       [](const json& field) { return field.is_string(); });
}

void putDouble(double value, Bytes& bytes) {
    auto bits = std::bit_cast<std::uint64_t>(value);
    for (int i = 0; i < 8; ++i, bits >>= 8U) {
        bytes.push_back(static_cast<std::uint8_t>(bits & 0xFFU));
    }
}

double getDouble(const std::uint8_t* bytes) {
    std::uint64_t bits = 0;
    for (unsigned i = 0; i < 8; ++i) {
        bits |= static_cast<std::uint64_t>(bytes[i]) << (8U * i);
    }
    return std::bit_cast<double>(bits);
}

SampleValues getValues(const std::uint8_t* bytes, std::size_t count) {
    std::array<double, SampleValues::kMost> values{};
    for (std::size_t i = 0; i < count; ++i) {
        values.at(i) = getDouble(bytes + 8 * i);
    }
    return SampleValues(std::span(values).first(count));
}

}  // namespace

std::int64_t toMicroseconds(UtcTime time) {
    return std::chrono::floor<std::chrono::microseconds>(time.time_since_epoch()).count();
}

UtcTime fromMicroseconds(std::int64_t time) {
    return UtcTime(std::chrono::duration_cast<UtcTime::duration>(std::chrono::microseconds(time)));
}

std::string encodeEvents(const std::vector<Event>& events) {
    if (events.empty()) {
        return {};
    }
    std::string text;
    char before = '[';
    for (const auto& event : events) {
        text += std::exchange(before, ',');
        std::visit([&](const auto& one) { put(one, text); }, event);
    }
    return text + ']';
}

void decodeEvents(std::string_view text, std::vector<Event>& events) {
    const auto list = json::parse(text, nullptr, false);
    if (!list.is_array()) {
        return;
    }
    for (const auto& f : list) {
        if (isEvent(f, "t", kTransitionFields)) {
            events.emplace_back(Transition{fromMicroseconds(f[1].get<std::int64_t>()), f[2], f[3],
                                           f[4], f[5], f[6], f[7]});
        } else if (isEvent(f, "i", kIntermediateFields)) {
            events.emplace_back(Intermediate{fromMicroseconds(f[1].get<std::int64_t>()), f[2]});
        }
    }
}

void encodeSample(const PathSample& sample, Bytes& bytes) {
    const std::array lists{&sample.actual, &sample.commanded, &sample.force};
    for (const auto* list : lists) {
        bytes.push_back(static_cast<std::uint8_t>(list->size()));
    }
    putDouble(sample.time, bytes);
    for (const auto* list : lists) {
        for (const double value : list->values()) {
            putDouble(value, bytes);
        }
    }
}

std::optional<PathSample> takeSample(std::span<const std::uint8_t>& bytes) {
    if (bytes.size() < kHead) {
        return std::nullopt;
    }
    const std::array<std::size_t, 3> counts{bytes[0], bytes[1], bytes[2]};
    const auto size = kHead + 8 * (counts[0] + counts[1] + counts[2]);
    if (std::any_of(counts.begin(), counts.end(),
                    [](std::size_t n) { return n > SampleValues::kMost; }) ||
        size > bytes.size()) {
        return std::nullopt;
    }
    const auto* values = bytes.data() + kHead;
    PathSample sample{.time = getDouble(bytes.data() + 3),
                      .actual = getValues(values, counts[0]),
                      .commanded = getValues(values + 8 * counts[0], counts[1]),
                      .force = getValues(values + 8 * (counts[0] + counts[1]), counts[2])};
    bytes = bytes.subspan(size);
    return sample;
}

void decodeSamples(std::span<const std::uint8_t> bytes, std::vector<PathSample>& samples) {
    while (auto sample = takeSample(bytes)) {
        samples.push_back(*sample);
    }
}

}  // namespace metier::records
