#include "transition_log.hpp"

#include <gmock/gmock.h>

#include <chrono>

namespace metier::client {
namespace {

using Kind = opcua::EventNotice::Kind;
using ::testing::HasSubstr;

/// Counts what the log calls.
struct Heard {
    TransitionLog::Watch watch() {
        return {.on_transition = [this](const auto& /*event*/) { ++transitions; },
                .on_missed = [this] { ++missed; },
                .on_ended = [this](const std::string& why) { ended = why; }};
    }

    int transitions = 0;
    int missed = 0;
    std::string ended;
};

TEST(TransitionLog, SaysThatTransitionsMayHaveBeenMissed) {
    TransitionLog log;
    Heard heard;
    log.watch(heard.watch());
    log.add({Kind::interrupted, {}, {}});
    EXPECT_EQ(heard.missed, 0) << "its end will say it";
    log.add({Kind::overflow, {}, {}});
    EXPECT_EQ(heard.missed, 1);
    log.add({Kind::resumed, {}, {}});
    EXPECT_EQ(heard.missed, 2);
    log.add({Kind::event, {}, {}});
    EXPECT_EQ(heard.missed, 3) << "an event that cannot be understood";
    EXPECT_EQ(heard.transitions, 0);
    EXPECT_EQ(heard.ended, "");
}

TEST(TransitionLog, SaysThatNothingWillComeAnyMore) {
    TransitionLog log;
    Heard heard;
    log.watch(heard.watch());
    log.add({Kind::ended, {}, opcua::status::kBadTimeout});
    EXPECT_THAT(heard.ended, HasSubstr("BadTimeout"));
    EXPECT_EQ(heard.missed, 0);
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
}  // namespace metier::client
