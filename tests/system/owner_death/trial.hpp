#pragma once

#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "../metier_program.hpp"
#include "cable.hpp"
#include "commander.hpp"
#include "metier/base/queue.hpp"
#include "metier/base/wake_up_delay.hpp"
#include "owned_server.hpp"

namespace metier::system_tests {

/// Fault of the client that has control.
enum class Fault {
    killed,     ///< kill -9
    stopped,    ///< SIGSTOP
    link_down,  ///< the cable is unplugged
    dropped,    ///< no packet passes, in either direction
    one_way,    ///< the client's packets do not arrive, it lives
    half_open,  ///< the same, and it is killed: its RST does not arrive either
    closed,     ///< it closes its session without giving control back
    silent,     ///< it lives, but sends no more heartbeats; then it commands again
    stale,      ///< SIGSTOP for longer than the lease; then it wakes up and commands again
};
inline constexpr std::array kFaults{Fault::killed,  Fault::stopped, Fault::link_down,
                                    Fault::dropped, Fault::one_way, Fault::half_open,
                                    Fault::closed,  Fault::silent,  Fault::stale};
inline constexpr std::array kStates{AtFault::ready, AtFault::running, AtFault::suspended,
                                    AtFault::suspending, AtFault::halting};
inline constexpr std::array kPolicies{skill::OwnerLossAction::halt, skill::OwnerLossAction::suspend,
                                      skill::OwnerLossAction::keep_going};
inline constexpr int kPoints = 20;  ///< of a move

std::string_view toString(Fault fault);
std::string_view toString(AtFault state);
/// Whether it takes a Cable.
bool needsCable(Fault fault);

struct Trial {
    Fault fault = Fault::killed;
    AtFault at = AtFault::running;
    skill::OwnerLossAction policy = skill::OwnerLossAction::halt;
    std::chrono::milliseconds lease{300};
    int point = kPoints / 2;  ///< in the part of the move in which a loss can still come, 0 to 19
};
std::string toString(const Trial& trial);

/// Times are those that server and client took on this machine.
struct Outcome {
    /// Time from the end of the lease, begun by the last heartbeat that the server answered, to the
    /// stop [ms]. The heartbeat counts from its sending, so the value is never too small.
    double after_lease_ms = 0;
    double after_fault_ms = 0;            ///< from the fault to the stop [ms]
    std::chrono::nanoseconds load{};      ///< longest delay with which threads woke up meanwhile
    std::optional<double> standstill_ms;  ///< from the stop to a transition with OwnerLost [ms]
    int refused = 0;                      ///< commands of a stale commander, all of those it tried
    std::string defect;                   ///< mistake that was found; empty: none
};

/// Whether the bounds of time hold as they are, or are widened by how late threads wake up.
enum class Bounds { strict, by_load };

/// One arm, whose commanders die one after the other.
///
/// Threading: one thread.
class DeathRow {
public:
    /// \param serve arguments of `metier` for the server
    /// \param cable on which the commanders are; null: on this machine. Must outlive this.
    DeathRow(const std::vector<std::string>& serve, const std::string& skill, Cable* cable,
             Bounds bounds = Bounds::by_load);
    ~DeathRow();
    DeathRow(const DeathRow&) = delete;
    DeathRow& operator=(const DeathRow&) = delete;

    /// Errors: throws if there is no trial, since a client does not get as far as the fault.
    Outcome run(const Trial& trial);

private:
    struct Seen {
        std::optional<UtcTime> last_beat;
        std::vector<std::string> accepted;
        int refused = 0;
    };

    skill::ValueMap nextMove();
    link::ChildProcess startCommander(const Trial& trial);
    std::string readUntil(link::ChildProcess& commander, const std::string& word, Seen& seen);
    void strike(const Trial& trial, link::ChildProcess& commander);
    void judgeTimes(const Trial& trial, Outcome& outcome) const;
    void judgeEnd(const Trial& trial, Outcome& outcome, UtcTime stop);
    void judgeTransition(const Trial& trial, Outcome& outcome, UtcTime stop);
    void judgeStale(const Trial& trial, link::ChildProcess& commander, Seen& seen,
                    Outcome& outcome);
    bool atTarget();
    std::string movedWithin(std::chrono::milliseconds time);
    void makeReady();

    OwnedServer server_;
    Cable* cable_;
    Bounds bounds_;
    WakeUpDelay meter_;
    Queue<skill::TransitionEvent> transitions_{1000};
    std::unique_ptr<opcua::Client> watcher_;
    client::SkillHandle skill_;
    std::vector<double> home_;
    skill::ValueMap move_;
    std::chrono::milliseconds duration_{};  // of that move, undisturbed
};

}  // namespace metier::system_tests
