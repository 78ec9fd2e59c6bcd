#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "database.hpp"
#include "metier/records/execution_row.hpp"

namespace metier::records {

/// Parts that an execution can have; the key of a part is number * kMostParts + count.
inline constexpr std::int64_t kMostParts = 1'048'576;

/// Event of an execution while it is under way.
using Event = std::variant<Transition, Intermediate>;

/// Microseconds since 1970-01-01 UTC, as all tables have times.
std::int64_t toMicroseconds(UtcTime time);
UtcTime fromMicroseconds(std::int64_t time);

/// Events as JSON, the members of each as visitMembers() lists them: ["t", time, from, to,
/// sub-state, step, reason, text], ["i", time, value].
std::string encodeEvents(const std::vector<Event>& events);
/// Appends what `text` holds; what is no event is passed over.
void decodeEvents(std::string_view text, std::vector<Event>& events);

/// Appends a sample: the number of values of actual, commanded and force, one byte each, then time
/// and values as little-endian doubles.
void encodeSample(const PathSample& sample, Bytes& bytes);
/// Takes one sample from the front of `bytes`; nothing if they are none.
std::optional<PathSample> takeSample(std::span<const std::uint8_t>& bytes);
/// Appends what `bytes` holds, as far as it is whole.
void decodeSamples(std::span<const std::uint8_t> bytes, std::vector<PathSample>& samples);

}  // namespace metier::records
