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

/// State of an execution whose server died while it was under way: nobody knows how it ended.
inline constexpr std::string_view kLost = "Lost";
/// Reason of such an execution.
inline constexpr std::string_view kServerLost = "ServerLost";

// What is recorded has its texts; who tells a recorder only shows them: the Views.

/// One execution of a skill, whichever client started it.
///
/// Text may be anything: what is no UTF-8 becomes U+FFFD when it is written; names are cut after
/// 300 bytes, ids and a reason's text after 2000, JSON after 1,000,000. States and reasons are the
/// names that OPC UA clients see.
template <typename Text>
struct BasicExecution {
    std::int64_t number = 0;  ///< within the store, from 1; 0: it is not in one yet
    Text id{};                ///< as its server names it; unique within a skill of a server
    Text server{};            ///< ApplicationUri
    Text server_name{};       ///< as its cell file names it
    Text skill{};             ///< BrowseName of the Program
    Text controller{};        ///< BrowseName of what the Program belongs to; may be empty
    Text device{};            ///< the arm or gripper it moves; may be empty
    Text parent{};            ///< id of the execution that started it; empty: a client did
    Text parent_server{};     ///< ApplicationUri of the parent; empty: the same server
    Text session{};           ///< id of the session that started it
    Text client_name{};       ///< as that session's client calls itself
    Text user{};              ///< empty: anonymous
    Text thumbprint{};        ///< of the client's certificate, hexadecimal; may be empty
    Text parameters{};        ///< JSON object, a member for each parameter
    Text check{};             ///< JSON of what Check said before; may be empty
    UtcTime started{};
    UtcTime ended{};     ///< the epoch while it is under way
    Text state{};        ///< "Running", "Suspended"; once over "Ready", "Halted" or kLost
    Text reason{};       ///< "Finished", "ByClient", ...; may be empty
    Text reason_text{};  ///< for a person; may be empty
    Text result{};       ///< JSON object; empty unless it finished
    std::uint64_t missed_cycles = 0;  ///< of the device, while this ran

    bool isOver() const noexcept { return ended != UtcTime{}; }
    operator BasicExecution<std::string_view>() const {
        return {.number = number,
                .id = id,
                .server = server,
                .server_name = server_name,
                .skill = skill,
                .controller = controller,
                .device = device,
                .parent = parent,
                .parent_server = parent_server,
                .session = session,
                .client_name = client_name,
                .user = user,
                .thumbprint = thumbprint,
                .parameters = parameters,
                .check = check,
                .started = started,
                .ended = ended,
                .state = state,
                .reason = reason,
                .reason_text = reason_text,
                .result = result,
                .missed_cycles = missed_cycles};
    }
};
using Execution = BasicExecution<std::string>;
using ExecutionView = BasicExecution<std::string_view>;

/// A change of an execution's state, sub-state or step.
template <typename Text>
struct BasicTransition {
    UtcTime time{};
    Text from{};       ///< state; the same as `to` if only sub-state or step changed
    Text to{};         ///< state
    Text sub_state{};  ///< after it; may be empty
    Text step{};       ///< of a composed skill, after it; may be empty
    Text reason{};
    Text reason_text{};

    operator BasicTransition<std::string_view>() const {
        return {.time = time,
                .from = from,
                .to = to,
                .sub_state = sub_state,
                .step = step,
                .reason = reason,
                .reason_text = reason_text};
    }
};
using Transition = BasicTransition<std::string>;
using TransitionView = BasicTransition<std::string_view>;

/// What a skill told while it ran.
template <typename Text>
struct BasicIntermediate {
    UtcTime time{};
    Text value{};  ///< JSON

    operator BasicIntermediate<std::string_view>() const { return {.time = time, .value = value}; }
};
using Intermediate = BasicIntermediate<std::string>;
using IntermediateView = BasicIntermediate<std::string_view>;

/// How an execution ended.
template <typename Text>
struct BasicOutcome {
    UtcTime time{};
    Text state{};  ///< "Ready" or "Halted"
    Text reason{};
    Text reason_text{};
    Text result{};                    ///< JSON object; empty unless it finished
    std::uint64_t missed_cycles = 0;  ///< of the device, while this ran

    operator BasicOutcome<std::string_view>() const {
        return {.time = time,
                .state = state,
                .reason = reason,
                .reason_text = reason_text,
                .result = result,
                .missed_cycles = missed_cycles};
    }
};
using Outcome = BasicOutcome<std::string>;
using OutcomeView = BasicOutcome<std::string_view>;

/// An execution with nothing between its begin and its end.
struct WholeExecution {
    const ExecutionView& execution;
    const TransitionView& first;
    const TransitionView& last;
    const OutcomeView& outcome;
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

/// Where the axes were at one time. Trivially copyable.
struct PathSample {
    double time = 0;           ///< since the start of the execution [s]
    SampleValues actual{};     ///< joint position, axis 1 first [rad]
    SampleValues commanded{};  ///< joint position [rad]; may be empty
    SampleValues force{};      ///< fx, fy, fz [N], tx, ty, tz [Nm], tool frame; may be empty
};

}  // namespace metier::records
