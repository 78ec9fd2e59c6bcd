// The owner's death in short: each fault once, in some states. In bulk: metier_owner_soak.
#include <gmock/gmock.h>

#include "owner_death/trial.hpp"

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;
using enum skill::OwnerLossAction;

// A commander beats four times in it, also on a machine that runs other tests.
constexpr auto kLease = 1000ms;

/// The simulated iiwa, whose commanders are on this machine: no root is needed.
class OwnersDeath : public ::testing::Test {
protected:
    void expectMastered(const std::vector<Trial>& trials) {
        for (const auto& trial : trials) {
            const auto outcome = row_.run(trial);
            EXPECT_EQ(outcome.defect, "") << toString(trial);
        }
    }

    DeathRow row_{{"serve", simulatedCell().string(), "--server", "iiwa", "--port", "0"},
                  "JointPtpMoveSkill",
                  nullptr};
};

// Halted, Suspended or Ready, OwnerLost, the stop within the lease and 100 ms.
TEST_F(OwnersDeath, StopsARunningArmWithinTheLeaseAsItsStartSays) {
    expectMastered({{Fault::killed, AtFault::running, halt, kLease, 2},
                    {Fault::killed, AtFault::running, suspend, kLease, 8},
                    {Fault::stopped, AtFault::running, halt, kLease, 12},
                    {Fault::stopped, AtFault::running, keep_going, kLease, 6},
                    {Fault::silent, AtFault::running, suspend, kLease, 16}});
}

// The stop comes at once: no lease has to run out. Continue goes on; the session's end is not a
// second loss.
TEST_F(OwnersDeath, StopsARunningArmAtOnceWhenTheSessionIsClosed) {
    expectMastered({{Fault::closed, AtFault::running, halt, kLease, 10},
                    {Fault::closed, AtFault::running, suspend, kLease, 4},
                    {Fault::closed, AtFault::running, keep_going, kLease, 10}});
}

// Ready and Suspended stay as they are; braking ends as it was meant to, or Halted, OwnerLost.
TEST_F(OwnersDeath, LeavesAnArmAtRestWhereItIs) {
    expectMastered({{Fault::killed, AtFault::ready, halt, kLease},
                    {Fault::killed, AtFault::suspended, halt, kLease},
                    {Fault::stopped, AtFault::suspending, suspend, kLease},
                    {Fault::closed, AtFault::suspending, halt, kLease},
                    {Fault::closed, AtFault::halting, halt, kLease}});
}

// It wakes up after its lease and tries every command, with its epoch and without.
TEST_F(OwnersDeath, RefusesEverythingToACommanderWhoseTimeIsOver) {
    expectMastered({{Fault::stale, AtFault::running, halt, kLease, 10},
                    {Fault::stale, AtFault::running, suspend, kLease, 10},
                    {Fault::stale, AtFault::ready, halt, kLease},
                    {Fault::silent, AtFault::suspended, halt, kLease}});
}

// The same over a cable between two network namespaces, which can be unplugged.
TEST(OwnersDeathOnTheNetwork, StopsAnArmThatTheNetworkCutsOff) {
    if (const auto obstacle = Cable::obstacle(); !obstacle.empty()) {
        GTEST_SKIP() << "NOT TESTED: link down, packets dropped, half-open connection: "
                     << obstacle;
    }
    Cable cable;
    DeathRow row({"serve", simulatedCell().string(), "--server", "iiwa", "--port", "0"},
                 "JointPtpMoveSkill", &cable);
    const std::vector<Trial> trials{{Fault::link_down, AtFault::running, halt, kLease, 5},
                                    {Fault::dropped, AtFault::running, suspend, kLease, 10},
                                    {Fault::one_way, AtFault::running, halt, kLease, 15},
                                    {Fault::half_open, AtFault::running, halt, kLease, 10}};
    for (const auto& trial : trials) {
        EXPECT_EQ(row.run(trial).defect, "") << toString(trial);
    }
}

}  // namespace
}  // namespace metier::system_tests
