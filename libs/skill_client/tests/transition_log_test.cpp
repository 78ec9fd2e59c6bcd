#include "transition_log.hpp"

#include <gmock/gmock.h>

#include <chrono>

namespace metier::skill_client {
namespace {

using Kind = opcua::EventNotice::Kind;
using ::testing::HasSubstr;

/// Counts what the log calls.
struct Heard {
    TransitionLog::Watch watch() {
        return {.on_transition = [this](const auto& /*event*/) { ++transitions; },
                .on_doubt = [this] { ++doubts; },
                .on_deaf = [this](const std::string& why) { deaf = why; }};
    }

    int transitions = 0;
    int doubts = 0;
    std::string deaf;
};

TEST(TransitionLog, SaysThatTransitionsMayHaveBeenMissed) {
    TransitionLog log;
    Heard heard;
    log.watch(heard.watch());
    log.add({Kind::interrupted, {}, {}});
    EXPECT_EQ(heard.doubts, 0) << "its end will say it";
    log.add({Kind::overflow, {}, {}});
    EXPECT_EQ(heard.doubts, 1);
    log.add({Kind::resumed, {}, {}});
    EXPECT_EQ(heard.doubts, 2);
    log.add({Kind::event, {}, {}});
    EXPECT_EQ(heard.doubts, 3) << "an event that cannot be understood";
    EXPECT_EQ(heard.transitions, 0);
    EXPECT_EQ(heard.deaf, "");
}

TEST(TransitionLog, SaysThatNothingWillComeAnyMore) {
    TransitionLog log;
    Heard heard;
    log.watch(heard.watch());
    log.add({Kind::ended, {}, opcua::status::kBadTimeout});
    EXPECT_THAT(heard.deaf, HasSubstr("BadTimeout"));
    EXPECT_EQ(heard.doubts, 0);
}

TEST(TransitionLog, NeedsNobodyToListen) {
    TransitionLog log;
    log.add({Kind::overflow, {}, {}});
    log.add({Kind::ended, {}, opcua::status::kBadTimeout});
    const auto found = log.await(log.mark(), std::chrono::steady_clock::now(),
                                 [](const auto& /*event*/) { return true; });
    EXPECT_FALSE(found);
}

}  // namespace
}  // namespace metier::skill_client
