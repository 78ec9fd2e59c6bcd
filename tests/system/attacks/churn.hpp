#pragma once

#include <chrono>
#include <filesystem>
#include <string>

#include "cable.hpp"
#include "halt_meter.hpp"
#include "metier/base/wake_up_delay.hpp"
#include "siege.hpp"

namespace metier::system_tests {

/// Longest time until an operator has a Session while strangers come and go.
inline constexpr double kConnectMaxMs = 2'000;

struct ChurnOutcome {
    Durations quiet;             ///< connecting before the attack
    Durations near;              ///< connecting from this machine, strangers from another address
    Durations far;               ///< connecting from the strangers' own address
    std::uint64_t attempts = 0;  ///< attempts that these connections took
    AttackCount attack;
    std::string defect;  ///< empty: nothing
};

/// A closed server, an operator whom it trusts, and strangers: connections that send nothing, that
/// send only Hello, that open channels without security, that ask for Sessions, and that show a
/// certificate which is not trusted; as many as possible, all of the time.
///
/// Threading: one thread, as BenchServer; the operator at the far end has one of his own.
class Churn {
public:
    /// \param folder for certificates; is emptied
    Churn(Cable& cable, std::filesystem::path folder, HaltBounds bounds = HaltBounds::by_load);

    ChurnOutcome run(std::chrono::milliseconds time);

private:
    struct Connecting {
        std::vector<double> took_ms;
        std::uint64_t attempts = 0;
    };
    opcua::ClientOptions clientOf(const security::Identity& identity) const;
    Connecting connectAgainAndAgain(const std::string& url, SteadyTime end) const;
    std::string firstWordsOfAStranger() const;
    std::string judge(const ChurnOutcome& outcome, double load_ms) const;

    Cable& cable_;
    HaltBounds bounds_;
    std::filesystem::path folder_;
    security::Identity operator_;
    WakeUpDelay load_;
    BenchServer server_;
};

}  // namespace metier::system_tests
