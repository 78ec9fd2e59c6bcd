#include "metier/server/candidate.hpp"

#include <gmock/gmock.h>

namespace metier::server {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

KnownFigures figures(std::optional<double> reach, std::optional<double> payload) {
    return {.reach = {reach, ""}, .payload = {payload, ""}};
}

TEST(Candidate, FitsIfNothingIsWished) {
    const auto verdict = judge({}, {});
    EXPECT_TRUE(verdict.fits);
    EXPECT_THAT(verdict.reasons, IsEmpty());
}

TEST(Candidate, SaysWhyItFits) {
    const auto verdict = judge({.reach = 0.5, .payload = 3.0}, figures(0.85, 3.0));
    EXPECT_TRUE(verdict.fits);
    EXPECT_THAT(verdict.reasons, ElementsAre("reach 0.85 m >= 0.5 m", "payload 3 kg >= 3 kg"));
}

TEST(Candidate, SaysWhyItDoesNotFit) {
    const auto verdict = judge({.reach = 0.9, .payload = 3.0}, figures(0.85, 5.0));
    EXPECT_FALSE(verdict.fits);
    EXPECT_THAT(verdict.reasons, ElementsAre("reach 0.85 m < 0.9 m", "payload 5 kg >= 3 kg"));
}

TEST(Candidate, DoesNotFitWhereNobodyKnows) {
    const auto verdict = judge({.reach = 0.5, .payload = 1.0}, figures(0.85, std::nullopt));
    EXPECT_FALSE(verdict.fits);
    EXPECT_THAT(verdict.reasons, ElementsAre("reach 0.85 m >= 0.5 m", "payload unknown"));
}

TEST(Candidate, SaysHowAFigureIsKnown) {
    const KnownFigures told{.reach = {0.85, "of ur, opc.tcp://ur:4840"},
                            .payload = {std::nullopt, "opc.tcp://ur:4840 was not asked"}};
    const auto verdict = judge({.reach = 0.5, .payload = 1.0}, told);
    EXPECT_FALSE(verdict.fits);
    EXPECT_THAT(verdict.reasons, ElementsAre("reach 0.85 m >= 0.5 m (of ur, opc.tcp://ur:4840)",
                                             "payload unknown (opc.tcp://ur:4840 was not asked)"));
}

}  // namespace
}  // namespace metier::server
