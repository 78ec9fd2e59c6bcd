#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "../bench_server.hpp"
#include "attack.hpp"
#include "cable.hpp"
#include "halt_meter.hpp"
#include "metier/base/wake_up_delay.hpp"
#include "metier/link/child_process.hpp"

namespace metier::system_tests {

/// Longest time of a Halt while a server is attacked.
inline constexpr double kHaltP99Ms = 50;
inline constexpr double kHaltMaxMs = 200;

/// Whether these bounds hold as they are, or are widened by the time of a Halt without an attack
/// and by the delay with which threads wake up.
enum class HaltBounds { strict, by_load };

/// A process at the other end of a Cable that attacks a server of this process.
///
/// Threading: one thread.
class Attacker {
public:
    /// Returns once the attack is in full swing. Throws if it does not get there within a minute.
    /// \param order without address and port
    Attacker(const Cable& cable, const std::string& url, AttackOrder order);
    /// Ends it. \return what it did
    AttackCount end();

private:
    link::ChildProcess process_;
};

struct SiegeOutcome {
    HaltTimes quiet;   ///< before the attack
    HaltTimes during;  ///< the attack
    AttackCount attack;
    double load_ms = 0;  ///< longest delay with which threads woke up
    std::string defect;  ///< mistake that was found; empty: none
};

/// A server of skills that is attacked over a cable while an operator on this machine halts one.
///
/// Threading: one thread, as BenchServer.
class Siege {
public:
    explicit Siege(Cable& cable, const opcua::ServerLimits& limits = {},
                   HaltBounds bounds = HaltBounds::by_load);

    SiegeOutcome run(Attack attack, std::chrono::milliseconds time);

private:
    std::string judge(const SiegeOutcome& outcome) const;

    Cable& cable_;
    HaltBounds bounds_;
    WakeUpDelay load_;
    BenchServer server_;
    HaltMeter operator_;
    std::vector<std::string> skills_;  // NodeIds of those that clients may start and halt
};

}  // namespace metier::system_tests
