#include "record_stream.hpp"

#include <gmock/gmock.h>

#include "metier/base/testing/allocation_count.hpp"
#include "tare_task.hpp"
#include "wire.hpp"

namespace metier::netft_driver::testing {
namespace {

using namespace std::chrono_literals;
using device::SafetyState;
using ::testing::HasSubstr;

struct Stream : ::testing::Test {
    std::optional<device::WrenchSample> take(const Record& record) {
        return stream.take(record.bytes(), now);
    }
    SteadyTime now = SteadyTime(1h);
    RecordStream stream{Calibration{1e-3, 1e-4}};
};

TEST_F(Stream, GivesForceAndTorqueInSi) {
    const auto sample = take({7, 70, 0, {1000, -2000, 3000, 10000, -20000, 30000}});
    ASSERT_TRUE(sample);
    EXPECT_DOUBLE_EQ(sample->force[0], 1.0);
    EXPECT_DOUBLE_EQ(sample->force[1], -2.0);
    EXPECT_DOUBLE_EQ(sample->torque[2], 3.0);
    EXPECT_EQ(sample->sequence, 70U);
    EXPECT_EQ(sample->health, SafetyState::normal);
    EXPECT_EQ(sample->stamp, now);
}

TEST_F(Stream, SkipsWhatIsLateOrComesTwice) {
    take({5, 35});
    EXPECT_FALSE(take({5, 35}));
    EXPECT_FALSE(take({4, 28}));
}

TEST_F(Stream, GoesOnOverTheEndOfItsCounters) {
    take({0xFFFFFFFFU, 0xFFFFFFFEU});
    const auto sample = take({0, 5});
    ASSERT_TRUE(sample);
    EXPECT_EQ(sample->sequence, 0x100000005U);
}

TEST_F(Stream, TellsAnErrorOfTheSensor) {
    EXPECT_EQ(take({1, 1, 0x80020000U})->health, SafetyState::fault);
    EXPECT_EQ(stream.status(), 0x80020000U);
    EXPECT_EQ(take({2, 2, 0x80010000U})->health, SafetyState::normal) << "a warning";
    EXPECT_EQ(take({3, 3, 0})->health, SafetyState::normal);
}

TEST_F(Stream, TakesTheNewestOfABufferedDatagram) {
    Bytes datagram;
    for (std::uint32_t i = 1; i <= 5; ++i) {
        const auto bytes = Record{i, i, 0, {static_cast<int>(1000 * i), 0, 0, 0, 0, 0}}.bytes();
        datagram.insert(datagram.end(), bytes.begin(), bytes.end());
    }
    const auto sample = stream.take(datagram, now);
    ASSERT_TRUE(sample);
    EXPECT_DOUBLE_EQ(sample->force[0], 5.0);
}

TEST_F(Stream, RejectsWhatIsNoRecord) {
    for (const std::size_t size : {0U, 1U, 35U, 37U}) {
        EXPECT_FALSE(stream.take(Bytes(size), now)) << size;
    }
}

TEST_F(Stream, TakesRecordsWithoutAllocating) {
    auto bytes = Record{1, 1}.bytes();
    const auto before = allocationCount();
    for (int i = 1; i < 250; ++i) {
        bytes[3] = static_cast<std::byte>(i);
        ASSERT_TRUE(stream.take(bytes, now));
    }
    EXPECT_EQ(allocationCount(), before);
}

struct Tare : ::testing::Test {
    /// Gives records of one force until the task has an outcome or `count` are given.
    std::optional<Result<void>> give(double force, int count) {
        device::WrenchSample sample;
        sample.force[2] = force;
        return give(sample, count);
    }
    std::optional<Result<void>> giveTorque(double torque, int count) {
        device::WrenchSample sample;
        sample.torque[0] = torque;
        return give(sample, count);
    }
    std::optional<Result<void>> give(const device::WrenchSample& sample, int count) {
        for (int i = 0; i < count; ++i) {
            now += 1ms;
            sent += task.toSend(now) ? 1 : 0;
            if (auto outcome = task.take(sample, now)) {
                return outcome;
            }
        }
        return std::nullopt;
    }

    SteadyTime now = SteadyTime(1h);
    TareTask task{now};
    int sent = 0;
};

TEST_F(Tare, EndsWhenTheLoadIsZero) {
    EXPECT_FALSE(give(12.0, 20));
    EXPECT_EQ(sent, 1);
    const auto outcome = give(0.02, 20);
    ASSERT_TRUE(outcome);
    EXPECT_TRUE(*outcome);
}

TEST_F(Tare, TakesHalfANewtonForZeroInEitherDirection) {
    EXPECT_FALSE(give(0.51, 20));
    EXPECT_FALSE(give(-0.51, 20));
    EXPECT_TRUE(give(-0.49, 10));
}

TEST_F(Tare, TakesFiveHundredthsOfANewtonMetreForZeroInEitherDirection) {
    EXPECT_FALSE(giveTorque(0.051, 20));
    EXPECT_FALSE(giveTorque(-0.051, 20));
    EXPECT_TRUE(giveTorque(-0.049, 10));
}

TEST_F(Tare, JudgesTheMeanOfTenRecordsSinceTheRequest) {
    EXPECT_FALSE(give(12.0, 5));
    EXPECT_FALSE(give(0.0, 5)) << "6 N in the mean";
    EXPECT_FALSE(give(0.0, 9));
    EXPECT_TRUE(give(0.0, 1));
}

TEST_F(Tare, ForgetsTheRecordsBeforeARepeatedRequest) {
    EXPECT_FALSE(give(12.0, 145));
    now += TareTask::kAttemptTime;
    EXPECT_TRUE(give(0.0, 10)) << "the mean of five loaded and five others is 6 N";
    EXPECT_EQ(sent, 2);
}

TEST_F(Tare, FailsWithTheTorqueThatIsLeft) {
    const auto outcome = giveTorque(-0.2, 1000);
    ASSERT_TRUE(outcome);
    EXPECT_THAT(outcome->error().message, HasSubstr("still 0.00 N and 0.200 Nm, expected at most "
                                                    "0.5 N and 0.05 Nm"));
}

TEST_F(Tare, AsksAgainIfNothingChanges) {
    EXPECT_FALSE(give(12.0, 320));
    EXPECT_EQ(sent, 3);
    EXPECT_TRUE(give(0.0, 20).value());
}

TEST_F(Tare, FailsWithTheLoadThatIsLeft) {
    const auto outcome = give(12.0, 1000);
    ASSERT_TRUE(outcome);
    EXPECT_EQ(outcome->error().code, Errc::timeout);
    EXPECT_THAT(outcome->error().message, HasSubstr("after 3 requests the load is still 12.00 N"));
    EXPECT_EQ(sent, 3);
}

}  // namespace
}  // namespace metier::netft_driver::testing
