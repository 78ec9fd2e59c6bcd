#include "order_desk.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace metier::wsg50_driver::testing {
namespace {

constexpr Motion kMotion{MotionKind::move, 0.060, 0.1, 20.0};

TEST(OrderDesk, TakesNothingUntilItIsOpenAndOnceItIsClosed) {
    OrderDesk desk;
    desk.close({Errc::connection_lost, "no gripper"});
    const auto closed = desk.ask(kMotion, [](const auto&) {});
    ASSERT_FALSE(closed);
    EXPECT_EQ(closed.error().message, "no gripper");
    EXPECT_FALSE(desk.takeMotion());
    desk.open();
    EXPECT_TRUE(desk.ask(kMotion, [](const auto&) {}));
    EXPECT_TRUE(desk.takeMotion());
    EXPECT_FALSE(desk.takeMotion()) << "once";
}

TEST(OrderDesk, IsOccupiedUntilTheOutcomeIsThereAndFreeOnceItWasTold) {
    OrderDesk desk;
    desk.open();
    EXPECT_FALSE(desk.occupied());
    int told = 0;
    ASSERT_TRUE(desk.ask(kMotion, [&](const auto& outcome) {
        EXPECT_NEAR(outcome->width, 0.06, 1e-9);
        ++told;
    }));
    EXPECT_TRUE(desk.occupied());
    desk.dispatch();
    EXPECT_EQ(told, 0) << "there is no outcome yet";
    desk.endMotion(device::GripperOutcome{0.06, false});
    EXPECT_FALSE(desk.occupied());
    EXPECT_FALSE(desk.takeMotion()) << "it has ended before it was taken";
    desk.endMotion(fail(Errc::cancelled, "a second end"));
    EXPECT_EQ(desk.ask(kMotion, {}).error().code, Errc::resource_unavailable);
    desk.dispatch();
    desk.dispatch();
    EXPECT_EQ(told, 1);
    EXPECT_TRUE(desk.ask(kMotion, [](const auto&) {}));
}

TEST(OrderDesk, TellsNobodyOfAnEndThatNobodyAskedFor) {
    OrderDesk desk;
    desk.open();
    desk.endMotion(fail(Errc::cancelled, "stopped"));
    desk.dispatch();
    EXPECT_FALSE(desk.occupied());
}

// For the thread sanitizer: clients ask, the gripper's thread takes and ends, its notifier tells.
TEST(OrderDesk, MayBeUsedByManyThreads) {
    OrderDesk desk;
    desk.open();
    std::atomic<bool> done{false};
    std::atomic<int> told{0};
    {
        const std::jthread gripper([&] {
            while (!done.load()) {
                if (desk.takeMotion()) {
                    desk.close({Errc::connection_lost, "no gripper"});
                    desk.open();
                    desk.endMotion(device::GripperOutcome{0.06, false});
                }
            }
        });
        const std::jthread notifier([&] {
            while (!done.load()) {
                desk.dispatch();
            }
        });
        const std::jthread client([&] {
            while (!done.load()) {
                static_cast<void>(desk.occupied());
            }
        });
        for (int i = 0; i < 200;) {
            if (desk.ask(kMotion, [&](const auto&) { ++told; })) {
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
