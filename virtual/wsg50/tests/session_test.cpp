#include "session.hpp"

#include <gmock/gmock.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "payload.hpp"

namespace metier::virtual_wsg50 {
namespace {

using ::testing::ElementsAre;
using ::testing::Eq;
using Bytes = std::vector<std::byte>;

/// A gripper with a client, and time moved by hand.
class SessionTest : public ::testing::Test {
protected:
    struct Reply {
        int id;
        int status;
        bool operator==(const Reply&) const = default;
    };

    void send(int id, const PayloadWriter& payload = {}) {
        session_.receive(encode(static_cast<std::uint8_t>(id), payload.bytes()));
    }
    void run(double seconds) {
        for (double time = 0.0; time < seconds; time += 0.002) {
            gripper_.step(0.002, obstacles_);
            session_.step(std::chrono::milliseconds(2));
        }
    }
    /// Replies sent since the last call.
    std::vector<Reply> replies() {
        std::vector<Reply> result;
        last_data_.clear();
        while (const auto frame = sent_.next()) {
            EXPECT_TRUE(frame->intact);
            result.push_back({frame->id, PayloadReader(frame->payload).u16()});
            last_data_.assign(frame->payload.begin() + 2, frame->payload.end());
        }
        return result;
    }
    int statusOf(int id, const PayloadWriter& payload = {}) {
        send(id, payload);
        const auto all = replies();
        return all.empty() ? -1 : all.back().status;
    }
    PayloadReader ask(int id, const PayloadWriter& payload = {}) {
        EXPECT_EQ(statusOf(id, payload), 0);
        return PayloadReader(last_data_);
    }
    void reference() {
        send(0x20, PayloadWriter().u8(0));
        run(2.0);
        ASSERT_THAT(replies(), ElementsAre(Reply{0x20, 26}, Reply{0x20, 0}));
    }
    std::uint32_t systemState() {
        auto in = ask(0x40, PayloadWriter().u8(0).u16(0));
        const std::uint32_t low = in.u16();
        return low | static_cast<std::uint32_t>(in.u16()) << 16U;
    }
    int graspingState() { return ask(0x41, PayloadWriter().u8(0).u16(0)).u8(); }
    double width() { return ask(0x43, PayloadWriter().u8(0).u16(0)).f32(); }
    double force() { return ask(0x45, PayloadWriter().u8(0).u16(0)).f32(); }
    static PayloadWriter floats(double first, double second) {
        return PayloadWriter().f32(first).f32(second);
    }
    static PayloadWriter move(int flags, double width, double speed) {
        return PayloadWriter().u8(static_cast<std::uint8_t>(flags)).f32(width).f32(speed);
    }

    Obstacles obstacles_;
    Gripper gripper_{
        {}, [this](Command command, Status status) { session_.finished(command, status); }};
    Identity identity_{4711, ""};
    FrameReader sent_;
    Session session_{gripper_, identity_,
                     [this](std::span<const std::byte> bytes) { sent_.feed(bytes); }};
    Bytes last_data_;
};

TEST_F(SessionTest, GivesBackWhatALoopBackTestSends) {
    EXPECT_EQ(statusOf(0x06, PayloadWriter().text("abc")), 0);
    EXPECT_EQ(last_data_, PayloadWriter().text("abc").bytes());
}

TEST_F(SessionTest, RefusesWhatIsNoCommand) {
    EXPECT_EQ(statusOf(0x99), 14);
    EXPECT_EQ(statusOf(0xB0), 14);  // no script runs on this gripper
    EXPECT_EQ(statusOf(0x25, PayloadWriter().f32(10)), 13);
    EXPECT_EQ(statusOf(0x31, PayloadWriter().u8(1)), 12);
    EXPECT_EQ(statusOf(0x24, PayloadWriter().text("kca")), 24);
    EXPECT_EQ(statusOf(0x20, PayloadWriter().u8(3)), 24);
}

TEST_F(SessionTest, RefusesAFrameWithAWrongChecksum) {
    auto frame = encode(0x22, {});
    frame.back() ^= std::byte{1};
    session_.receive(frame);
    EXPECT_THAT(replies(), ElementsAre(Reply{0x22, 11}));
}

TEST_F(SessionTest, MovesOnlyWhenReferenced) {
    EXPECT_EQ(statusOf(0x21, move(0, 50, 100)), 3);
    EXPECT_EQ(statusOf(0x25, floats(30, 100)), 3);
    EXPECT_EQ(statusOf(0x26, floats(60, 100)), 3);
    EXPECT_EQ(systemState() & system_bit::kReferenced, 0U);
    reference();
    EXPECT_EQ(systemState() & system_bit::kReferenced, system_bit::kReferenced);
    EXPECT_NEAR(width(), 110.0, 1e-3);
}

TEST_F(SessionTest, AnswersAMotionAtOnceAndAtItsEnd) {
    reference();
    send(0x21, move(0, 50, 100));
    EXPECT_THAT(replies(), ElementsAre(Reply{0x21, 26}));
    run(0.3);
    EXPECT_THAT(replies(), ElementsAre());
    EXPECT_EQ(graspingState(), 6);
    EXPECT_NE(systemState() & system_bit::kMoving, 0U);
    run(1.0);
    EXPECT_THAT(replies(), ElementsAre(Reply{0x21, 0}));
    EXPECT_NEAR(width(), 50.0, 1e-3);
    EXPECT_NE(systemState() & system_bit::kTargetReached, 0U);
}

TEST_F(SessionTest, MovesByAWidthWhenTheFlagSaysRelative) {
    reference();
    send(0x21, move(1, -20, 400));
    run(1.0);
    EXPECT_NEAR(width(), 90.0, 1e-3);
}

TEST_F(SessionTest, RefusesWidthsAndSpeedsOutOfRange) {
    reference();
    EXPECT_EQ(statusOf(0x21, move(0, 111, 100)), 28);
    EXPECT_EQ(statusOf(0x21, move(0, 50, 421)), 28);
    EXPECT_EQ(statusOf(0x21, move(0, 50, 4)), 28);
    EXPECT_EQ(statusOf(0x21, move(0, std::numeric_limits<double>::quiet_NaN(), 100)), 28);
    EXPECT_EQ(statusOf(0x30, PayloadWriter().f32(99)), 28);
    EXPECT_EQ(statusOf(0x32, PayloadWriter().f32(81)), 28);
    EXPECT_EQ(statusOf(0x34, floats(60, 50)), 28);
}

TEST_F(SessionTest, ASecondMotionAbortsTheFirst) {
    reference();
    send(0x21, move(0, 20, 50));
    run(0.1);
    send(0x26, floats(100, 50));
    run(0.6);
    EXPECT_THAT(replies(),
                ElementsAre(Reply{0x21, 26}, Reply{0x21, 19}, Reply{0x26, 26}, Reply{0x26, 0}));
}

TEST_F(SessionTest, StopEndsAMotionWithoutAFault) {
    reference();
    send(0x21, move(0, 20, 50));
    run(0.1);
    send(0x22);
    EXPECT_THAT(replies(), ElementsAre(Reply{0x21, 26}, Reply{0x21, 19}, Reply{0x22, 0}));
    run(0.1);
    EXPECT_EQ(systemState() & system_bit::kMoving, 0U);
    EXPECT_NE(systemState() & system_bit::kAxisStopped, 0U);
    EXPECT_EQ(statusOf(0x21, move(0, 60, 50)), 26);
}

TEST_F(SessionTest, AfterAFastStopNothingMovesUntilItIsAcknowledged) {
    reference();
    send(0x21, move(0, 20, 50));
    run(0.1);
    send(0x23);
    EXPECT_THAT(replies(), ElementsAre(Reply{0x21, 26}, Reply{0x21, 19}, Reply{0x23, 0}));
    EXPECT_EQ(statusOf(0x21, move(0, 60, 50)), 16);
    EXPECT_EQ(statusOf(0x20, PayloadWriter().u8(0)), 16);
    EXPECT_NE(systemState() & system_bit::kFastStop, 0U);
    EXPECT_EQ(statusOf(0x24, PayloadWriter().text("ack")), 0);
    EXPECT_EQ(systemState() & system_bit::kFastStop, 0U);
    EXPECT_EQ(statusOf(0x21, move(0, 60, 50)), 26);
}

TEST_F(SessionTest, GraspsAPartHoldsItAndLosesIt) {
    reference();
    obstacles_.part = 0.031;
    EXPECT_EQ(statusOf(0x32, PayloadWriter().f32(40)), 0);
    send(0x25, floats(30, 200));
    run(0.2);
    EXPECT_EQ(graspingState(), 1);
    run(0.8);
    EXPECT_THAT(replies(), ElementsAre(Reply{0x25, 0}));
    EXPECT_EQ(graspingState(), 4);
    EXPECT_NEAR(width(), 31.0, 1e-3);
    EXPECT_EQ(force(), 40.0);
    obstacles_.part.reset();
    run(0.1);
    EXPECT_EQ(graspingState(), 3);
    EXPECT_EQ(force(), 0.0);
}

TEST_F(SessionTest, ReleasesWhatItHolds) {
    reference();
    obstacles_.part = 0.031;
    send(0x25, floats(30, 200));
    run(1.0);
    send(0x26, floats(60, 100));
    run(0.1);
    EXPECT_EQ(graspingState(), 5);
    run(1.0);
    EXPECT_EQ(graspingState(), 0);
    EXPECT_EQ(force(), 0.0);
    EXPECT_NEAR(width(), 60.0, 1e-3);
}

TEST_F(SessionTest, TellsThatThereWasNoPart) {
    reference();
    send(0x25, floats(30, 200));
    run(1.0);
    EXPECT_THAT(replies(), ElementsAre(Reply{0x25, 26}, Reply{0x25, 18}));
    EXPECT_EQ(graspingState(), 2);
    EXPECT_NEAR(width(), 27.0, 1e-3);
}

TEST_F(SessionTest, APartMuchWiderThanNominalBlocksTheGrasp) {
    reference();
    obstacles_.part = 0.05;
    send(0x25, floats(30, 200));
    run(1.0);
    EXPECT_THAT(replies(), ElementsAre(Reply{0x25, 26}, Reply{0x25, 29}));
    EXPECT_EQ(graspingState(), 7);
}

TEST_F(SessionTest, ABlockedMoveStopsTheAxisIfAskedTo) {
    reference();
    obstacles_.block = 0.05;
    send(0x21, move(2, 20, 200));
    run(1.0);
    EXPECT_THAT(replies(), ElementsAre(Reply{0x21, 26}, Reply{0x21, 29}));
    EXPECT_NE(systemState() & system_bit::kBlockedMinus, 0U);
    EXPECT_NE(systemState() & system_bit::kAxisStopped, 0U);
    EXPECT_EQ(force(), 0.0);
}

TEST_F(SessionTest, ABlockedMoveClampsOtherwise) {
    reference();
    obstacles_.block = 0.05;
    send(0x21, move(0, 20, 200));
    run(1.0);
    EXPECT_THAT(replies(), ElementsAre(Reply{0x21, 26}, Reply{0x21, 29}));
    EXPECT_EQ(systemState() & system_bit::kAxisStopped, 0U);
    EXPECT_EQ(force(), 80.0);
}

TEST_F(SessionTest, KeepsToSoftLimitsUntilTheyAreCleared) {
    reference();
    EXPECT_EQ(statusOf(0x34, floats(20, 90)), 0);
    auto limits = ask(0x35);
    EXPECT_FLOAT_EQ(static_cast<float>(limits.f32()), 20.0F);
    EXPECT_FLOAT_EQ(static_cast<float>(limits.f32()), 90.0F);
    EXPECT_NE(systemState() & system_bit::kSoftLimitPlus, 0U);
    EXPECT_EQ(statusOf(0x21, move(0, 10, 100)), 28);
    EXPECT_EQ(statusOf(0x36), 0);
    EXPECT_EQ(statusOf(0x21, move(0, 10, 100)), 26);
}

TEST_F(SessionTest, AllowsMoreForceInOverdriveOnly) {
    EXPECT_EQ(statusOf(0x37, PayloadWriter().u8(1)), 0);
    EXPECT_EQ(statusOf(0x32, PayloadWriter().f32(120)), 0);
    EXPECT_NE(systemState() & system_bit::kOverdrive, 0U);
    EXPECT_EQ(statusOf(0x37, PayloadWriter().u8(0)), 0);
    EXPECT_EQ(ask(0x33).f32(), 80.0);
}

TEST_F(SessionTest, SendsUpdatesEveryPeriodUntilTheyAreEnded) {
    EXPECT_EQ(statusOf(0x43, PayloadWriter().u8(1).u16(20)), 0);
    run(0.1);
    EXPECT_THAT(replies(), ::testing::AllOf(::testing::SizeIs(5), ::testing::Each(Reply{0x43, 0})));
    EXPECT_EQ(statusOf(0x43, PayloadWriter().u8(0).u16(0)), 0);
    run(0.1);
    EXPECT_THAT(replies(), ElementsAre());
}

TEST_F(SessionTest, SendsUpdatesOfChangesOnly) {
    reference();
    EXPECT_EQ(statusOf(0x43, PayloadWriter().u8(3).u16(20)), 0);
    run(0.2);
    EXPECT_THAT(replies(), ElementsAre());
    send(0x21, move(0, 100, 100));
    run(0.06);
    EXPECT_THAT(replies(),
                ElementsAre(Reply{0x21, 26}, Reply{0x43, 0}, Reply{0x43, 0}, Reply{0x43, 0}));
}

TEST_F(SessionTest, CannotSendUpdatesWithoutAPeriod) {
    EXPECT_EQ(statusOf(0x41, PayloadWriter().u8(1).u16(0)), 24);
}

TEST_F(SessionTest, TellsWhatItIs) {
    auto info = ask(0x50);
    EXPECT_EQ(info.u8(), 1);
    EXPECT_EQ(info.u8(), 1);
    EXPECT_EQ(info.u16(), 0x2640);
    EXPECT_EQ(info.u16(), 4711);
    auto limits = ask(0x53);
    for (const double expected : {110.0, 5.0, 420.0, 100.0, 5000.0, 5.0, 80.0, 120.0}) {
        EXPECT_FLOAT_EQ(static_cast<float>(limits.f32()), static_cast<float>(expected));
    }
    EXPECT_EQ(ask(0x46).u16(), 385);
    EXPECT_EQ(statusOf(0x51, PayloadWriter().text("left")), 0);
    EXPECT_EQ(statusOf(0x52), 0);
    EXPECT_EQ(last_data_, PayloadWriter().text("left").bytes());
    EXPECT_EQ(statusOf(0x60, PayloadWriter().u8(0)), 1);
}

TEST_F(SessionTest, CountsItsCycles) {
    reference();
    obstacles_.part = 0.03;
    send(0x25, floats(30, 400));
    run(1.0);
    auto first = ask(0x42, PayloadWriter().u8(1));
    EXPECT_EQ(first.u16(), 1);
    first.u16();
    EXPECT_EQ(first.u16(), 1);
    auto second = ask(0x42, PayloadWriter().u8(0));
    EXPECT_EQ(second.u16(), 1);
    second.u16();
    EXPECT_EQ(second.u16(), 0);
}

TEST_F(SessionTest, ATemperatureFaultLastsUntilItIsCoolAndAcknowledged) {
    reference();
    gripper_.setTemperatureFault(true);
    EXPECT_EQ(statusOf(0x25, floats(30, 100)), 16);
    EXPECT_EQ(statusOf(0x24, PayloadWriter().text("ack")), 0);
    EXPECT_NE(systemState() & system_bit::kTemperatureFault, 0U);
    gripper_.setTemperatureFault(false);
    EXPECT_EQ(statusOf(0x24, PayloadWriter().text("ack")), 0);
    EXPECT_EQ(statusOf(0x25, floats(30, 100)), 26);
}

}  // namespace
}  // namespace metier::virtual_wsg50
