#include "metier/base/background_read.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <future>

namespace metier {
namespace {

using namespace std::chrono_literals;
using Number = std::shared_ptr<const int>;

TEST(BackgroundRead, GivesWhatIsThereNow) {
    std::atomic<int> there = 1;
    BackgroundRead<int> read(std::make_shared<int>(0),
                             [&](const Number&) { return std::make_shared<int>(there); });
    const auto soon = std::chrono::steady_clock::now() + 30s;
    for (int now : {1, 2, 3}) {
        there = now;
        while (*read.get() != now) {  // at once, but for a computer that does other things
            ASSERT_LT(std::chrono::steady_clock::now(), soon);
        }
    }
}

TEST(BackgroundRead, KeepsNobodyWaitingForADiskThatHangs) {
    std::promise<void> works;
    const auto disk = works.get_future().share();
    BackgroundRead<int> read(std::make_shared<int>(7), [&](const Number& last) {
        disk.wait();
        return std::make_shared<int>(*last + 1);
    });
    EXPECT_EQ(*read.get(), 7) << "after its patience";
    auto shortest = std::chrono::nanoseconds::max();
    for (int i = 0; i < 5; ++i) {  // one of them is not held up by other work of the computer
        const auto before = std::chrono::steady_clock::now();
        EXPECT_EQ(*read.get(), 7);
        shortest =
            std::min<std::chrono::nanoseconds>(shortest, std::chrono::steady_clock::now() - before);
    }
    EXPECT_LT(shortest, kReadPatience);
    works.set_value();
    const auto soon = std::chrono::steady_clock::now() + 30s;
    while (*read.get() == 7) {
        ASSERT_LT(std::chrono::steady_clock::now(), soon);
    }
}

TEST(BackgroundRead, TellsItsReaderWhatItHas) {
    std::atomic<int> reads = 0;
    BackgroundRead<int> read(std::make_shared<int>(5), [&](const Number& last) {
        ++reads;
        return last;
    });
    const auto first = read.get();
    EXPECT_EQ(*first, 5);
    const auto soon = std::chrono::steady_clock::now() + 30s;
    while (reads < 1) {  // at once, but for a computer that does other things
        ASSERT_LT(std::chrono::steady_clock::now(), soon);
        ASSERT_EQ(read.get(), first);
    }
    EXPECT_EQ(read.get(), first);
}

}  // namespace
}  // namespace metier
