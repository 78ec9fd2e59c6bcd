#include "metier/skill/state.hpp"

#include <gtest/gtest.h>

#include <string>

namespace metier::skill {
namespace {

TEST(State, HasTheNumberAndNameOfPart10) {
    EXPECT_EQ(static_cast<int>(State::halted), 11);
    EXPECT_EQ(static_cast<int>(State::ready), 12);
    EXPECT_EQ(static_cast<int>(State::running), 13);
    EXPECT_EQ(static_cast<int>(State::suspended), 14);
    EXPECT_EQ(toString(State::halted), "Halted");
    EXPECT_EQ(toString(State::ready), "Ready");
    EXPECT_EQ(toString(State::running), "Running");
    EXPECT_EQ(toString(State::suspended), "Suspended");
    EXPECT_EQ(toString(State{10}), "unknown");
    EXPECT_EQ(toString(State{15}), "unknown");
}

TEST(TransitionNumber, IsNamedAfterItsEnds) {
    for (std::uint32_t number = 1; number <= 9; ++number) {
        const auto transition = static_cast<TransitionNumber>(number);
        const auto ends = std::string(toString(fromState(transition))) + "To" +
                          std::string(toString(toState(transition)));
        EXPECT_EQ(toString(transition), ends) << number;
    }
}

TEST(TransitionNumber, IsThatOfPart10) {
    EXPECT_EQ(toString(TransitionNumber{1}), "HaltedToReady");
    EXPECT_EQ(toString(TransitionNumber{2}), "ReadyToRunning");
    EXPECT_EQ(toString(TransitionNumber{3}), "RunningToHalted");
    EXPECT_EQ(toString(TransitionNumber{4}), "RunningToReady");
    EXPECT_EQ(toString(TransitionNumber{5}), "RunningToSuspended");
    EXPECT_EQ(toString(TransitionNumber{6}), "SuspendedToRunning");
    EXPECT_EQ(toString(TransitionNumber{7}), "SuspendedToHalted");
    EXPECT_EQ(toString(TransitionNumber{8}), "SuspendedToReady");
    EXPECT_EQ(toString(TransitionNumber{9}), "ReadyToHalted");
}

TEST(Reason, HasANameAndAHaltedSubState) {
    EXPECT_EQ(toString(Reason::owner_lost), "OwnerLost");
    EXPECT_EQ(toString(haltedBecause(Reason::by_client)), "HaltedByClient");
    EXPECT_EQ(toString(haltedBecause(Reason::error)), "HaltedError");
    EXPECT_EQ(toString(haltedBecause(Reason::force_exceeded)), "HaltedForce");
    EXPECT_EQ(toString(haltedBecause(Reason::owner_lost)), "HaltedOwnerLost");
    EXPECT_EQ(toString(haltedBecause(Reason::device_lost)), "HaltedDeviceLost");
    EXPECT_EQ(toString(haltedBecause(Reason::limit_violated)), "HaltedLimit");
    for (int reason = 0; reason <= static_cast<int>(Reason::limit_violated); ++reason) {
        EXPECT_NE(toString(static_cast<Reason>(reason)), "unknown") << reason;
    }
}

TEST(SubState, HasTheNamesOfTheModel) {
    EXPECT_EQ(toString(SubState::ready_not_configured), "ReadyNotConfigured");
    EXPECT_EQ(toString(SubState::ready_configured), "ReadyConfigured");
    EXPECT_EQ(toString(SubState::executing), "Executing");
    EXPECT_EQ(toString(SubState::stopping), "Stopping");
}

TEST(Method, HasTheNamesOfPart10) {
    EXPECT_EQ(toString(Method::start), "Start");
    EXPECT_EQ(toString(Method::suspend), "Suspend");
    EXPECT_EQ(toString(Method::resume), "Resume");
    EXPECT_EQ(toString(Method::halt), "Halt");
    EXPECT_EQ(toString(Method::reset), "Reset");
}

}  // namespace
}  // namespace metier::skill
