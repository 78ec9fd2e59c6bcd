#include "metier/device/safety_publisher.hpp"

#include <gmock/gmock.h>

#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace metier::device {
namespace {

using ::testing::ElementsAre;

struct Heard {
    SafetyPublisher publisher{{SafetyState::disconnected, "not connected yet", false}};
    std::vector<std::string> texts{};
    Registration registration =
        publisher.onChange([this](const Safety& safety) { texts.push_back(safety.text); });
};

TEST(SafetyPublisher, TellsAChangeOnceWithItsText) {
    Heard heard;
    heard.publisher.set({SafetyState::fault, "fast stop", false});
    EXPECT_TRUE(heard.publisher.toTell());
    EXPECT_EQ(heard.publisher.state(), SafetyState::fault);
    heard.publisher.dispatch();
    heard.publisher.dispatch();
    EXPECT_THAT(heard.texts, ElementsAre("fast stop"));
}

TEST(SafetyPublisher, KeepsANewTextOfTheSameStateToItself) {
    Heard heard;
    heard.publisher.set({SafetyState::disconnected, "refused", false});
    EXPECT_FALSE(heard.publisher.toTell());
    heard.publisher.dispatch();
    EXPECT_THAT(heard.texts, ElementsAre());
    EXPECT_EQ(heard.publisher.safety().text, "refused");
}

TEST(SafetyPublisher, TellsNothingOfAStateThatCameAndWent) {
    Heard heard;
    heard.publisher.set({SafetyState::normal, "", false});
    heard.publisher.set({SafetyState::disconnected, "cable", false});
    heard.publisher.dispatch();
    EXPECT_THAT(heard.texts, ElementsAre());
}

TEST(SafetyPublisher, MayEndBeforeItsRegistrations) {
    Registration registration;
    {
        SafetyPublisher publisher{{SafetyState::normal, "", false}};
        registration = publisher.onChange([](const Safety&) {});
    }
    registration = {};
}

TEST(SafetyPublisher, TellsNobodyWhoseRegistrationEnded) {
    Heard heard;
    heard.registration = {};
    heard.publisher.set({SafetyState::normal, "", false});
    heard.publisher.dispatch();
    EXPECT_THAT(heard.texts, ElementsAre());
}

TEST(SafetyPublisher, LetsAListenerOwnAnotherRegistration) {
    Heard heard;
    auto owned = std::make_shared<Registration>(heard.publisher.onChange([](const Safety&) {}));
    auto outer = heard.publisher.onChange([owned](const Safety&) {});
    owned.reset();
    outer = {};  // would wait for itself for ever if the listener were dropped with its lock held
    heard.publisher.set({SafetyState::normal, "", false});
    heard.publisher.dispatch();
    EXPECT_EQ(heard.texts.size(), 1U);
}

// For the thread sanitizer: a driver sets, its notifier dispatches, clients ask and come and go.
TEST(SafetyPublisher, MayBeUsedByManyThreads) {
    SafetyPublisher publisher{{SafetyState::disconnected, "not connected yet", false}};
    std::atomic<int> told{0};
    const auto lasting = publisher.onChange([&](const Safety&) { ++told; });
    std::atomic<bool> done{false};
    const auto come_and_go = [&] {
        while (!done.load()) {
            static_cast<void>(publisher.safety());
            const auto passing = publisher.onChange([](const Safety&) {});
        }
    };
    {
        std::jthread notifier([&] {
            while (!done.load()) {
                publisher.dispatch();
            }
        });
        std::jthread client(come_and_go);
        std::jthread second(come_and_go);
        std::jthread driver([&] {
            for (int i = 0; i < 2'000; ++i) {
                publisher.set({SafetyState::fault, "fast stop", false});
                publisher.set({SafetyState::normal, "", false});
            }
        });
        for (int i = 0; i < 2'000; ++i) {
            publisher.set({SafetyState::emergency_stop, "pressed", false});
        }
        driver.join();
        done.store(true);
    }
    const int before = told.load();
    publisher.set({SafetyState::disconnected, "cable", false});
    publisher.dispatch();
    EXPECT_LE(told.load() - before, 1);
    EXPECT_EQ(publisher.safety().text, "cable");
}

}  // namespace
}  // namespace metier::device
