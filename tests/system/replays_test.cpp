#include "replays.hpp"

#include <gmock/gmock.h>

namespace metier::system_tests {
namespace {

using ::testing::Contains;
using ::testing::IsEmpty;
using ::testing::Key;

TEST(Replays, NeverMoveAnythingAlsoAfterARestart) {
    const auto report = runReplays(
        {.rounds = 240, .folder = std::filesystem::path(::testing::TempDir()) / "metier_replays"});
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(report->defects, IsEmpty());
    EXPECT_GE(report->rounds, 240U);
    EXPECT_GE(report->boots, 15U);
    for (const char* kind :
         {"same name, same life: Good", "same name, later life: BadNodeIdExists",
          "stale epoch: BadLocked", "stale heartbeat: BadLocked", "passed deadline: BadTimeout",
          "same bytes, same life: connection closed", "same bytes, later life: connection closed",
          "same connection, same life: something", "same connection, later life: something",
          "epoch of another: BadLocked", "Start of another session: BadInvalidArgument"}) {
        EXPECT_THAT(report->answers, Contains(Key(kind)));
    }
}

}  // namespace
}  // namespace metier::system_tests
