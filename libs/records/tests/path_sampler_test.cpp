#include "metier/records/path_sampler.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "metier/device/force_torque_sensor.hpp"
#include "recording_bench.hpp"

namespace metier::records {
namespace {

using testing::PlacedArm;
using testing::RecordedFile;

/// A sensor that measures what the test says.
class PlacedSensor final : public device::ForceTorqueSensor {
public:
    /// \param force along z [N]
    void measure(double force, device::SafetyState health = device::SafetyState::normal) {
        sample_.write({.force = {0.0, 0.0, force}, .health = health});
    }

    const std::string& name() const noexcept override { return name_; }
    device::WrenchSample sample() const noexcept override { return sample_.read(); }
    device::Safety safety() const override { return {}; }
    Result<void> tare() override { return {}; }
    device::Registration onSafetyChange(SafetyCallback /*callback*/) override { return {}; }

private:
    std::string name_ = "placed";
    device::SharedValue<device::WrenchSample> sample_;
};

struct SampledArm : ::testing::Test {
    Recorder::Key begin(const char* id) {
        const auto key = file.recorder().begin({.id = id,
                                                .skill = "Move",
                                                .started = std::chrono::system_clock::now(),
                                                .state = "Running"});
        sampler.begin(key);
        return key;
    }
    std::uint64_t end(Recorder::Key key) {
        const auto missed = sampler.end(key);
        file.recorder().end(
            key,
            {.time = std::chrono::system_clock::now(), .state = "Ready", .reason = "Finished"});
        return missed;
    }
    std::vector<PathSample> path(const char* id) {
        const auto store = file.store();
        const auto execution = store->find(id);
        EXPECT_TRUE(execution) << id;
        auto samples = store->path(execution->number);
        EXPECT_TRUE(samples);
        return *samples;
    }

    RecordedFile file;
    PlacedArm arm;
    PlacedSensor sensor;
    PathSampler sampler{arm, &sensor, file.recorder()};
};

TEST_F(SampledArm, IsRecordedAtTheBeginAndTheEnd) {
    arm.place({0.5, 0.25}, {0.5, 0.25});
    const auto key = begin("a");
    arm.place({1.5, 1.25}, {1.6, 1.25}, 3);
    EXPECT_EQ(end(key), 3U);
    const auto samples = path("a");
    ASSERT_GE(samples.size(), 2U);
    EXPECT_EQ(samples.front().time, 0.0);
    EXPECT_EQ(samples.front().actual[0], 0.5);
    EXPECT_EQ(samples.front().actual.size(), 2U);
    EXPECT_EQ(samples.back().actual[0], 1.5);
    EXPECT_NEAR(samples.back().commanded[0], 1.6, 1e-6);
    EXPECT_TRUE(samples.back().force.empty());
}

TEST_F(SampledArm, IsRecordedOnItsWay) {
    const auto key = begin("a");
    for (int i = 1; i <= 5; ++i) {
        arm.place({0.1 * i, 0.0}, {0.1 * i, 0.0});
        arm.awaitReads(2);
    }
    end(key);
    const auto samples = path("a");
    ASSERT_GE(samples.size(), 6U);
    for (std::size_t i = 1; i < samples.size(); ++i) {
        EXPECT_GE(samples[i].time, samples[i - 1].time);
    }
}

TEST_F(SampledArm, IsNotRecordedAgainAndAgainWhileItStands) {
    const auto key = begin("a");
    arm.awaitReads(20);
    arm.place({0.1, 0.0}, {0.1, 0.0});
    arm.awaitReads(2);
    end(key);
    const auto samples = path("a");
    // The begin, the end of the pause, and where it went; each second of a pause one more.
    const auto pauses = static_cast<std::size_t>(samples.back().time);
    EXPECT_GE(samples.size(), 3U);
    EXPECT_LE(samples.size(), 4U + pauses);
    const auto there = std::count_if(samples.begin(), samples.end(),
                                     [](const auto& sample) { return sample.actual[0] == 0.0; });
    EXPECT_GE(there, 2) << "the pause has an end";
}

TEST_F(SampledArm, IsRecordedForEachExecution) {
    const auto one = begin("one");
    const auto other = begin("other");
    arm.place({1.0, 0.0}, {1.0, 0.0});
    end(one);
    arm.place({2.0, 0.0}, {2.0, 0.0});
    end(other);
    EXPECT_EQ(path("one").back().actual[0], 1.0);
    EXPECT_EQ(path("other").back().actual[0], 2.0);
}

TEST_F(SampledArm, IsRecordedWhenOnlyTheForceChanges) {
    sensor.measure(0.0);
    const auto key = begin("a");
    sensor.measure(0.4);  // noise
    arm.awaitReads(3);
    sensor.measure(5.0);
    arm.awaitReads(2);
    sensor.measure(0.0);
    arm.awaitReads(2);
    end(key);
    std::vector<double> forces;
    for (const auto& sample : path("a")) {
        ASSERT_EQ(sample.force.size(), 6U);
        if (forces.empty() || forces.back() != sample.force[2]) {
            forces.push_back(sample.force[2]);
        }
    }
    EXPECT_THAT(forces, ::testing::ElementsAre(0.0, 0.4, 5.0, 0.0)) << "0.4: the end of the pause";
}

TEST_F(SampledArm, HasNoForceWhileItsSensorIsNotWell) {
    sensor.measure(7.0, device::SafetyState::disconnected);
    const auto key = begin("a");
    sensor.measure(7.0);
    arm.awaitReads(2);
    sensor.measure(7.0, device::SafetyState::fault);
    arm.awaitReads(2);
    end(key);
    const auto samples = path("a");
    EXPECT_TRUE(samples.front().force.empty());
    EXPECT_TRUE(std::any_of(samples.begin(), samples.end(),
                            [](const auto& sample) { return !sample.force.empty(); }));
    EXPECT_TRUE(samples.back().force.empty());
}

TEST_F(SampledArm, CountsNoMissedCyclesIfItsCounterBeganAnew) {
    arm.place({0.0, 0.0}, {0.0, 0.0}, 100);
    const auto key = begin("a");
    arm.place({0.0, 0.0}, {0.0, 0.0}, 3);
    EXPECT_EQ(end(key), 0U);
}

TEST_F(SampledArm, IsNotReadWhileNothingRuns) {
    end(begin("a"));
    EXPECT_EQ(sampler.end(4711), 0U);
    sampler.begin(0);
    EXPECT_EQ(sampler.end(0), 0U);
}

}  // namespace
}  // namespace metier::records
