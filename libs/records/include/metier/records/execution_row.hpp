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
struct ExecutionRow {
    std::int64_t number = 0;    ///< number in the store, from 1; 0: it is not in one yet
    std::string id{};           ///< id that its server gave it; unique within a skill of a server
    std::string server{};       ///< ApplicationUri
    std::string server_name{};  ///< its name in the cell file
    std::string skill{};        ///< BrowseName of the Program
    /// BrowseName of the object to which the Program belongs; may be empty
    std::string controller{};
    std::string device{};         ///< the arm or gripper it moves; may be empty
    std::string parent{};         ///< id of the execution that started it; empty: a client did
    std::string parent_server{};  ///< ApplicationUri of the parent; empty: the same server
    std::string session{};        ///< id of the session that started it
    std::string client_name{};    ///< name that the client of that session gave
    std::string user{};           ///< empty: anonymous
    std::string thumbprint{};     ///< of the client's certificate, hexadecimal; may be empty
    std::string parameters{};     ///< JSON object, a member for each parameter
    /// JSON of the answer to an earlier Check of the same parameters; may be empty
    std::string check{};
    UtcTime started{};
    UtcTime ended{};            ///< UtcTime{} while it is under way
    std::string state{};        ///< "Running", "Suspended"; once over "Ready", "Halted" or kLost
    std::string reason{};       ///< "Finished", "ByClient", ...; may be empty
    std::string reason_text{};  ///< for a person; may be empty
    std::string result{};       ///< JSON object; empty unless it finished
    std::uint64_t missed_cycles = 0;  ///< of the device, while this ran

    bool isOver() const noexcept { return ended != UtcTime{}; }
};

/// A change of an execution's state, sub-state or step.
struct Transition {
    UtcTime time{};
    std::string from{};       ///< state; the same as `to` if only sub-state or step changed
    std::string to{};         ///< state
    std::string sub_state{};  ///< after it; may be empty
    std::string step{};       ///< of a composed skill, after it; may be empty
    std::string reason{};
    std::string reason_text{};
};

/// A value that a skill published while it ran.
struct Intermediate {
    UtcTime time{};
    std::string value{};  ///< JSON
};

/// End of an execution.
struct Outcome {
    UtcTime time{};
    std::string state{};  ///< "Ready" or "Halted"
    std::string reason{};
    std::string reason_text{};
    std::string result{};             ///< JSON object; empty unless it finished
    std::uint64_t missed_cycles = 0;  ///< of the device, while this ran
};

/// Up to kMost numbers in place: never allocates.
class SampleValues {
public:
    static constexpr std::size_t kMost = 8;

    SampleValues() = default;
    /// Takes the first kMost of `values`.
    explicit SampleValues(std::span<const double> values) noexcept
        : size_(static_cast<std::uint8_t>(std::min(values.size(), kMost))) {
        std::copy_n(values.begin(), size_, values_.begin());
    }

    std::size_t size() const noexcept { return size_; }
    bool empty() const noexcept { return size_ == 0; }
    double operator[](std::size_t i) const noexcept { return values_[i]; }
    std::span<const double> values() const noexcept { return {values_.data(), size_}; }
    friend bool operator==(const SampleValues& a, const SampleValues& b) noexcept {
        return std::equal(a.values().begin(), a.values().end(), b.values().begin(),
                          b.values().end());
    }

private:
    std::array<double, kMost> values_{};
    std::uint8_t size_ = 0;
};

/// Positions of the axes at one time. Trivially copyable.
struct PathSample {
    double time = 0;           ///< since the start of the execution [s]
    SampleValues actual{};     ///< joint position, axis 1 first [rad]
    SampleValues commanded{};  ///< joint position [rad]; may be empty
    SampleValues force{};      ///< fx, fy, fz [N], tx, ty, tz [Nm], tool frame; may be empty
};

}  // namespace metier::records
