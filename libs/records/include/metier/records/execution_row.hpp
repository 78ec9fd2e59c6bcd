#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "metier/base/clock.hpp"

namespace metier::records {

/// State of an execution whose server died while it was under way: its end is unknown.
inline constexpr std::string_view kLost = "Lost";
/// Reason of such an execution.
inline constexpr std::string_view kServerLost = "ServerLost";

/// One execution of a skill, started by any client. visitMembers() of members.hpp lists its
/// members.
///
/// Any text is accepted: bytes that are not UTF-8 become U+FFFD when it is written; names are cut
/// after 300 bytes, ids and a reason's text after 2000, JSON after 1,000,000. States and reasons
/// are the names that OPC UA clients see.
///
/// Threading: a value, as all structs here.
struct ExecutionRow {
    /// Number in the store, from 1; 0: it is not in one yet.
    std::int64_t number = 0;
    /// Id that its server gave it; unique within a skill of a server.
    std::string id{};
    /// ApplicationUri of its server.
    std::string server{};
    /// Name of its server in the cell file.
    std::string server_name{};
    /// BrowseName of the Program.
    std::string skill{};
    /// BrowseName of the object to which the Program belongs; may be empty
    std::string controller{};
    /// Name of the arm or gripper that it moves; may be empty.
    std::string device{};
    /// Id of the execution that started it; empty: a client did.
    std::string parent{};
    /// ApplicationUri of the parent; empty: the same server.
    std::string parent_server{};
    /// Id of the session that started it.
    std::string session{};
    /// Name that the client of that session gave.
    std::string client_name{};
    /// Name of the user; empty: anonymous.
    std::string user{};
    /// SHA-1 of the client's certificate, hexadecimal; may be empty.
    std::string thumbprint{};
    /// JSON object, a member for each parameter.
    std::string parameters{};
    /// JSON of the answer to an earlier Check of the same parameters; may be empty.
    std::string check{};
    /// Server's wall clock at its Start.
    UtcTime started{};
    /// Server's wall clock at its end; UtcTime{} while it is under way.
    UtcTime ended{};
    /// State: "Running", "Suspended"; once over "Ready", "Halted" or kLost.
    std::string state{};
    /// Reason of the last transition: "Finished", "ByClient", ...; may be empty.
    std::string reason{};
    /// Text for a person; may be empty.
    std::string reason_text{};
    /// JSON object, a member for each result; empty unless it finished.
    std::string result{};
    /// Number of cycles that the device missed while this ran.
    std::uint64_t missed_cycles = 0;

    /// Whether it has ended.
    /// A lost one is over as well: its end is the last time that is known of it.
    bool isOver() const noexcept { return ended != UtcTime{}; }
};

/// A change of an execution's state, sub-state or step.
///
/// Names are those of OPC UA: states as in ExecutionRow, sub-states as in skill::SubState.
struct Transition {
    /// Server's wall clock.
    UtcTime time{};
    /// State before; the same as `to` if only sub-state or step changed.
    std::string from{};
    /// State after.
    std::string to{};
    /// Sub-state after it; may be empty.
    std::string sub_state{};
    /// Step of a composed skill after it; may be empty.
    std::string step{};
    /// Reason, as in ExecutionRow.
    std::string reason{};
    /// Text for a person, as in ExecutionRow; may be empty.
    std::string reason_text{};
};

/// A value that a skill published while it ran.
/// An execution that the skill started on a server is one too: {"started": {id, skill,
/// server_url}}.
struct Intermediate {
    /// Server's wall clock.
    UtcTime time{};
    /// Value as JSON.
    std::string value{};
};

/// End of an execution.
///
/// Recorder::end() takes it; each execution has one at most.
struct Outcome {
    /// Server's wall clock.
    UtcTime time{};
    /// Last state: "Ready" or "Halted".
    std::string state{};
    /// Reason, as in ExecutionRow.
    std::string reason{};
    /// Text for a person, as in ExecutionRow; may be empty.
    std::string reason_text{};
    /// JSON object; empty unless it finished.
    std::string result{};
    /// Number of cycles that the device missed while this ran.
    std::uint64_t missed_cycles = 0;
};

/// Up to kMost numbers in place: never allocates.
class SampleValues {
public:
    /// Largest number of values: that of axes.
    static constexpr std::size_t kMost = 8;

    /// No values.
    SampleValues() = default;
    /// Takes the first kMost of `values`.
    /// Further ones are dropped without a report. The values are copied.
    explicit SampleValues(std::span<const double> values) noexcept
        : size_(static_cast<std::uint8_t>(std::min(values.size(), kMost))) {
        std::copy_n(values.begin(), size_, values_.begin());
    }

    /// Number of values, 0 to kMost.
    std::size_t size() const noexcept { return size_; }
    /// Whether there are none, as for a quantity that the device does not have.
    bool empty() const noexcept { return size_ == 0; }
    /// Value at that place, from 0; `i` must be less than size(), which is not checked.
    double operator[](std::size_t i) const noexcept { return values_[i]; }
    /// View of the values; valid as long as this object.
    std::span<const double> values() const noexcept { return {values_.data(), size_}; }
    /// Compares number and values exactly; places beyond size() do not count.
    friend bool operator==(const SampleValues& a, const SampleValues& b) noexcept {
        return std::equal(a.values().begin(), a.values().end(), b.values().begin(),
                          b.values().end());
    }

private:
    // Places from size_ on are 0 and never read.
    std::array<double, kMost> values_{};
    std::uint8_t size_ = 0;
};

/// Positions of the axes at one time. Trivially copyable.
/// A missing quantity has no values, so that a record of a gripper or an arm without sensor needs
/// no room for it.
struct PathSample {
    /// Time since the start of the execution [s].
    double time = 0;
    /// Measured joint position, axis 1 first [rad].
    SampleValues actual{};
    /// Commanded joint position [rad]; may be empty.
    SampleValues commanded{};
    /// Force x, y, z [N], torque x, y, z [N m], in the axes of the sensor; may be empty.
    SampleValues force{};
};

}  // namespace metier::records
