#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/error.hpp"

namespace metier::system_tests {

/// Events for a server: commands of clients, and events of clients and of the device.
enum class Act : std::uint8_t {
    write_target,      ///< value / 100 - 1 rad
    write_speed,       ///< value / 100
    write_badly,       ///< over its limit
    write_wrong_type,  ///< a text
    write_null,        ///< the default
    start,
    start_with,  ///< value: see StartChoice
    check,       ///< value: see StartChoice
    suspend,
    resume,
    halt,
    reset,
    acquire,  ///< value: OnOwnerLoss
    heartbeat,
    release,
    init_lock,
    renew_lock,
    exit_lock,
    break_lock,
    get_execution,   ///< value: its name
    close_session,   ///< and a new one
    cut_connection,  ///< carol's, whose session stays until its time-out; and a new one
    at_rest,         ///< the work stands still
    finish,          ///< the work has done its work
    force_exceeded,  ///< the work fails
    device_lost,
    fault_stays,    ///< from now on Reset is refused
    fault_is_gone,  ///< and from now on it is not
    wait,           ///< value * 10 ms
};
constexpr std::size_t kActs = static_cast<std::size_t>(Act::wait) + 1;
constexpr std::size_t kClients = 3;
constexpr std::size_t kSkills = 2;
/// Values of a step are below.
constexpr std::uint32_t kValues = 8192;

struct Step {
    Act act = Act::wait;
    std::size_t client = 0;
    std::size_t skill = 0;
    std::uint32_t value = 0;

    bool operator==(const Step&) const = default;
};
using History = std::vector<Step>;

/// Choices of a start_with.
struct StartChoice {
    explicit StartChoice(std::uint32_t value);

    std::uint32_t name;  ///< 0: the server gives it one
    enum class Epoch : std::uint8_t { none, own, others } epoch;
    enum class Deadline : std::uint8_t { none, to_come, passed } deadline;
    std::uint32_t on_owner_loss;
    bool with_target;
    double speed;  ///< over its limit if it is over 1
};

/// "start_with carol second 137"; names, so that a person can read it.
std::string toString(const Step& step);
std::string toString(const History& history);
/// The inverse. Errors: invalid_argument, with the line.
Result<History> historyFrom(std::string_view text);

std::string_view clientName(std::size_t client);
std::string_view skillName(std::size_t skill);

/// The same steps for the same seed.
class RandomSteps {
public:
    explicit RandomSteps(std::uint64_t seed) : random_(seed) {}
    History history(std::size_t length);

private:
    Step next();
    std::uint32_t below(std::uint32_t limit) {
        return static_cast<std::uint32_t>(random_() % limit);
    }

    std::mt19937_64 random_;
};

}  // namespace metier::system_tests
