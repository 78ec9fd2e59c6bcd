#include "parts.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <nlohmann/json.hpp>
#include <utility>

#include "metier/records/members.hpp"

namespace metier::records {
namespace {

using nlohmann::json;

/// Size of the begin of a sample, the three counts and the time [byte].
constexpr std::size_t kHead = 3 + 8;

json stored(UtcTime time) {
    return toMicroseconds(time);
}
json stored(const std::string& text) {
    return text;
}

bool read(const json& field, UtcTime& time) {
    time = field.is_number_integer() ? fromMicroseconds(field.get<std::int64_t>()) : UtcTime{};
    return field.is_number_integer();
}
bool read(const json& field, std::string& text) {
    text = field.is_string() ? field.get<std::string>() : std::string();
    return field.is_string();
}

/// An array of the kind and the members.
template <typename T>
json fieldsOf(std::string_view kind, const T& event) {
    auto fields = json::array({kind});
    visitMembers(event, [&fields](const Member& /*member*/, const auto& value) {
        fields.push_back(stored(value));
    });
    return fields;
}

json fieldsOf(const Event& event) {
    const auto* transition = std::get_if<Transition>(&event);
    return transition != nullptr ? fieldsOf("t", *transition)
                                 : fieldsOf("i", std::get<Intermediate>(event));
}

/// Appends the event if the fields are one of that kind.
template <typename T>
void decode(std::string_view kind, const json& fields, std::vector<Event>& events) {
    if (!fields.is_array() || fields.empty() || fields[0] != kind) {
        return;
    }
    T event;
    std::size_t next = 1;
    bool whole = true;
    visitMembers(event, [&](const Member& /*member*/, auto& value) {
        whole = whole && next < fields.size() && read(fields[next], value);
        ++next;
    });
    if (whole && next == fields.size()) {
        events.emplace_back(std::move(event));
    }
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
    auto list = json::array();
    for (const auto& event : events) {
        list.push_back(fieldsOf(event));
    }
    return list.empty() ? std::string() : list.dump(-1, ' ', false, json::error_handler_t::replace);
}

void decodeEvents(std::string_view text, std::vector<Event>& events) {
    const auto list = json::parse(text, nullptr, false);
    if (!list.is_array()) {
        return;
    }
    for (const auto& fields : list) {
        decode<Transition>("t", fields, events);
        decode<Intermediate>("i", fields, events);
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
