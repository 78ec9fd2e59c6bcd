#include "metier/joint_simulator/simulator_drive.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "simulated_arm.hpp"

namespace metier::joint_simulator {
namespace {

using namespace std::chrono_literals;
using device::EndCause;

JointSimulatorOptions fastOptions() {
    auto options = twoAxisOptions();
    options.cycle = 1ms;
    return options;
}

/// Ends after so many set-points and notes how long they took by the arm's time base. The first
/// is asked for before the first cycle has a time.
struct Stretch {
    std::shared_ptr<FunctionSource> source;
    std::shared_ptr<std::chrono::nanoseconds> lasted = std::make_shared<std::chrono::nanoseconds>();

    explicit Stretch(int count) {
        source = std::make_shared<FunctionSource>(
            [count, n = 0, first = SteadyTime(), out = lasted](const auto& state) mutable {
                first = n <= 1 ? state.stamp : first;
                *out = state.stamp - first;
                return ++n > count ? std::nullopt : std::optional(joints(0.0, 0.0));
            });
    }
};

TEST(SimulatorDrive, AsksForOneSetPointPerPeriodOfItsTimeBase) {
    auto arm = twoAxisArm(fastOptions());
    const Stretch stretch(100);
    ASSERT_TRUE(arm->attach(stretch.source));
    const SimulatorDrive drive(*arm);
    ASSERT_TRUE(stretch.source->waitForEnd());
    EXPECT_EQ(stretch.source->ends()[0].first, EndCause::done);
    if (arm->state().missed_cycles == 0) {
        EXPECT_EQ(*stretch.lasted, 99ms);
    }
    EXPECT_GE(*stretch.lasted, 98ms);
}

TEST(SimulatorDrive, KeepsItsLimitsWhenTheThreadIsLate) {
    auto arm = twoAxisArm(fastOptions());
    auto slow = std::make_shared<FunctionSource>(
        [n = 0, position = 0.0](const auto&) mutable -> std::optional<device::JointArray> {
            if (++n % 40 == 0) {  // holds the thread for five periods
                const auto until = std::chrono::steady_clock::now() + 5ms;
                while (std::chrono::steady_clock::now() < until) {
                }
            }
            position += std::min(0.01 * n, 0.5) * 0.001;
            return n > 200 ? std::nullopt : std::optional(joints(position, 0.0));
        });
    ASSERT_TRUE(arm->attach(slow));
    const SimulatorDrive drive(*arm);
    ASSERT_TRUE(slow->waitForEnd());
    EXPECT_EQ(slow->ends()[0].first, EndCause::done) << slow->ends()[0].second.text;
    EXPECT_GE(arm->state().missed_cycles, 15U);
}

TEST(SimulatorDrive, TellsASafetyStopFromItsNotifyingThread) {
    auto arm = twoAxisArm(fastOptions());
    auto source = cruise(0.5, 0.001);
    std::atomic<std::thread::id> teller;
    const auto registration =
        arm->onSafetyChange([&](const auto&) { teller = std::this_thread::get_id(); });
    ASSERT_TRUE(arm->attach(source));
    const SimulatorDrive drive(*arm);
    arm->protectiveStop("fence opened");
    ASSERT_TRUE(source->waitForEnd());
    EXPECT_EQ(source->ends()[0].first, EndCause::safety);
    EXPECT_NE(teller.load(), std::thread::id());
    EXPECT_NE(teller.load(), std::this_thread::get_id());
}

TEST(SimulatorDrive, CanBeEndedAndBegunAgain) {
    auto arm = twoAxisArm(fastOptions());
    for (int i = 0; i < 3; ++i) {
        const Stretch stretch(5);
        ASSERT_TRUE(arm->attach(stretch.source));
        const SimulatorDrive drive(*arm);
        ASSERT_TRUE(stretch.source->waitForEnd());
    }
}

}  // namespace
}  // namespace metier::joint_simulator
