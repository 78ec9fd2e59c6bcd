// A server goes on serving well-behaved clients, with any messages from others.
#include <gmock/gmock.h>

#include <string>

#include "onslaught.hpp"

namespace metier::hostile {
namespace {

using ::testing::IsEmpty;

#if defined(__SANITIZE_ADDRESS__)
// Freed memory is kept for a while, so that its use is detected.
constexpr std::size_t kMostGrowth = 1'000'000;
#else
constexpr std::size_t kMostGrowth = 16'000;  ///< [kB]
#endif

void expectUnharmed(const OnslaughtOptions& options) {
    const auto report = runOnslaught(options);
    SCOPED_TRACE(describe(options, report));
    EXPECT_THAT(report.tally.defects, IsEmpty());
    EXPECT_GT(report.tally.connections, 10U);
    EXPECT_GT(report.tally.answers, options.messages / 10);
    EXPECT_LT(report.resident_after, report.resident_before + kMostGrowth);
    EXPECT_LE(report.descriptors_after, report.descriptors_before);
}

class HostileClients : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(HostileClients, LeaveAnOpenServerUnharmed) {
    expectUnharmed({.seed = GetParam()});
}

INSTANTIATE_TEST_SUITE_P(Seeds, HostileClients, ::testing::Values(1, 2, 3, 4));

class HostileStrangers : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(HostileStrangers, GetNothingFromAClosedServer) {
    expectUnharmed({.seed = GetParam(),
                    .messages = 10'000,
                    .kind = ServerKind::closed,
                    .folder = ::testing::TempDir() + "hostile_" + std::to_string(GetParam())});
}

INSTANTIATE_TEST_SUITE_P(Seeds, HostileStrangers, ::testing::Values(11, 12));

}  // namespace
}  // namespace metier::hostile
