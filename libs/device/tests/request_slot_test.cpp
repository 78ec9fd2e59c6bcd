#include "metier/device/request_slot.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <string>
#include <thread>

namespace metier::device {
namespace {

using Slot = RequestSlot<std::string, int>;

TEST(RequestSlot, HandsARequestOverAndItsEndBack) {
    Slot slot;
    int reported = 0;
    ASSERT_TRUE(slot.post("grasp", [&](int end) { reported = end; }));
    ASSERT_NE(slot.posted(), nullptr);
    EXPECT_TRUE(slot.waiting());
    const auto* request = slot.take();
    ASSERT_NE(request, nullptr);
    EXPECT_EQ(*request, "grasp");
    EXPECT_FALSE(slot.waiting());
    EXPECT_EQ(slot.take(), nullptr) << "once";
    EXPECT_EQ(slot.posted(), request) << "until its end";
    slot.dispatch();
    EXPECT_EQ(reported, 0) << "it has not ended";
    slot.end(7);
    EXPECT_EQ(slot.posted(), nullptr);
    EXPECT_TRUE(slot.toTell());
    slot.end(8);
    slot.dispatch();
    slot.dispatch();
    EXPECT_EQ(reported, 7);
    EXPECT_FALSE(slot.toTell());
}

TEST(RequestSlot, HasRoomForOneUntilTheEndIsDispatched) {
    Slot slot;
    EXPECT_FALSE(slot.occupied());
    ASSERT_TRUE(slot.post("first", [&](int) {
        EXPECT_FALSE(slot.occupied());
        EXPECT_TRUE(slot.post("from inside of the report", [](int) {}));
    }));
    EXPECT_EQ(slot.post("second", [](int) {}).error().code, Errc::resource_unavailable);
    slot.end(0);
    EXPECT_TRUE(slot.occupied());
    EXPECT_EQ(slot.post("third", [](int) {}).error().code, Errc::resource_unavailable);
    slot.dispatch();
    EXPECT_TRUE(slot.occupied());
}

TEST(RequestSlot, EndsARequestThatWasNeverTaken) {
    Slot slot;
    int reported = 0;
    ASSERT_TRUE(slot.post("grasp", [&](int end) { reported = end; }));
    slot.end(3);
    EXPECT_EQ(slot.take(), nullptr);
    slot.dispatch();
    EXPECT_EQ(reported, 3);
}

TEST(RequestSlot, ReportsNoEndThatNobodyAskedFor) {
    Slot slot;
    slot.end(1);
    EXPECT_FALSE(slot.toTell());
    slot.dispatch();
    EXPECT_FALSE(slot.occupied());
}

TEST(RequestSlot, StopsOnlyTheRequestThatWasThere) {
    Slot slot;
    slot.stop();
    EXPECT_FALSE(slot.takeStop()) << "there is none";
    ASSERT_TRUE(slot.post("first", [](int) {}));
    EXPECT_FALSE(slot.takeStop());
    slot.stop();
    EXPECT_TRUE(slot.takeStop());
    EXPECT_FALSE(slot.takeStop()) << "once";
    slot.stop();
    slot.end(0);
    slot.dispatch();
    ASSERT_TRUE(slot.post("second", [](int) {}));
    EXPECT_FALSE(slot.takeStop()) << "it was for the one before";
}

TEST(RequestSlot, RefusesWithItsErrorWhileItIsClosed) {
    Slot slot;
    int reported = 0;
    ASSERT_TRUE(slot.post("first", [&](int end) { reported = end; }));
    slot.close({Errc::connection_lost, "no gripper"});
    slot.end(2);
    slot.dispatch();
    EXPECT_EQ(reported, 2) << "what was accepted still ends";
    const auto refused = slot.post("second", [](int) {});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::connection_lost);
    EXPECT_EQ(refused.error().message, "no gripper");
    slot.open();
    EXPECT_TRUE(slot.post("third", [](int) {}));
}

// For the thread sanitizer: clients post, one thread serves, another one reports.
TEST(RequestSlot, MayBeUsedByManyThreads) {
    RequestSlot<std::string, std::string> slot;
    std::atomic<bool> done{false};
    std::atomic<int> reported{0};
    const auto serve = [&] {
        if (const auto* request = slot.take()) {
            slot.close({Errc::connection_lost, "no gripper"});
            slot.open();
            static_cast<void>(slot.takeStop());
            slot.end(*request + " done");
        }
    };
    {
        const std::jthread server([&] {
            while (!done.load()) {
                serve();
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
                slot.stop();
            }
        });
        for (int i = 0; i < 200;) {
            const auto text = std::to_string(i);
            if (slot.post(text, [&, text](const std::string& end) {
                    EXPECT_EQ(end, text + " done");
                    ++reported;
                })) {
                ++i;
            } else {
                std::this_thread::yield();
            }
        }
        while (reported.load() < 200) {
            std::this_thread::yield();
        }
        done.store(true);
    }
    EXPECT_EQ(reported.load(), 200);
}

}  // namespace
}  // namespace metier::device
