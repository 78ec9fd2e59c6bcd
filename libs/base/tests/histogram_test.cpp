#include "metier/base/histogram.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numeric>
#include <thread>
#include <vector>

namespace metier {
namespace {

std::size_t bucketOf(double seconds) {
    TimeHistogram histogram;
    histogram.add(seconds);
    const auto counts = histogram.read().counts;
    std::size_t bucket = 0;
    while (counts.at(bucket) == 0) {
        ++bucket;
    }
    return bucket;
}

TEST(TimeHistogram, CountsAValueInTheFirstBucketThatIsNotSmaller) {
    EXPECT_EQ(bucketOf(0), 0U);
    EXPECT_EQ(bucketOf(10e-6), 0U);
    EXPECT_EQ(bucketOf(11e-6), 1U);
    EXPECT_EQ(bucketOf(100.0), TimeHistogram::kBounds.size() - 1);
    EXPECT_EQ(bucketOf(100.1), TimeHistogram::kBounds.size());
    EXPECT_EQ(bucketOf(std::numeric_limits<double>::infinity()), TimeHistogram::kBounds.size());
}

TEST(TimeHistogram, HasBoundsThatGrow) {
    for (std::size_t i = 1; i < TimeHistogram::kBounds.size(); ++i) {
        EXPECT_GT(TimeHistogram::kBounds.at(i), TimeHistogram::kBounds.at(i - 1));
    }
}

TEST(TimeHistogram, LosesNothingOfSeveralThreads) {
    constexpr int kEach = 20'000;
    TimeHistogram histogram;
    const auto add = [&] {
        for (int n = 0; n < kEach; ++n) {
            histogram.add(0.5);
        }
    };
    {
        std::vector<std::jthread> threads;
        for (int i = 0; i < 4; ++i) {
            threads.emplace_back(add);
        }
    }
    const auto read = histogram.read();
    EXPECT_EQ(std::accumulate(read.counts.begin(), read.counts.end(), std::uint64_t{0}),
              std::uint64_t{4} * kEach);
    EXPECT_DOUBLE_EQ(read.sum, 0.5 * 4 * kEach);
}

}  // namespace
}  // namespace metier
