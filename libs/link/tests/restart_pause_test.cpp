#include "metier/link/restart_pause.hpp"

#include <gtest/gtest.h>

namespace metier::link {
namespace {

using namespace std::chrono_literals;

TEST(RestartPause, DoublesUpToItsLongest) {
    RestartPause pause;
    for (const auto expected : {500ms, 1000ms, 2000ms, 4000ms, 8000ms, 16000ms, 30000ms, 30000ms}) {
        EXPECT_EQ(pause.next(1s), expected);
    }
}

TEST(RestartPause, BeginsAnewForAProgramThatRanForAMinute) {
    RestartPause pause;
    pause.next(1s);
    pause.next(1s);
    EXPECT_EQ(pause.next(60s), 500ms);
    EXPECT_EQ(pause.next(59s), 1000ms);
}

}  // namespace
}  // namespace metier::link
