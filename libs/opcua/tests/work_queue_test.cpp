#include "server/work_queue.hpp"

#include <gmock/gmock.h>

#include "server/rate_limit.hpp"

namespace metier::opcua {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using Pushed = WorkQueue::Pushed;

class Work : public ::testing::Test {
protected:
    Pushed push(int number) {
        return queue_.push([this, number] { done_.push_back(number); });
    }
    void drain() {
        queue_.drain([](const std::function<void()>& work) { work(); });
    }

    WorkQueue queue_;
    std::vector<int> done_;
};

TEST_F(Work, IsDoneOnceOldestFirst) {
    EXPECT_EQ(push(1), Pushed::first) << "its thread must be woken";
    EXPECT_EQ(push(2), Pushed::further);
    EXPECT_EQ(queue_.size(), 2U);
    drain();
    drain();
    EXPECT_THAT(done_, ElementsAre(1, 2));
    EXPECT_EQ(push(3), Pushed::first) << "again";
}

TEST_F(Work, ThatIsAddedByOtherWorkWaitsForTheNextTime) {
    Pushed added = Pushed::refused;
    queue_.push([&] { added = push(2); });
    push(1);
    drain();
    EXPECT_EQ(added, Pushed::first) << "nothing waits meanwhile: the thread must be woken";
    EXPECT_THAT(done_, ElementsAre(1));
    drain();
    EXPECT_THAT(done_, ElementsAre(1, 2));
}

TEST_F(Work, IsHandedBackAtTheEndAndRefusedAfterIt) {
    push(1);
    push(2);
    const auto left = queue_.close();
    EXPECT_EQ(left.size(), 2U);
    EXPECT_EQ(push(3), Pushed::refused);
    drain();
    EXPECT_TRUE(done_.empty());
    EXPECT_TRUE(queue_.close().empty());
}

constexpr SteadyTime kStart{1h};

int passed(RateLimit& limit, SteadyTime now) {
    int count = 0;
    while (count < 1'000 && limit.take(now)) {
        ++count;
    }
    return count;
}

TEST(RateLimit, LetsABurstPassAndThenTheRate) {
    RateLimit limit(5, 2);
    EXPECT_EQ(passed(limit, kStart), 5);
    EXPECT_FALSE(limit.take(kStart + 499ms));
    EXPECT_TRUE(limit.take(kStart + 500ms));
    EXPECT_FALSE(limit.take(kStart + 999ms));
    EXPECT_EQ(passed(limit, kStart + 2100ms), 3);
}

TEST(RateLimit, SavesNoMoreThanABurst) {
    RateLimit limit(5, 2);
    EXPECT_EQ(passed(limit, kStart), 5);
    EXPECT_EQ(passed(limit, kStart + 1000h), 5);
}

}  // namespace
}  // namespace metier::opcua
