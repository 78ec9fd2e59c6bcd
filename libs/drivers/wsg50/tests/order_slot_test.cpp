#include "order_slot.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace metier::wsg50_driver::testing {
namespace {

constexpr Motion kMotion{MotionKind::move, 0.060, 0.1, 20.0};

TEST(OrderSlot, TakesNothingUntilItIsOpenAndOnceItIsClosed) {
    OrderSlot slot;
    slot.close({Errc::connection_lost, "no gripper"});
    const auto closed = slot.ask(kMotion, [](const auto&) {});
    ASSERT_FALSE(closed);
    EXPECT_EQ(closed.error().message, "no gripper");
    EXPECT_FALSE(slot.takeMotion());
    slot.open();
    EXPECT_TRUE(slot.ask(kMotion, [](const auto&) {}));
    EXPECT_TRUE(slot.takeMotion());
    EXPECT_FALSE(slot.takeMotion()) << "once";
}

TEST(OrderSlot, IsOccupiedUntilTheOutcomeIsThereAndFreeOnceItWasTold) {
    OrderSlot slot;
    slot.open();
    EXPECT_FALSE(slot.occupied());
    int told = 0;
    ASSERT_TRUE(slot.ask(kMotion, [&](const auto& outcome) {
        EXPECT_NEAR(outcome->width, 0.06, 1e-9);
        ++told;
    }));
    EXPECT_TRUE(slot.occupied());
    slot.dispatch();
    EXPECT_EQ(told, 0) << "there is no outcome yet";
    slot.endMotion(device::GripperOutcome{0.06, false});
    EXPECT_FALSE(slot.occupied());
    EXPECT_FALSE(slot.takeMotion()) << "it has ended before it was taken";
    slot.endMotion(fail(Errc::cancelled, "a second end"));
    EXPECT_EQ(slot.ask(kMotion, {}).error().code, Errc::resource_unavailable);
    slot.dispatch();
    slot.dispatch();
    EXPECT_EQ(told, 1);
    EXPECT_TRUE(slot.ask(kMotion, [](const auto&) {}));
}

TEST(OrderSlot, TellsNobodyOfAnEndThatNobodyAskedFor) {
    OrderSlot slot;
    slot.open();
    slot.endMotion(fail(Errc::cancelled, "stopped"));
    slot.dispatch();
    EXPECT_FALSE(slot.occupied());
}

// For the thread sanitizer: clients ask, the gripper's thread takes and ends, its notifier tells.
TEST(OrderSlot, MayBeUsedByManyThreads) {
    OrderSlot slot;
    slot.open();
    std::atomic<bool> done{false};
    std::atomic<int> told{0};
    {
        const std::jthread gripper([&] {
            while (!done.load()) {
                if (slot.takeMotion()) {
                    slot.close({Errc::connection_lost, "no gripper"});
                    slot.open();
                    slot.endMotion(device::GripperOutcome{0.06, false});
                }
            }
        });
        const std::jthread notifier([&] {
            while (!done.load()) {
                slot.dispatch();
            }
        });
        const std::jthread client([&] {
            while (!done.load()) {
                static_cast<void>(slot.occupied());
            }
        });
        for (int i = 0; i < 200;) {
            if (slot.ask(kMotion, [&](const auto&) { ++told; })) {
                ++i;
            } else {
                std::this_thread::yield();
            }
        }
        while (told.load() < 200) {
            std::this_thread::yield();
        }
        done.store(true);
    }
    EXPECT_EQ(told.load(), 200);
}

}  // namespace
}  // namespace metier::wsg50_driver::testing
