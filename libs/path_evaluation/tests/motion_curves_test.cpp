#include "metier/path_evaluation/motion_curves.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>

#include "metier/motion/planner.hpp"

namespace metier::path_evaluation {
namespace {

using motion::JointVector;

motion::RobotModel modelOf(const std::string& robot) {
    return motion::RobotModel::load(std::filesystem::path(METIER_MODELS) / (robot + ".toml"))
        .value();
}

motion::Trajectory turnOfAxis(const motion::RobotModel& model, std::size_t axis, double by) {
    motion::PtpRequest request;
    request.start = model.home();
    auto target = model.home();
    target[axis] += by;
    request.target = target;
    return motion::Planner(model).ptp(request).value();
}

TEST(MotionCurves, OfAPlanReachEveryLimitAndBreakNone) {
    const auto model = modelOf("ur5");
    const auto samples = sampleMotion(turnOfAxis(model, 2, -1.5), 2001);
    for (const auto quantity : {Quantity::acceleration, Quantity::jerk}) {
        const auto peak = peakOf(samples, model, quantity);
        EXPECT_EQ(peak.axis, 2U);
        EXPECT_GT(peak.share, 0.99);
        EXPECT_LT(peak.share, 1.0 + 1e-6);
    }
    const auto& last = samples.back();
    EXPECT_EQ(last.velocity, JointVector(6));
    EXPECT_NEAR(last.position[2], model.home()[2] - 1.5, 1e-12);
}

TEST(MotionCurves, OfAPlanThatStandsAreZero) {
    const auto model = modelOf("ur5");
    for (const auto& sample : sampleMotion(turnOfAxis(model, 2, 0.0), 5)) {
        EXPECT_TRUE(sample.jerk.allZero());
        EXPECT_TRUE(sample.velocity.allZero());
    }
}

TEST(MotionCurves, OfACubicAreExactWithUnevenTimesToo) {
    MotionRecord record;
    for (int i = 0; i < 20; ++i) {
        const double t = 0.01 * i + 0.003 * (i % 3);
        record.push_back({100 + t, {1 + 2 * t - 3 * t * t + 4 * t * t * t, -t}});
    }
    for (const auto& sample : sampleMotion(record)) {
        const double t = sample.time;
        EXPECT_NEAR(sample.velocity[0], 2 - 6 * t + 12 * t * t, 1e-9);
        EXPECT_NEAR(sample.acceleration[0], -6 + 24 * t, 1e-6);
        EXPECT_NEAR(sample.jerk[0], 24, 1e-3);
        EXPECT_NEAR(sample.velocity[1], -1, 1e-9);
    }
}

TEST(MotionCurves, OfARecordedPlanAreThoseOfThePlan) {
    const auto model = modelOf("iiwa14");
    const auto planned = sampleMotion(turnOfAxis(model, 0, 1.0), 801);
    MotionRecord record;
    for (const auto& sample : planned) {
        record.push_back({sample.time, sample.position});
    }
    const auto recorded = sampleMotion(record);
    for (std::size_t i = 0; i < planned.size(); ++i) {
        EXPECT_NEAR(recorded[i].velocity[0], planned[i].velocity[0], 2e-3) << i;
        EXPECT_NEAR(recorded[i].acceleration[0], planned[i].acceleration[0], 0.2) << i;
    }
    EXPECT_NEAR(peakOf(recorded, model, Quantity::jerk).share, 1.0, 0.01);
}

TEST(MotionCurves, APositionsShareIsOneAtItsLimits) {
    const motion::JointLimits limits{-1, 3, 1, 1, 1};
    EXPECT_EQ(shareOfLimit(limits, Quantity::position, -1), -1);
    EXPECT_EQ(shareOfLimit(limits, Quantity::position, 1), 0);
    EXPECT_EQ(shareOfLimit(limits, Quantity::position, 3), 1);
    EXPECT_EQ(shareOfLimit(limits, Quantity::velocity, -0.5), -0.5);
}

/// An arm at home whose axis has these velocities, one each 0.1 s.
std::vector<MotionSample> moving(const motion::RobotModel& model, std::size_t axis,
                                 const std::vector<double>& velocities) {
    std::vector<MotionSample> samples;
    for (const double velocity : velocities) {
        const JointVector zero(model.axisCount());
        MotionSample sample{0.1 * static_cast<double>(samples.size()), model.home(), zero, zero,
                            zero};
        sample.velocity[axis] = velocity;
        samples.push_back(sample);
    }
    return samples;
}

TEST(MotionPeaks, AreOfEitherSignAndTellWhereAndWhen) {
    const auto model = modelOf("ur5");
    const double limit = model.limits(3).velocity;
    const auto samples = moving(model, 3, {0, 0.5 * limit, -1.25 * limit, 1.25 * limit, 0});
    const auto peak = peakOf(samples, model, Quantity::velocity);
    EXPECT_EQ(peak.axis, 3U);
    EXPECT_NEAR(peak.share, 1.25, 1e-12) << "beyond the limit, too";
    EXPECT_NEAR(peak.value, -1.25 * limit, 1e-12) << "the first of two";
    EXPECT_NEAR(peak.time, 0.2, 1e-12);
    EXPECT_EQ(peakOfAxis(samples, model, Quantity::velocity, 2).share, 0.0);
    EXPECT_EQ(peakOfAxis(samples, model, Quantity::velocity, 2).axis, 2U);
}

TEST(MotionPeaks, OfNoSamplesAreZero) {
    const auto model = modelOf("ur5");
    const auto peak = peakOf({}, model, Quantity::position);
    EXPECT_EQ(peak.share, 0.0);
    EXPECT_EQ(peak.time, 0.0);
}

TEST(MotionCurves, OfTheFewestPositionsAreThoseOfOneCubic) {
    MotionRecord record;
    for (int i = 0; i < static_cast<int>(kFewestRecorded); ++i) {
        const double t = 1e-3 * i;  // at 1 kHz
        record.push_back({1e6 + t, {0.5 - t * t * t}});
    }
    const auto samples = sampleMotion(record);
    ASSERT_EQ(samples.size(), kFewestRecorded);
    EXPECT_EQ(samples.front().time, 0.0) << "counted from the first";
    EXPECT_NEAR(samples.back().time, 0.004, 1e-9);
    for (const auto& sample : samples) {
        EXPECT_NEAR(sample.jerk[0], -6, 0.2);
    }
}

TEST(MotionCurves, OfAPlanBeginAndEndAtItsEndsWithEqualSteps) {
    const auto model = modelOf("ur5");
    const auto trajectory = turnOfAxis(model, 1, 0.3);
    const auto samples = sampleMotion(trajectory, 11);
    ASSERT_EQ(samples.size(), 11U);
    EXPECT_EQ(samples.front().time, 0.0);
    EXPECT_EQ(samples.back().time, trajectory.duration().count());
    EXPECT_NEAR(samples[3].time, 0.3 * trajectory.duration().count(), 1e-12);
    EXPECT_EQ(samples.front().position, model.home());
}

}  // namespace
}  // namespace metier::path_evaluation
