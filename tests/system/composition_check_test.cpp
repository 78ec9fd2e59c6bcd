// Check and Start of composed skills, over the processes of an arm and of two components.
#include <gmock/gmock.h>

#include <numbers>

#include "metier_program.hpp"
#include "watched_skill.hpp"

namespace metier::system_tests {
namespace {

using skill::Frame;
using skill::Reason;
using skill::State;
using skill::ValueMap;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

constexpr double kPi = std::numbers::pi;

/// A pose of an iiwa whose tool points down.
Frame down(double x, double y) {
    return {x, y, 0.4, kPi, 0.0, kPi};
}

ServerProcess serve(const std::string& name, std::vector<std::string> more = {}) {
    more.insert(more.end(), {"--port", "0"});
    return ServerProcess(
        name, more,
        std::filesystem::path(METIER_SOURCE_DIR) / "tests" / "system" / "composed.toml");
}

class CheckOfAComposition : public ::testing::TestWithParam<const char*> {
protected:
    static ValueMap corner(const Frame& first, const Frame& second) {
        return {{"First", first}, {"Second", second}};
    }
    skill::CheckReport check(const ValueMap& parameters) {
        const auto report = (*corner_)->check(parameters);
        EXPECT_TRUE(report) << report.error().message;
        return report.value_or(skill::CheckReport{});
    }

    ServerProcess arm_server_ = serve("iiwa");
    ServerProcess line_server_ = serve("line", {"--use", "iiwa=" + arm_server_.url()});
    ServerProcess corner_server_ = serve(
        "corner", {"--use", "iiwa=" + arm_server_.url(), "--use", "line=" + line_server_.url()});
    std::optional<Watched> arm_{std::in_place, arm_server_.url(), "CartesianLinearMoveSkill"};
    std::optional<Watched> corner_{std::in_place, corner_server_.url(), GetParam()};
    // From home, in front of the base, the straight way to kBehind leads through the base.
    const Frame beside_ = down(0.0, 0.5);
    const Frame behind_ = down(-0.35, 0.35);
    const Frame too_far_ = down(0.0, 1.5);
};

TEST_P(CheckOfAComposition, FindsAWayPossibleThatIsOnlyPossibleFromWhereItsFirstStepEnds) {
    const auto from_home = (*arm_)->check({{"TargetPosition", behind_}});
    ASSERT_TRUE(from_home) << from_home.error().message;
    ASSERT_FALSE(from_home->possible) << "the second step alone";
    const auto report = check(corner(beside_, behind_));
    EXPECT_TRUE(report.possible) << report.reason;
    EXPECT_GT(report.planned_duration, 0.5);
    EXPECT_THAT(report.notes, IsEmpty());
    ASSERT_TRUE(report.ends.contains(arm_server_.url()));
    const auto ran = (*corner_)->runWith({"corner", corner(beside_, behind_)}, inAMinute());
    ASSERT_TRUE(ran) << ran.error().message;
    const auto reached = jointPosition(arm_->client(), **arm_);
    const auto& foreseen = report.ends.at(arm_server_.url());
    for (std::size_t axis = 0; axis < reached.size(); ++axis) {
        EXPECT_NEAR(reached[axis], foreseen[axis], 1e-3) << "axis " << axis + 1;
    }
}

TEST_P(CheckOfAComposition, NamesTheStepWhosePoseCannotBeReachedAndMovesNothing) {
    const auto home = jointPosition(arm_->client(), **arm_);
    const auto parameters = corner(beside_, too_far_);
    const auto report = check(parameters);
    EXPECT_FALSE(report.possible);
    EXPECT_THAT(report.reason, StartsWith("step second: "));
    EXPECT_THAT(report.reason, HasSubstr("CartesianLinearMoveSkill of iiwa cannot be done: "));
    EXPECT_THAT(report.reason, HasSubstr("reach"));
    EXPECT_EQ(report.code, "unreachable");
    EXPECT_EQ((*corner_)->state(), State::ready);
    EXPECT_EQ(jointPosition(arm_->client(), **arm_), home);
}

INSTANTIATE_TEST_SUITE_P(OneComponentAndTwo, CheckOfAComposition,
                         ::testing::Values("CornerSkill", "CornerByPartsSkill"));

}  // namespace
}  // namespace metier::system_tests
